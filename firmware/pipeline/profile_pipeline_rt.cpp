// SPDX-License-Identifier: MIT
#include <cmath>

#include "common/core/contracts.hpp"
#include "firmware/pipeline/profile_pipeline_state.hpp"

namespace biteline::pipeline {
namespace {

using profile::ProfileBuffer;
using profile::ProfilePoint;

std::uint32_t profile_flags(std::uint32_t frame_flags) {
  std::uint32_t flags = profile::k_profile_pose_missing;
  if (frame_flags & hal::k_frame_damaged) flags |= profile::k_profile_frame_damaged;
  if (frame_flags & hal::k_frame_gap_before) flags |= profile::k_profile_frame_gap;
  if (frame_flags & hal::k_frame_stamp_uncertain) flags |= profile::k_profile_clock_unsure;
  if (frame_flags & hal::k_frame_trigger_mismatch) flags |= profile::k_profile_trigger_mismatch;
  return flags;
}

std::uint16_t point_flags(const stripe::Peak& peak, const stripe::ColumnPeaks& column, std::uint8_t selection_flags) {
  std::uint16_t flags = 0;
  if (peak.flags & stripe::k_peak_saturated) flags |= profile::k_point_saturated;
  if (peak.flags & stripe::k_peak_clipped) flags |= profile::k_point_clipped;
  if (peak.flags & stripe::k_peak_wide) flags |= profile::k_point_wide;
  if (peak.flags & stripe::k_peak_narrow) flags |= profile::k_point_narrow;
  if (peak.flags & stripe::k_peak_poor_fit) flags |= profile::k_point_edge_mixed;
  if (column.seen_count > 1) flags |= profile::k_point_other_peaks;
  if (selection_flags & stripe::k_selection_reflection) flags |= profile::k_point_reflection;
  if (selection_flags & stripe::k_selection_discontinuous) flags |= profile::k_point_discontinuous;
  if (selection_flags & stripe::k_selection_edge_mixed) flags |= profile::k_point_edge_mixed;
  return flags;
}

/// The chosen peaks as a line, averaged along itself.  A peak that mixes surfaces or is none joins nothing.
void rt_average_along_line(const stripe::Peaks& peaks, const stripe::Selection& selection, const stripe::LineAverage& average,
                           std::span<stripe::LinePoint> line, std::span<stripe::LinePoint> work) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(peaks.column_count);
  bool previous_sound = false;
  for (std::size_t i = 0; i < columns; ++i) {
    const stripe::Selected& selected = selection.columns[i];
    line[i] = {};
    if (selected.kept_index < 0) {
      previous_sound = false;
      continue;
    }
    const stripe::Peak& peak = peaks.columns[i].kept[static_cast<std::size_t>(selected.kept_index)];
    const bool sound = selected.flags == 0 && (peak.flags & (stripe::k_peak_clipped | stripe::k_peak_poor_fit)) == 0;
    line[i] = {.row_px = peak.row_px,
               .sigma_row_px = peak.sigma_row_px,
               .present = true,
               .joined = selected.joined && sound && previous_sound};
    previous_sound = sound;
  }
  average.rt_average(line.subspan(0, columns), work);
}

}  // namespace

void ProfilePipeline::rt_process(const hal::FrameView& frame, ProfileBuffer& out) noexcept BITELINE_RT {
  State& state = *state_;
  BITELINE_EXPECTS(frame.width_px == state.region.width_px && frame.height_px == state.region.height_px);
  out.header = {};
  out.header.sequence = state.next_sequence++;
  out.header.frame_sequence = frame.sequence;
  out.header.exposure_mid = frame.exposure_mid;
  out.header.flags = profile_flags(frame.flags);
  out.count = 0;

  state.extractor.rt_extract({.pixels = frame.pixels.data(), .stride_bytes = frame.stride_bytes}, state.peaks);
  state.selector.rt_select(state.peaks, state.selection);
  rt_average_along_line(state.peaks, state.selection, state.line_average, state.line, state.line_work);

  for (int column = 0; column < state.peaks.column_count; ++column) {
    const stripe::Selected selected = state.selection.columns[static_cast<std::size_t>(column)];
    if (selected.kept_index < 0) continue;
    const stripe::ColumnPeaks& peaks = state.peaks.columns[static_cast<std::size_t>(column)];
    const stripe::Peak& peak = peaks.kept[static_cast<std::size_t>(selected.kept_index)];
    const stripe::LinePoint& averaged = state.line[static_cast<std::size_t>(column)];
    const TriangulationTable::Point triangulated = state.table.rt_point(column, averaged.row_px);
    ProfilePoint& point = out.points[out.count++];
    point.point_cam = triangulated.point_cam;
    point.sigma_mm = averaged.sigma_row_px * triangulated.mm_per_row;
    point.row_px = averaged.row_px + static_cast<float>(state.region.offset_v_px);
    point.sigma_row_px = averaged.sigma_row_px;
    point.amplitude = peak.amplitude;
    point.width_px = peak.width_px;
    point.column = static_cast<std::uint16_t>(column);
    point.flags = point_flags(peak, peaks, selected.flags);
    point.peak_count = peaks.seen_count;
  }
  if (static_cast<double>(out.count) < state.config.stripe_lost_ratio * state.peaks.column_count) {
    out.header.flags |= profile::k_profile_stripe_lost;
  }
}

bool ProfilePipeline::rt_pose_ready(const ProfileBuffer& profile, const PoseHistory& poses) const noexcept BITELINE_RT {
  return poses.rt_covers(profile.header.exposure_mid, state_->config.pose_smoothing);
}

void ProfilePipeline::rt_stamp(ProfileBuffer& profile, const PoseHistory& poses) const noexcept BITELINE_RT {
  geometry::PoseEstimate pose;
  if (!poses.rt_pose_at(profile.header.exposure_mid, state_->config.pose_smoothing, pose)) return;
  profile.header.T_base_flange = pose.T_base_flange;
  profile.header.pose_age = pose.age;
  profile.header.flags &= ~static_cast<std::uint32_t>(profile::k_profile_pose_missing | profile::k_profile_pose_stale |
                                                      profile::k_profile_pose_extrapolated);
  if (pose.stale) profile.header.flags |= profile::k_profile_pose_stale;
  if (pose.extrapolated) profile.header.flags |= profile::k_profile_pose_extrapolated;

  // Along the measuring direction: the flange's own scatter, and the orientation's at its lever.
  const auto place_variance = static_cast<float>(pose.sigma_mm * pose.sigma_mm);
  const auto turn_variance = static_cast<float>(pose.sigma_rad * pose.sigma_rad);
  for (std::size_t i = 0; i < profile.count; ++i) {
    ProfilePoint& point = profile.points[i];
    const float lever_squared = (state_->T_flange_cam * point.point_cam).cross(state_->measuring_flange).squaredNorm();
    point.sigma_mm = std::sqrt(point.sigma_mm * point.sigma_mm + place_variance + turn_variance * lever_squared);
  }
}

}  // namespace biteline::pipeline
