// SPDX-License-Identifier: MIT
// The pass over the whole frame: compiled once per instruction set, chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/stripe/coarse_rt.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h must come first
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "common/stripe/peak_extractor_state.hpp"

HWY_BEFORE_NAMESPACE();
namespace biteline::stripe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Rows sampled for the quiet level, in pairs half a frame apart: a stripe lies in at most one of a pair, so
// the pair's minimum does not see it.
constexpr int k_pairs = 8;

/// Mean over the pairs of the pairs' minima, and the threshold above it.
void quiet_level(const FrameRows& frame, int threshold_grey, CoarseScratch& scratch) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto height = static_cast<std::size_t>(frame.height_px),
             width = static_cast<std::size_t>(frame.width_px);
  const auto threshold = hn::Set(d, static_cast<std::uint8_t>(threshold_grey));
  const auto pair_row = [&](int pair) {
    return (2 * static_cast<std::size_t>(pair) + 1) * height / (4 * k_pairs);
  };
  const auto pair_minimum = [&](int pair, std::size_t column) {
    const std::uint8_t* upper = frame.pixels + pair_row(pair) * frame.stride_bytes + column;
    return hn::Min(hn::LoadU(d, upper), hn::LoadU(d, upper + (height / 2) * frame.stride_bytes));
  };
  for (std::size_t column = 0; column + lanes <= width; column += lanes) {
    // A tree of rounded averages: eight values, no wider type needed.
    const auto a = hn::AverageRound(pair_minimum(0, column), pair_minimum(1, column));
    const auto b = hn::AverageRound(pair_minimum(2, column), pair_minimum(3, column));
    const auto c = hn::AverageRound(pair_minimum(4, column), pair_minimum(5, column));
    const auto e = hn::AverageRound(pair_minimum(6, column), pair_minimum(7, column));
    const auto level = hn::AverageRound(hn::AverageRound(a, b), hn::AverageRound(c, e));
    hn::StoreU(level, d, scratch.background.data() + column);
    hn::StoreU(hn::SaturatedAdd(level, threshold), d, scratch.threshold.data() + column);
  }
  for (std::size_t column = width - width % lanes; column < width; ++column) {
    int sum = 0;
    for (int pair = 0; pair < k_pairs; ++pair) {
      const std::uint8_t* upper = frame.pixels + pair_row(pair) * frame.stride_bytes + column;
      sum += std::min(*upper, upper[(height / 2) * frame.stride_bytes]);
    }
    scratch.background[column] = static_cast<std::uint8_t>((sum + k_pairs / 2) / k_pairs);
    scratch.threshold[column] =
        static_cast<std::uint8_t>(std::min(255, scratch.background[column] + threshold_grey));
  }
}

/// Notes the block maxima of each lane of columns in which one is above the threshold.
void block_maxima(const FrameRows& frame, CoarseScratch& scratch) {
  const hn::CappedTag<std::uint8_t, k_lane_columns> d;
  const std::size_t step = hn::Lanes(d);
  const auto width = static_cast<std::size_t>(frame.width_px);
  const std::size_t whole_lanes = width / k_lane_columns;
  const std::size_t lane_count = scratch.active_counts.size();
  const int block_count = (frame.height_px + k_block_rows - 1) / k_block_rows;
  std::fill(scratch.active_counts.begin(), scratch.active_counts.end(), std::uint16_t{0});

  for (int block = 0; block < block_count; ++block) {
    const std::size_t first_row = static_cast<std::size_t>(block) * k_block_rows;
    const std::size_t rows =
        std::min<std::size_t>(k_block_rows, static_cast<std::size_t>(frame.height_px) - first_row);
    const std::uint8_t* top = frame.pixels + first_row * frame.stride_bytes;
    // A short last block repeats its last row.
    const std::uint8_t* row[k_block_rows];
    for (std::size_t i = 0; i < k_block_rows; ++i) row[i] = top + std::min(i, rows - 1) * frame.stride_bytes;
    // Two blocks ahead: far enough to hide memory, near enough to be still there.
    const std::size_t ahead_rows =
        static_cast<std::size_t>(block) + 2 < static_cast<std::size_t>(block_count) ? 2 * k_block_rows : 0;

    for (std::size_t lane = 0; lane < whole_lanes; ++lane) {
      const std::size_t column = lane * k_lane_columns;
      std::uint8_t* values =
          scratch.active_values.data() +
          (lane * static_cast<std::size_t>(block_count) + scratch.active_counts[lane]) * k_lane_columns;
      bool active = false;
      if (ahead_rows != 0) {
        for (std::size_t i = 0; i < k_block_rows; ++i)
          hwy::Prefetch(row[i] + ahead_rows * frame.stride_bytes + column);
      }
      for (std::size_t part = 0; part < k_lane_columns; part += step) {
        const std::size_t at = column + part;
        const auto a = hn::Max(hn::LoadU(d, row[0] + at), hn::LoadU(d, row[1] + at));
        const auto b = hn::Max(hn::LoadU(d, row[2] + at), hn::LoadU(d, row[3] + at));
        const auto c = hn::Max(hn::LoadU(d, row[4] + at), hn::LoadU(d, row[5] + at));
        const auto e = hn::Max(hn::LoadU(d, row[6] + at), hn::LoadU(d, row[7] + at));
        const auto maximum = hn::Max(hn::Max(a, b), hn::Max(c, e));
        hn::StoreU(maximum, d, values + part);
        const auto above = hn::Gt(maximum, hn::LoadU(d, scratch.threshold.data() + at));
        active = active || !hn::AllFalse(d, above);
      }
      if (active) {
        scratch.active_blocks[lane * static_cast<std::size_t>(block_count) + scratch.active_counts[lane]] =
            static_cast<std::uint8_t>(block);
        ++scratch.active_counts[lane];
      }
    }
    for (std::size_t lane = whole_lanes; lane < lane_count;
         ++lane) {  // the rest of the width: one lane at most
      const std::size_t column = lane * k_lane_columns, columns = width - column;
      std::uint8_t* values =
          scratch.active_values.data() +
          (lane * static_cast<std::size_t>(block_count) + scratch.active_counts[lane]) * k_lane_columns;
      bool active = false;
      for (std::size_t i = 0; i < columns; ++i) {
        std::uint8_t maximum = 0;
        for (const std::uint8_t* pixels : row) maximum = std::max(maximum, pixels[column + i]);
        values[i] = maximum;
        active = active || maximum > scratch.threshold[column + i];
      }
      if (active) {
        scratch.active_blocks[lane * static_cast<std::size_t>(block_count) + scratch.active_counts[lane]] =
            static_cast<std::uint8_t>(block);
        ++scratch.active_counts[lane];
      }
    }
  }
}

void coarse(const FrameRows& frame, int threshold_grey, CoarseScratch& scratch) {
  quiet_level(frame, threshold_grey, scratch);
  block_maxima(frame, scratch);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::stripe {
namespace {

HWY_EXPORT(coarse);

/// Keeps `found` among the two highest.
void keep(ColumnCandidates& column, Candidate found) {
  if (column.seen_count < 255) ++column.seen_count;
  if (column.kept_count > 0 && found.value > column.kept[0].value) std::swap(found, column.kept[0]);
  if (column.kept_count == 0 || column.kept_count == 1 || found.value > column.kept[1].value) {
    column.kept[std::min<std::size_t>(column.kept_count, 1)] = found;
    column.kept_count = static_cast<std::uint8_t>(std::min(2, column.kept_count + 1));
  }
}

/// Peaks of one column's block maxima.  A peak ends where the maxima fall below half its height, and the next
/// begins where they have doubled again: speckle does not reach that, two stripes do.
void split_peaks(const CoarseScratch& scratch, std::size_t lane, std::size_t blocks_per_lane,
                 std::size_t part, ColumnCandidates& column, std::uint8_t threshold,
                 std::uint8_t background) {
  column.kept_count = 0;
  column.seen_count = 0;
  Candidate peak{};
  int valley = 255;     // height above background
  bool rising = false;  // inside a peak that has not ended
  int last_block = -2;
  const auto end_peak = [&] {
    if (rising) keep(column, peak);
    rising = false;
    valley = 255;
  };
  for (std::size_t i = 0; i < scratch.active_counts[lane]; ++i) {
    const std::size_t entry = lane * blocks_per_lane + i;
    const int block = scratch.active_blocks[entry];
    const std::uint8_t value = scratch.active_values[entry * k_lane_columns + part];
    const int height = value - background;
    if (block != last_block + 1) {
      end_peak();
      valley = 0;
    }
    last_block = block;
    if (value <= threshold) {
      end_peak();
      valley = 0;
    } else if (rising) {
      if (value > peak.value) {
        peak = {static_cast<std::uint8_t>(block), value};
      } else if (2 * height < peak.value - background) {
        keep(column, peak);
        rising = false;
        valley = height;
      }
    } else if (height > 2 * valley) {
      rising = true;
      peak = {static_cast<std::uint8_t>(block), value};
    } else {
      valley = std::min(valley, height);
    }
  }
  end_peak();
}

}  // namespace

void rt_find_candidates(const FrameRows& frame, float threshold_grey,
                        CoarseScratch& scratch) noexcept BITELINE_RT {
  HWY_DYNAMIC_DISPATCH(coarse)(frame, static_cast<int>(threshold_grey), scratch);
  const std::size_t lanes = scratch.active_counts.size();
  const std::size_t blocks_per_lane = scratch.active_blocks.size() / lanes;
  for (std::size_t column = 0; column < static_cast<std::size_t>(frame.width_px); ++column) {
    split_peaks(scratch, column / k_lane_columns, blocks_per_lane, column % k_lane_columns,
                scratch.candidates[column], scratch.threshold[column], scratch.background[column]);
  }
}

}  // namespace biteline::stripe
#endif  // HWY_ONCE
