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

/// Mean over the pairs of the pairs' minima, and the thresholds above it.
void quiet_level(const FrameRows& frame, const SearchPlan& plan, CoarseScratch& scratch) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto height = static_cast<std::size_t>(frame.height_px),
             width = static_cast<std::size_t>(frame.width_px);
  const auto threshold = hn::Set(d, static_cast<std::uint8_t>(plan.threshold_grey)),
             suspect = hn::Set(d, static_cast<std::uint8_t>(plan.suspect_grey));
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
    hn::StoreU(hn::SaturatedAdd(level, suspect), d, scratch.suspect.data() + column);
  }
  for (std::size_t column = width - width % lanes; column < width; ++column) {
    int sum = 0;
    for (int pair = 0; pair < k_pairs; ++pair) {
      const std::uint8_t* upper = frame.pixels + pair_row(pair) * frame.stride_bytes + column;
      sum += std::min(*upper, upper[(height / 2) * frame.stride_bytes]);
    }
    const int level = (sum + k_pairs / 2) / k_pairs;
    scratch.background[column] = static_cast<std::uint8_t>(level);
    scratch.threshold[column] = static_cast<std::uint8_t>(std::min(255, level + plan.threshold_grey));
    scratch.suspect[column] = static_cast<std::uint8_t>(std::min(255, level + plan.suspect_grey));
  }
}

/// Lanes are as wide as a cache line; the last one is moved back to end with the row.  Columns that it shares
/// with the one before come out the same from both.
struct LaneGrid {
  std::size_t width;
  std::size_t count;

  explicit LaneGrid(const FrameRows& frame)
      : width{static_cast<std::size_t>(frame.width_px)},
        count{(width + k_lane_columns - 1) / k_lane_columns} {}
  [[nodiscard]] std::size_t first_column(std::size_t lane) const {
    return std::min(lane * k_lane_columns, width - std::min<std::size_t>(width, k_lane_columns));
  }
  /// Less than k_lane_columns in frames that are narrower than that.
  [[nodiscard]] std::size_t columns() const { return std::min<std::size_t>(width, k_lane_columns); }
};

/// The rows of one block; a short last block repeats its last row.
struct BlockRows {
  std::array<const std::uint8_t*, k_block_rows> row;

  BlockRows(const FrameRows& frame, int block) {
    const int first = block * k_block_rows;
    for (int i = 0; i < k_block_rows; ++i) {
      row[static_cast<std::size_t>(i)] =
          frame.pixels +
          static_cast<std::size_t>(std::min(first + i, frame.height_px - 1)) * frame.stride_bytes;
    }
  }
};

/// The rows read in every block: in the middle of what each stands for, so that none is farther than half a
/// stride from one of them.
template <int kStride>
constexpr std::size_t sampled_row(std::size_t i) {
  return i * kStride + kStride / 4;
}

template <int kStride, class D>
HWY_INLINE hn::Vec<D> sampled_maximum(D d, const BlockRows& block, std::size_t at) {
  auto maximum = hn::LoadU(d, block.row[sampled_row<kStride>(0)] + at);
  for (std::size_t i = 1; i < k_block_rows / kStride; ++i)
    maximum = hn::Max(maximum, hn::LoadU(d, block.row[sampled_row<kStride>(i)] + at));
  return maximum;
}

/// Notes a lane's maxima over all rows of the block when one is above the threshold.
void note_block(const BlockRows& block, int block_number, const LaneGrid& grid, std::size_t lane,
                CoarseScratch& scratch) {
  const hn::CappedTag<std::uint8_t, k_lane_columns> d;
  const std::size_t step = hn::Lanes(d), column = grid.first_column(lane);
  const std::size_t blocks_per_lane = scratch.active_blocks.size() / grid.count;
  const std::size_t entry = lane * blocks_per_lane + scratch.active_counts[lane];
  std::uint8_t* values = scratch.active_values.data() + entry * k_lane_columns;
  bool active = false;
  if (grid.columns() == k_lane_columns) {
    for (std::size_t part = 0; part < k_lane_columns; part += step) {
      const auto maximum = sampled_maximum<1>(d, block, column + part);
      hn::StoreU(maximum, d, values + part);
      const auto above = hn::Gt(maximum, hn::LoadU(d, scratch.threshold.data() + column + part));
      active = active || !hn::AllFalse(d, above);
    }
  } else {
    for (std::size_t i = 0; i < grid.columns(); ++i) {
      std::uint8_t maximum = 0;
      for (const std::uint8_t* row : block.row) maximum = std::max(maximum, row[i]);
      values[i] = maximum;
      active = active || maximum > scratch.threshold[i];
    }
  }
  if (!active) return;
  scratch.active_blocks[entry] = static_cast<std::uint8_t>(block_number);
  ++scratch.active_counts[lane];
}

/// Notes the block maxima of each lane of columns in which one is above the threshold.
template <int kStride>
void block_maxima(const FrameRows& frame, CoarseScratch& scratch) {
  const hn::CappedTag<std::uint8_t, k_lane_columns> d;
  const std::size_t step = hn::Lanes(d);
  const LaneGrid grid{frame};
  const int block_count = (frame.height_px + k_block_rows - 1) / k_block_rows;
  std::fill(scratch.active_counts.begin(), scratch.active_counts.end(), std::uint16_t{0});
  // Some 26 kB ahead, whatever the stride: far enough to hide memory, near enough to be still there.
  constexpr int k_blocks_ahead = 2 * kStride;

  for (int number = 0; number < block_count; ++number) {
    const BlockRows block{frame, number};
    const std::size_t ahead_bytes =
        number + k_blocks_ahead < block_count ? k_blocks_ahead * k_block_rows * frame.stride_bytes : 0;
    std::size_t suspects = 0;
    for (std::size_t lane = 0; lane < grid.count; ++lane) {
      const std::size_t column = grid.first_column(lane);
      for (std::size_t i = 0; i < k_block_rows / kStride; ++i)
        hwy::Prefetch(block.row[sampled_row<kStride>(i)] + ahead_bytes + column);
      bool suspicious = grid.columns() < k_lane_columns;
      if (!suspicious) {
        for (std::size_t part = 0; part < k_lane_columns; part += step) {
          const std::size_t at = column + part;
          const auto above =
              hn::Gt(sampled_maximum<kStride>(d, block, at), hn::LoadU(d, scratch.suspect.data() + at));
          suspicious = suspicious || !hn::AllFalse(d, above);
        }
      }
      if (!suspicious) continue;
      scratch.suspect_lanes[suspects++] = static_cast<std::uint16_t>(lane);
      if constexpr (kStride > 1) {
        for (const std::uint8_t* row : block.row) hwy::Prefetch(row + column);
      }
    }
    for (std::size_t i = 0; i < suspects; ++i)
      note_block(block, number, grid, scratch.suspect_lanes[i], scratch);
  }
}

/// Peaks of each column's block maxima.  A peak ends where the maxima fall below half its height, and the
/// next begins where they have doubled again: speckle does not reach that, two stripes do.
template <class D>
class PeakSplitter {
 public:
  using V = hn::Vec<D>;
  using M = hn::Mask<D>;

  PeakSplitter(D d, const std::uint8_t* background, const std::uint8_t* threshold)
      : d_{d},
        background_{hn::LoadU(d, background)},
        threshold_{hn::LoadU(d, threshold)},
        valley_{hn::Zero(d)},
        rising_{hn::Zero(d)},
        peak_value_{hn::Zero(d)},
        peak_block_{hn::Zero(d)},
        value_{hn::Zero(d), hn::Zero(d)},
        block_{hn::Zero(d), hn::Zero(d)},
        seen_{hn::Zero(d)} {}

  /// The next block's maxima; `gap`: blocks without any were left out before it.
  HWY_INLINE void add(V value, std::uint8_t block, bool gap) {
    if (gap) {
      end_peaks(is_rising());
      valley_ = hn::Zero(d_);
    }
    const V height = hn::SaturatedSub(value, background_);
    const M high = hn::Gt(value, threshold_);
    end_peaks(hn::AndNot(high, is_rising()));
    const M rising = is_rising();  // those end no more, except by falling to half
    const M higher = hn::And(rising, hn::Gt(value, peak_value_));
    const M halved = hn::AndNot(higher, hn::And(rising, hn::Lt(hn::SaturatedAdd(height, height),
                                                               hn::SaturatedSub(peak_value_, background_))));
    const M waiting = hn::AndNot(rising, high);
    const M begins = hn::And(waiting, hn::Gt(height, hn::SaturatedAdd(valley_, valley_)));
    end_peaks(halved);
    valley_ = hn::IfThenElse(halved, height, hn::IfThenElse(waiting, hn::Min(valley_, height), valley_));
    valley_ = hn::IfThenElse(high, valley_, hn::Zero(d_));
    rising_ = hn::IfThenElse(begins, hn::Set(d_, 255), rising_);
    const M now = hn::Or(higher, begins);
    peak_value_ = hn::IfThenElse(now, value, peak_value_);
    peak_block_ = hn::IfThenElse(now, hn::Set(d_, block), peak_block_);
  }

  HWY_INLINE void store(Candidates& out, std::size_t column) {
    end_peaks(is_rising());
    for (std::size_t rank = 0; rank < k_kept_peaks; ++rank) {
      hn::StoreU(value_[rank], d_, out.value[rank].data() + column);
      hn::StoreU(block_[rank], d_, out.block[rank].data() + column);
    }
    hn::StoreU(seen_, d_, out.seen_count.data() + column);
  }

 private:
  HWY_INLINE M is_rising() const { return hn::Gt(rising_, hn::Zero(d_)); }

  /// Keeps the peaks of these columns, if they are among the two highest.
  HWY_INLINE void end_peaks(M columns) {
    const M first = hn::And(columns, hn::Gt(peak_value_, value_[0]));
    const M second = hn::AndNot(first, hn::And(columns, hn::Gt(peak_value_, value_[1])));
    value_[1] = hn::IfThenElse(first, value_[0], hn::IfThenElse(second, peak_value_, value_[1]));
    block_[1] = hn::IfThenElse(first, block_[0], hn::IfThenElse(second, peak_block_, block_[1]));
    value_[0] = hn::IfThenElse(first, peak_value_, value_[0]);
    block_[0] = hn::IfThenElse(first, peak_block_, block_[0]);
    seen_ = hn::SaturatedAdd(seen_, hn::IfThenElseZero(columns, hn::Set(d_, 1)));
    rising_ = hn::IfThenElse(columns, hn::Zero(d_), rising_);
  }

  D d_;
  V background_, threshold_;
  V valley_;  ///< lowest height since the last peak ended
  V rising_;  ///< not 0: inside a peak that has not ended
  V peak_value_, peak_block_;
  V value_[k_kept_peaks], block_[k_kept_peaks];
  V seen_;
};

void split_peaks(const FrameRows& frame, CoarseScratch& scratch) {
  const hn::CappedTag<std::uint8_t, k_lane_columns> d;
  const LaneGrid grid{frame};
  const std::size_t blocks_per_lane = scratch.active_blocks.size() / grid.count;
  for (std::size_t lane = 0; lane < grid.count; ++lane) {
    // In a frame narrower than a lane the work space is a whole lane all the same.
    for (std::size_t part = 0; part < k_lane_columns; part += hn::Lanes(d)) {
      const std::size_t column = grid.first_column(lane) + part;
      PeakSplitter splitter{d, scratch.background.data() + column, scratch.threshold.data() + column};
      int last_block = -2;
      for (std::size_t i = 0; i < scratch.active_counts[lane]; ++i) {
        const std::size_t entry = lane * blocks_per_lane + i;
        const std::uint8_t block = scratch.active_blocks[entry];
        splitter.add(hn::LoadU(d, scratch.active_values.data() + entry * k_lane_columns + part), block,
                     block != last_block + 1);
        last_block = block;
      }
      splitter.store(scratch.candidates, column);
    }
  }
}

void find(const FrameRows& frame, const SearchPlan& plan, CoarseScratch& scratch) {
  quiet_level(frame, plan, scratch);
  switch (plan.row_stride) {
    case 4:
      block_maxima<4>(frame, scratch);
      break;
    case 2:
      block_maxima<2>(frame, scratch);
      break;
    default:
      block_maxima<1>(frame, scratch);
      break;
  }
  split_peaks(frame, scratch);
}

}  // namespace HWY_NAMESPACE
}  // namespace biteline::stripe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace biteline::stripe {
namespace {

HWY_EXPORT(find);

}  // namespace

void rt_find_candidates(const FrameRows& frame, const SearchPlan& plan,
                        CoarseScratch& scratch) noexcept BITELINE_RT {
  HWY_DYNAMIC_DISPATCH(find)(frame, plan, scratch);
}

}  // namespace biteline::stripe
#endif  // HWY_ONCE
