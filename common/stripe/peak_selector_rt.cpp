// SPDX-License-Identifier: MIT
#include "common/stripe/peak_selector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace biteline::stripe {
namespace {

/// A stripe that moved farther than this between profiles is another one: 2 mm of surface at 0.16 mm a row.
constexpr float k_same_place_px = 12.0F;
/// Three times the usual threshold: a peak is certain then, and more light is no more evidence of a surface.
/// A mirror image on matt material is often brighter than the glossy surface that threw it.
constexpr float k_certain_grey = 36.0F;
/// What lying in the same place adds to the support.
constexpr float k_same_place_bonus = 0.5F;
/// Share of the last step that a stretch's slope takes over.
constexpr float k_slope_gain = 0.5F;
/// A steep stripe's next step differs from the last by this share of it.
constexpr float k_slope_tolerance = 0.6F;
/// Slopes below this are none.
constexpr float k_level_px = 1e-6F;
/// At a stretch's end: less bright, or wider, than the columns further in.
constexpr float k_dim_ratio = 0.55F;
constexpr float k_wide_ratio = 1.4F;
/// Columns further in that an end is compared with, and columns that an end may have.
constexpr std::size_t k_inner_columns = 5;
constexpr std::size_t k_end_columns = 2;

/// Columns on either side that confirm a poor fit's place, the farthest of them this far away, by so many
/// standard deviations of its row: the line through three neighbours has an error of one and a half at it.
constexpr std::size_t k_confirming_columns = 3, k_confirming_reach = 8;
constexpr float k_confirming_sigma = 5.0F;

std::int8_t choose_alone(const ColumnPeaks& column, PeakChoice choice) {
  if (column.kept_count == 0) return -1;
  if (column.kept_count == 1 || choice == PeakChoice::Strongest) {
    return column.kept_count == 2 && column.kept[1].amplitude > column.kept[0].amplitude ? 1 : 0;
  }
  const bool second_is_lower = column.kept[1].row_px < column.kept[0].row_px;
  return static_cast<std::int8_t>((choice == PeakChoice::First) == second_is_lower ? 1 : 0);
}

bool same_place(float row_px, float previous_row_px) {
  return previous_row_px >= 0 && std::fabs(row_px - previous_row_px) < k_same_place_px;
}

}  // namespace

void PeakSelector::rt_select(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  rt_link(peaks);
  rt_choose(peaks, out);
  rt_judge(peaks, out);
  rt_flag_ends(peaks, out);
  rt_judge_skew(peaks, out);
  rt_flag_poor_fits(peaks, out);

  const auto columns = static_cast<std::size_t>(peaks.column_count);
  for (std::size_t i = 0; i < columns; ++i) {
    const Selected& selected = out.columns[i];
    const bool surface = selected.kept_index >= 0 && (selected.flags & k_selection_reflection) == 0;
    previous_row_px_[i] =
        surface ? peaks.columns[i].kept[static_cast<std::size_t>(selected.kept_index)].row_px : -1.0F;
  }
  previous_columns_ = peaks.column_count;
}

/// Links each column's peaks to the stretches that end just before it; what fits none begins a new one.
void PeakSelector::rt_link(const Peaks& peaks) noexcept BITELINE_RT {
  stretch_count_ = 0;
  open_count_ = 0;
  const bool has_previous = previous_columns_ == peaks.column_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    const ColumnPeaks& column = peaks.columns[i];
    stretch_of_[i].fill(k_none);
    rt_close_ended(i);
    for (std::size_t k = 0; k < column.kept_count; ++k) {
      const Peak& peak = column.kept[k];
      Index index = rt_continue(i, peak, k == 1 ? stretch_of_[i][0] : k_none);
      if (index == k_none) {
        index = rt_open(peak, static_cast<int>(i));
      } else {
        Stretch& stretch = stretches_[static_cast<std::size_t>(index)];
        const float step_px = (peak.row_px - stretch.last_row_px) /
                              static_cast<float>(static_cast<int>(i) - stretch.last_column);
        stretch.slope_px += k_slope_gain * (step_px - stretch.slope_px);
        // On a level stripe the slope would halve on into denormal numbers, a hundred times slower.
        if (std::fabs(stretch.slope_px) < k_level_px) stretch.slope_px = 0;
      }
      Stretch& stretch = stretches_[static_cast<std::size_t>(index)];
      stretch.last_row_px = peak.row_px;
      stretch.last_column = static_cast<int>(i);
      stretch.support += std::min(peak.amplitude, k_certain_grey);
      stretch.light += peak.amplitude;
      ++stretch.columns;
      if (has_previous && same_place(peak.row_px, previous_row_px_[i])) ++stretch.seen_before;
      stretch_of_[i][k] = index;
    }
  }
}

void PeakSelector::rt_close_ended(std::size_t column) noexcept BITELINE_RT {
  std::size_t kept = 0;
  for (std::size_t s = 0; s < open_count_; ++s) {
    const int gap = static_cast<int>(column) - stretches_[static_cast<std::size_t>(open_[s])].last_column;
    if (gap <= config_.max_gap_columns + 1) open_[kept++] = open_[s];
  }
  open_count_ = kept;
}

PeakSelector::Index PeakSelector::rt_open(const Peak& peak, int column) noexcept BITELINE_RT {
  const auto index = static_cast<Index>(stretch_count_++);
  stretches_[static_cast<std::size_t>(index)] = {
      .first_row_px = peak.row_px, .last_row_px = peak.row_px, .first_column = column, .last_column = column};
  // Too many open ones are noise: the oldest gives way.
  if (open_count_ == k_max_open) {
    std::copy(open_.begin() + 1, open_.end(), open_.begin());
    --open_count_;
  }
  open_[open_count_++] = index;
  return index;
}

/// The open stretch that `peak` goes on from, other than `taken`; k_none when there is none.
PeakSelector::Index PeakSelector::rt_continue(std::size_t column, const Peak& peak,
                                              Index taken) const noexcept BITELINE_RT {
  Index best = k_none;
  float best_distance_px = 1e9F;
  for (std::size_t s = 0; s < open_count_; ++s) {
    const Stretch& stretch = stretches_[static_cast<std::size_t>(open_[s])];
    const int gap = static_cast<int>(column) - stretch.last_column;
    if (gap < 1 || open_[s] == taken) continue;
    const float advance_px = stretch.slope_px * static_cast<float>(gap);
    const float distance_px = std::fabs(peak.row_px - stretch.last_row_px - advance_px);
    if (distance_px > config_.max_step_px + k_slope_tolerance * std::fabs(advance_px)) continue;
    if (distance_px < best_distance_px) {
      best = open_[s];
      best_distance_px = distance_px;
    }
  }
  return best;
}

float PeakSelector::rt_same_place_ratio(Index index) const noexcept BITELINE_RT {
  const Stretch& stretch = stretches_[static_cast<std::size_t>(index)];
  const float share_seen = static_cast<float>(stretch.seen_before) / static_cast<float>(stretch.columns);
  return 1 + k_same_place_bonus * share_seen;
}

float PeakSelector::rt_support(Index index) const noexcept BITELINE_RT {
  return stretches_[static_cast<std::size_t>(index)].support * rt_same_place_ratio(index);
}

float PeakSelector::rt_light(Index index) const noexcept BITELINE_RT {
  return stretches_[static_cast<std::size_t>(index)].light * rt_same_place_ratio(index);
}

/// Each column's peak, and whether it goes on from the column before.
void PeakSelector::rt_choose(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  Index last_stretch = k_none;
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    const ColumnPeaks& column = peaks.columns[i];
    Selected& selected = out.columns[i];
    selected = {};
    if (config_.choice != PeakChoice::Continuity) {
      selected.kept_index = choose_alone(column, config_.choice);
    } else if (column.kept_count > 0) {
      const bool second =
          column.kept_count > 1 && rt_support(stretch_of_[i][1]) > rt_support(stretch_of_[i][0]);
      selected.kept_index = second ? 1 : 0;
    }
    const Index index =
        selected.kept_index < 0 ? k_none : stretch_of_[i][static_cast<std::size_t>(selected.kept_index)];
    selected.joined = index != k_none && index == last_stretch;
    last_stretch = index;
  }
}

/// Flags the chosen peaks whose stretch is no surface's.
void PeakSelector::rt_judge(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  float best_light = 0;
  for (int s = 0; s < stretch_count_; ++s) best_light = std::max(best_light, rt_light(static_cast<Index>(s)));
  const float least_light = config_.min_light_ratio * best_light;

  Index judged = k_none;
  std::uint8_t verdict = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    Selected& selected = out.columns[i];
    if (selected.kept_index < 0) continue;
    const Index index = stretch_of_[i][static_cast<std::size_t>(selected.kept_index)];
    if (index != judged) {
      const Stretch& stretch = stretches_[static_cast<std::size_t>(index)];
      const bool alone = stretch.columns < config_.min_stretch_columns;
      const bool faint = rt_light(index) < least_light && 2 * stretch.seen_before < stretch.columns &&
                         !rt_goes_on(stretch, peaks, out, least_light);
      judged = index;
      verdict = alone   ? k_selection_discontinuous | k_selection_reflection
                : faint ? k_selection_reflection
                        : 0;
    }
    selected.flags = static_cast<std::uint8_t>(selected.flags | verdict);
  }
}

/// True when a well supported stretch ends or begins beside `stretch` at a height that the surface between
/// may have.
bool PeakSelector::rt_goes_on(const Stretch& stretch, const Peaks& peaks, const Selection& chosen,
                              float least_light) const noexcept BITELINE_RT {
  const auto meets = [&](int from_column, float from_row_px, int step) {
    for (int gap = 1; gap <= config_.beside_columns; ++gap) {
      const int column = from_column + step * gap;
      if (column < 0 || column >= peaks.column_count) return false;
      const auto i = static_cast<std::size_t>(column);
      if (chosen.columns[i].kept_index < 0) continue;
      const auto kept = static_cast<std::size_t>(chosen.columns[i].kept_index);
      if (rt_light(stretch_of_[i][kept]) < least_light) continue;
      // The nearest one decides.
      const float allowed_px = config_.max_step_px + config_.beside_slope_px * static_cast<float>(gap);
      return std::fabs(peaks.columns[i].kept[kept].row_px - from_row_px) <= allowed_px;
    }
    return false;
  };
  return meets(stretch.first_column, stretch.first_row_px, -1) ||
         meets(stretch.last_column, stretch.last_row_px, +1);
}

/// Where a stretch ends, the stripe is cut by an edge of the surface, and the last columns may show a part of
/// it or two surfaces in one peak: they are then dimmer or wider than the columns further in.
void PeakSelector::rt_flag_ends(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(peaks.column_count);
  const auto chosen = [&](std::size_t i) -> const Peak& {
    return peaks.columns[i].kept[static_cast<std::size_t>(out.columns[i].kept_index)];
  };
  const auto flag_end = [&](std::size_t end, int inward) {
    // Further in: the columns after the end's own.
    float amplitude = 0, width_px = 0;
    for (std::size_t k = k_end_columns; k < k_end_columns + k_inner_columns; ++k) {
      const auto i = static_cast<std::size_t>(static_cast<int>(end) + inward * static_cast<int>(k));
      amplitude += chosen(i).amplitude / static_cast<float>(k_inner_columns);
      width_px += chosen(i).width_px / static_cast<float>(k_inner_columns);
    }
    for (std::size_t k = 0; k < k_end_columns; ++k) {
      const auto i = static_cast<std::size_t>(static_cast<int>(end) + inward * static_cast<int>(k));
      if (chosen(i).amplitude < k_dim_ratio * amplitude || chosen(i).width_px > k_wide_ratio * width_px) {
        out.columns[i].flags |= k_selection_edge_mixed;
      }
    }
  };
  std::size_t first = 0;
  for (std::size_t i = 1; i <= columns; ++i) {
    if (i < columns && out.columns[i].joined) continue;
    // Columns [first, i) are one stretch, or one column without.
    if (i - first >= k_end_columns + k_inner_columns) {
      flag_end(first, +1);
      flag_end(i - 1, -1);
    }
    first = i;
  }
}

/// A peak of another shape than the stripe's mixes two surfaces or is speckle.  Where surfaces mix, the
/// columns on either side go on to somewhere else.
void PeakSelector::rt_flag_poor_fits(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(peaks.column_count);
  const auto chosen = [&](std::size_t i) -> const Peak& {
    return peaks.columns[i].kept[static_cast<std::size_t>(out.columns[i].kept_index)];
  };
  // Does the line through the nearest columns of surface on one side, on the same stretch, go through column
  // `i`?
  const auto confirmed = [&](std::size_t i, int step) {
    float row_px = 0, offset = 0, nearest_row_px = 0, nearest_offset = 0;
    std::size_t count = 0, at = i;
    for (std::size_t k = 1; k <= k_confirming_reach; ++k) {
      if (step < 0 ? at == 0 || !out.columns[at].joined : at + 1 == columns || !out.columns[at + 1].joined)
        return false;
      at = step < 0 ? at - 1 : at + 1;
      const Peak& peak = chosen(at);
      if (out.columns[at].flags != 0 || (peak.flags & (k_peak_poor_fit | k_peak_clipped)) != 0) continue;
      const auto distance = static_cast<float>(k);
      if (count == 0) nearest_row_px = peak.row_px, nearest_offset = distance;
      row_px += peak.row_px / static_cast<float>(k_confirming_columns);
      offset += distance / static_cast<float>(k_confirming_columns);
      if (++count < k_confirming_columns) continue;
      const float slope_px = (peak.row_px - nearest_row_px) / (distance - nearest_offset);
      return std::fabs(chosen(i).row_px - (row_px - slope_px * offset)) <
             k_confirming_sigma * chosen(i).sigma_row_px;
    }
    return false;
  };
  for (std::size_t i = 0; i < columns; ++i) {
    if (out.columns[i].kept_index < 0 || (chosen(i).flags & k_peak_poor_fit) == 0) continue;
    if (!confirmed(i, -1) || !confirmed(i, +1)) out.columns[i].flags |= k_selection_edge_mixed;
  }
}

}  // namespace biteline::stripe
