// SPDX-License-Identifier: MIT
#include <algorithm>
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

std::uint16_t point_flags(const stripe::Peak& peak, const stripe::ColumnPeaks& column,
                          std::uint8_t selection_flags) {
  std::uint16_t flags = 0;
  if (peak.flags & stripe::k_peak_saturated) flags |= profile::k_point_saturated;
  if (peak.flags & stripe::k_peak_clipped) flags |= profile::k_point_clipped;
  if (peak.flags & stripe::k_peak_wide) flags |= profile::k_point_wide;
  if (peak.flags & stripe::k_peak_narrow) flags |= profile::k_point_narrow;
  if (column.seen_count > 1) flags |= profile::k_point_other_peaks;
  if (selection_flags & stripe::k_selection_reflection) flags |= profile::k_point_reflection;
  if (selection_flags & stripe::k_selection_discontinuous) flags |= profile::k_point_discontinuous;
  if (selection_flags & stripe::k_selection_edge_mixed) flags |= profile::k_point_edge_mixed;
  if (selection_flags & stripe::k_selection_brightness_step) flags |= profile::k_point_brightness_step;
  return flags;
}

bool is_present(const ExposedStripe& stripe, std::size_t column) {
  return stripe.selection.columns[column].kept_index >= 0;
}

const stripe::Peak& chosen_peak(const ExposedStripe& stripe, std::size_t column) {
  return stripe.peaks.columns[column]
      .kept[static_cast<std::size_t>(stripe.selection.columns[column].kept_index)];
}

/// From rows of the frame to rows of the region.
void rt_shift_rows(stripe::Peaks& peaks, float rows_px) noexcept BITELINE_RT {
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    for (std::size_t k = 0; k < peaks.columns[i].kept_count; ++k) peaks.columns[i].kept[k].row_px += rows_px;
  }
}

/// The chosen peaks as a line, averaged along itself.  A peak that mixes surfaces or is none joins nothing;
/// what skew shifts it shifts its neighbours, too, and no average takes off.
void rt_average_along_line(const stripe::LineAverage& average, ExposedStripe& stripe,
                           std::span<stripe::LinePoint> work) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(stripe.peaks.column_count);
  bool previous_sound = false;
  for (std::size_t i = 0; i < columns; ++i) {
    const stripe::Selected& selected = stripe.selection.columns[i];
    stripe.line[i] = {};
    if (selected.kept_index < 0) {
      previous_sound = false;
      continue;
    }
    const stripe::Peak& peak = chosen_peak(stripe, i);
    const bool sound = selected.flags == 0 && (peak.flags & stripe::k_peak_clipped) == 0;
    stripe.line[i] = {.row_px = peak.row_px,
                      .sigma_row_px = peak.sigma_row_px,
                      .present = true,
                      .joined = selected.joined && sound && previous_sound};
    previous_sound = sound;
  }
  average.rt_average(std::span{stripe.line}.subspan(0, columns), work,
                     stripe.peaks.speckle.neighbour_correlation);
  for (std::size_t i = 0; i < columns; ++i) {
    const float skew_sigma_px = stripe.selection.columns[i].skew_sigma_px;
    if (skew_sigma_px > 0)
      stripe.line[i].sigma_row_px = std::hypot(stripe.line[i].sigma_row_px, skew_sigma_px);
  }
}

/// Puts points into a profile as long as there is room.
class PointWriter {
 public:
  PointWriter(const TriangulationTable& table, int offset_v_px, ProfileBuffer& out)
      : table_{table}, offset_v_px_{offset_v_px}, out_{out} {}

  void rt_write(std::size_t column, const stripe::Peak& peak, const stripe::LinePoint& place,
                std::uint16_t flags, std::uint8_t peak_count) noexcept BITELINE_RT {
    if (out_.count == out_.points.size()) return;
    const TriangulationTable::Point triangulated = table_.rt_point(static_cast<int>(column), place.row_px);
    if (std::isnan(triangulated.point_cam.z())) return;  // the laser's plane is not seen there
    out_.points[out_.count++] = {.point_cam = triangulated.point_cam,
                                 .sigma_mm = place.sigma_row_px * triangulated.mm_per_row,
                                 .row_px = place.row_px + static_cast<float>(offset_v_px_),
                                 .sigma_row_px = place.sigma_row_px,
                                 .amplitude = peak.amplitude,
                                 .width_px = peak.width_px,
                                 .column = static_cast<std::uint16_t>(column),
                                 .flags = flags,
                                 .peak_count = peak_count};
  }

 private:
  const TriangulationTable& table_;
  int offset_v_px_;
  ProfileBuffer& out_;
};

/// True where the longer exposure saw the shorter one's peak, too, and took it for a mirror image: that peak
/// is nearer to the one it did not choose.  No limit is needed: two peaks of a column are many times farther
/// apart than their standard deviations, and mostly than a stripe goes from one exposure to the next.
bool second_rejects(const ExposedStripe& first, const ExposedStripe& second, std::size_t column) {
  const stripe::Selected& selected = second.selection.columns[column];
  const stripe::ColumnPeaks& peaks = second.peaks.columns[column];
  if (peaks.kept_count < 2 || (selected.flags & stripe::k_selection_reflection) != 0) return false;
  const float row_px = chosen_peak(first, column).row_px;
  const stripe::Peak& rejected = peaks.kept[selected.kept_index == 0 ? 1 : 0];
  return std::fabs(row_px - rejected.row_px) < std::fabs(row_px - chosen_peak(second, column).row_px);
}

/// Per column the exposure whose peak says more: the longer one, unless it is flagged or saturated there and
/// the shorter one is not.  But what an edge or a step of brightness has cut, or grains saturate, is the
/// surface's all the same: where it rejects the shorter one's peak it stays, with its flag.
bool prefers_second(const ExposedStripe& first, const ExposedStripe& second, std::size_t column) {
  if (!is_present(second, column)) return false;
  if (!is_present(first, column)) return true;
  constexpr std::uint8_t k_bad =
      stripe::k_selection_reflection | stripe::k_selection_edge_mixed | stripe::k_selection_brightness_step;
  const bool first_bad = first.selection.columns[column].flags & k_bad,
             second_bad = second.selection.columns[column].flags & k_bad;
  if (first_bad && !second_bad) return true;
  if (second_rejects(first, second, column)) return true;
  if (second_bad && !first_bad) return false;
  return (chosen_peak(second, column).flags & stripe::k_peak_saturated) == 0;
}

}  // namespace

bool ProfilePipeline::rt_process(const hal::FrameView& frame, ProfileBuffer& out) noexcept BITELINE_RT {
  State& state = *state_;
  BITELINE_EXPECTS(frame.width_px == state.region.width_px && frame.first_row_px >= 0 &&
                   frame.first_row_px + frame.height_px <= state.region.height_px);
  if (frame.flags & hal::k_frame_laser_off) {
    const auto width = static_cast<std::size_t>(frame.width_px);
    for (std::size_t row = 0; row < static_cast<std::size_t>(frame.height_px); ++row) {
      std::copy_n(frame.pixels.data() + row * frame.stride_bytes, width, state.ambient.data() + row * width);
    }
    state.ambient_mid = frame.exposure_mid;
    state.ambient_rows = {.first_px = frame.first_row_px, .height_px = frame.height_px};
    return false;
  }

  // From one frame to one exposure's line.
  const auto expose = [&](ExposedStripe& stripe) {
    stripe::PixelView view{
        .pixels = frame.pixels.data(), .stride_bytes = frame.stride_bytes, .height_px = frame.height_px};
    if (state.ambient_mid && state.ambient_rows.first_px == frame.first_row_px &&
        state.ambient_rows.height_px == frame.height_px &&
        std::chrono::abs(frame.exposure_mid - *state.ambient_mid) <= state.config.ambient_max_age) {
      const auto width = static_cast<std::size_t>(frame.width_px);
      stripe::rt_subtract_ambient({.lit = view,
                                   .dark = {.pixels = state.ambient.data(), .stride_bytes = width},
                                   .width_px = frame.width_px,
                                   .height_px = frame.height_px},
                                  state.difference.data());
      view = {.pixels = state.difference.data(), .stride_bytes = width, .height_px = frame.height_px};
    }
    stripe.exposure_mid = frame.exposure_mid;
    stripe.frame_sequence = frame.sequence;
    stripe.frame_flags = frame.flags;
    state.extractor.rt_extract(view, stripe.peaks);
    if (frame.first_row_px != 0) rt_shift_rows(stripe.peaks, static_cast<float>(frame.first_row_px));
    stripe.selector.rt_select(stripe.peaks, stripe.selection);
    rt_average_along_line(state.line_average, stripe, state.line_work);
  };

  const bool is_second = (frame.flags & hal::k_frame_second_exposure) != 0;
  if (!state.config.bracketing) {
    expose(state.first);
    rt_make_profile(state.first, nullptr, out);
    return true;
  }
  if (is_second) {
    expose(state.second);
    // A second without its first is a profile of its own.
    rt_make_profile(state.first_waits ? state.first : state.second,
                    state.first_waits ? &state.second : nullptr, out);
    state.first_waits = false;
    return true;
  }
  // A first whose second was lost goes out alone, before the new one is looked at.
  const bool alone = state.first_waits;
  if (alone) rt_make_profile(state.first, nullptr, out);
  expose(state.first);
  state.first_waits = true;
  return alone;
}

void ProfilePipeline::rt_make_profile(const ExposedStripe& first, const ExposedStripe* second,
                                      ProfileBuffer& out) noexcept BITELINE_RT {
  State& state = *state_;
  out.header = {};
  out.header.sequence = state.next_sequence++;
  out.header.frame_sequence = first.frame_sequence;
  out.header.exposure_mid = first.exposure_mid;
  out.header.flags =
      profile_flags(second != nullptr ? first.frame_flags | second->frame_flags : first.frame_flags);
  if (second != nullptr) out.header.second_exposure_after = second->exposure_mid - first.exposure_mid;
  for (const ExposedStripe* stripe : {&first, second})
    if (stripe != nullptr && stripe->peaks.speckle.measured)
      out.header.speckle_contrast = stripe->peaks.speckle.contrast;
  out.count = 0;

  PointWriter writer{state.table, state.region.offset_v_px, out};
  std::size_t surface_columns = 0;
  const auto columns = static_cast<std::size_t>(first.peaks.column_count);
  for (std::size_t column = 0; column < columns; ++column) {
    const bool from_second = second != nullptr && prefers_second(first, *second, column);
    const ExposedStripe& stripe = from_second ? *second : first;
    if (!is_present(stripe, column)) continue;
    ++surface_columns;
    const stripe::ColumnPeaks& peaks = stripe.peaks.columns[column];
    const auto exposure_flag = static_cast<std::uint16_t>(
        (stripe.frame_flags & hal::k_frame_second_exposure) != 0 ? profile::k_point_second_exposure : 0);
    const stripe::Peak& chosen = chosen_peak(stripe, column);
    const auto chosen_flags = static_cast<std::uint16_t>(
        point_flags(chosen, peaks, stripe.selection.columns[column].flags) | exposure_flag);
    writer.rt_write(column, chosen, stripe.line[column], chosen_flags, peaks.seen_count);
    if (!state.config.keep_second_peaks || peaks.kept_count < 2) continue;
    const stripe::Peak& other = peaks.kept[stripe.selection.columns[column].kept_index == 0 ? 1 : 0];
    const auto other_flags =
        static_cast<std::uint16_t>(point_flags(other, peaks, stripe::k_selection_reflection) | exposure_flag);
    writer.rt_write(column, other, {.row_px = other.row_px, .sigma_row_px = other.sigma_row_px}, other_flags,
                    peaks.seen_count);
  }
  if (static_cast<double>(surface_columns) < state.config.stripe_lost_ratio * static_cast<double>(columns)) {
    out.header.flags |= profile::k_profile_stripe_lost;
  }
}

void ProfilePipeline::rt_take_peaks(PeakChange& change) noexcept BITELINE_RT {
  state_->extractor.rt_swap(change.extractor);
  state_->first.selector.rt_choose_by(change.choice);
  state_->second.selector.rt_choose_by(change.choice);
}

bool ProfilePipeline::rt_pose_ready(const ProfileBuffer& profile,
                                    const PoseHistory& poses) const noexcept BITELINE_RT {
  return poses.rt_covers(profile.header.exposure_mid + profile.header.second_exposure_after,
                         state_->config.pose_smoothing);
}

void ProfilePipeline::rt_stamp(ProfileBuffer& profile, const PoseHistory& poses) const noexcept BITELINE_RT {
  const State& state = *state_;
  geometry::PoseEstimate pose;
  if (!poses.rt_pose_at(profile.header.exposure_mid, state.config.pose_smoothing, pose)) return;
  profile.header.T_base_flange = pose.T_base_flange;
  profile.header.pose_age = pose.age;
  profile.header.encoder_ticks = pose.encoder_ticks;
  profile.header.flags &= ~static_cast<std::uint32_t>(
      profile::k_profile_pose_missing | profile::k_profile_pose_stale | profile::k_profile_pose_extrapolated);
  if (pose.stale) profile.header.flags |= profile::k_profile_pose_stale;
  if (pose.extrapolated) profile.header.flags |= profile::k_profile_pose_extrapolated;

  Eigen::Isometry3f T_first_second = Eigen::Isometry3f::Identity();
  if (profile.header.second_exposure_after.count() != 0) {
    geometry::PoseEstimate second;
    if (!poses.rt_pose_at(profile.header.exposure_mid + profile.header.second_exposure_after,
                          state.config.pose_smoothing, second))
      return;
    if (second.stale) profile.header.flags |= profile::k_profile_pose_stale;
    if (second.extrapolated) profile.header.flags |= profile::k_profile_pose_extrapolated;
    T_first_second = ((pose.T_base_flange * state.T_flange_cam_exact).inverse() * second.T_base_flange *
                      state.T_flange_cam_exact)
                         .cast<float>();
  }

  // Along the measuring direction: the flange's own scatter, and the orientation's at its lever.
  const auto place_variance = static_cast<float>(pose.sigma_mm * pose.sigma_mm);
  const auto turn_variance = static_cast<float>(pose.sigma_rad * pose.sigma_rad);
  for (std::size_t i = 0; i < profile.count; ++i) {
    ProfilePoint& point = profile.points[i];
    if (point.flags & profile::k_point_second_exposure) point.point_cam = T_first_second * point.point_cam;
    const float lever_squared =
        (state.T_flange_cam * point.point_cam).cross(state.measuring_flange).squaredNorm();
    point.sigma_mm =
        std::sqrt(point.sigma_mm * point.sigma_mm + place_variance + turn_variance * lever_squared);
  }
}

}  // namespace biteline::pipeline
