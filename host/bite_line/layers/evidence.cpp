// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/bite_line/lanes.hpp"
#include "host/bite_line/layers/likeness.hpp"

namespace biteline::bite_line {

namespace {

/// The turn averaged along the direction in which it is largest: a crease runs on, noise and weave do not.
///
/// Columns lie between margins of empty rows, so that a direction is a shift of whole columns.
class Runs {
 public:
  Runs(const SideField& field, const EvidenceConfig& config)
      : grid_{field.grid},
        reach_{std::max(1, static_cast<int>(std::lround(config.run_mm / field.grid.col_mm / 2)))},
        margin_{2 * reach_ * k_steepest + 4},
        height_{static_cast<std::size_t>(grid_.rows) + 2 * static_cast<std::size_t>(margin_)} {
    turn_.resize(height_ * static_cast<std::size_t>(grid_.cols));
    tbb::parallel_for(tbb::blocked_range<int>{0, grid_.cols, 16}, [&](const auto& range) {
      for (int col = range.begin(); col != range.end(); ++col) {
        float* column = turn_.data() + height_ * static_cast<std::size_t>(col);
        std::fill_n(column, height_, 0.0F);
        column += margin_;
        for (int row = 0; row < grid_.rows; ++row) {
          const std::size_t cell = grid_.at(row, col);
          // The wider turn sees rounded creases, the narrower one fine grooves; the wider one also turns with
          // the shoe's own shape, hence the discount.
          if (field.seen[cell] != 0)
            column[row] = std::max(field.turn_rad[cell], 0.8F * field.wide_turn_rad[cell]);
        }
      }
    });
  }

  /// Of one column; `taps` is room for the work.
  void of(int col, std::span<float> most, std::vector<Tap>& taps) const {
    const auto together = static_cast<std::size_t>(2 * reach_ + 1);
    const float weight = 1.0F / static_cast<float>(together);
    taps.clear();
    for (const int half : k_half_rows) {
      for (int j = -reach_; j <= reach_; ++j) {
        const int other = ((col + 2 * j) % grid_.cols + grid_.cols) % grid_.cols;
        taps.push_back(
            {turn_.data() + height_ * static_cast<std::size_t>(other) + margin_ + half * j, weight});
      }
    }
    most_of_sums(most, taps, together);
  }

 private:
  static constexpr int k_steepest = 4;  // rows a column: 45 degrees
  // Half a row a column between two directions, that is 3 rows at the run's end: a crease's width.  Steep
  // ones are rare and short.
  static constexpr std::array k_half_rows{-8, -6, -4, -3, -2, -1, 0, 1, 2, 3, 4, 6, 8};
  const SideGrid& grid_;
  int reach_;  ///< every second column to both sides
  int margin_;
  std::size_t height_;
  Large<float> turn_;
};

class ColumnEvidence {
 public:
  ColumnEvidence(const SideField& field, const Runs& runs, const EvidenceConfig& config)
      : field_{field},
        runs_{runs},
        config_{config},
        likeness_{likeness_config(field.grid, config), static_cast<std::size_t>(field.grid.rows)} {}

  void of(int col, float* likeness) {
    runs_.of(col, likeness_.turn_rad(), taps_);
    const double noise_rad = noise_of(col);
    const std::size_t first = field_.grid.at(0, col);
    const std::span like = likeness_.of(field_.o_mm.data() + first, field_.seen.data() + first, noise_rad);
    std::copy(like.begin(), like.end(), likeness);
  }

 private:
  static LikenessConfig likeness_config(const SideGrid& grid, const EvidenceConfig& config) {
    const auto rows_of = [&](double mm) { return static_cast<int>(std::lround(mm / grid.row_mm)); };
    return {.row_mm = grid.row_mm,
            .crease_rad = config.crease_rad,
            .crest = rows_of(config.crest_mm),
            .one_surface_ratio = config.one_surface_ratio,
            .flank_soft_rad = config.flank_soft_rad,
            .rad_per_step_mm = config.rad_per_step_mm,
            .near_from = rows_of(1.0),
            .near_to = rows_of(3.0),
            .flank_from = rows_of(2.0),
            .flank_to = rows_of(6.0),
            .rim_from = rows_of(0.75),
            .rim_to = config.thin_soles ? rows_of(3.0) : 0,
            .rim_rad = 0.5};
  }

  /// Turns that are nothing: more than usual where most of the column turns, either way, as weave, noise and
  /// few points do.
  double noise_of(int col) {
    const SideGrid& grid = field_.grid;
    sizes_.resize(static_cast<std::size_t>(grid.rows));
    std::size_t seen = 0;
    std::size_t calm = 0;
    for (int row = 0; row < grid.rows; row += 2) {
      const std::size_t cell = grid.at(row, col);
      const float size = std::abs(field_.turn_rad[cell]);
      sizes_[seen] = size;
      seen += field_.seen[cell];
      calm += config_.rough_ratio * static_cast<double>(size) <= config_.noise_rad ? field_.seen[cell] : 0U;
    }
    sizes_.resize(seen);
    if (sizes_.empty() || calm > sizes_.size() / 2) return config_.noise_rad;
    const auto middle = sizes_.begin() + static_cast<std::ptrdiff_t>(sizes_.size() / 2);
    std::nth_element(sizes_.begin(), middle, sizes_.end());
    return config_.rough_ratio * static_cast<double>(*middle);
  }

  const SideField& field_;
  const Runs& runs_;
  const EvidenceConfig& config_;
  ColumnLikeness likeness_;
  std::vector<Tap> taps_;
  std::vector<float> sizes_;
};

/// What a course through each place of a column costs.
class ColumnCost {
 public:
  ColumnCost(const SideField& field, const Evidence& evidence, const EvidenceConfig& config)
      : field_{field}, evidence_{evidence}, config_{config} {}

  void of(int col, float* cost) {
    const SideGrid& grid = field_.grid;
    worth_.clear();
    for (int row = 0; row < grid.rows; ++row) worth_.push_back(worth_at(grid.at(row, col)));
    leave_above();
    for (int row = 0; row < grid.rows; ++row)
      cost[row] = (field_.seen[grid.at(row, col)] != 0 ? 1.0F : static_cast<float>(config_.unseen_cost)) -
                  worth_[static_cast<std::size_t>(row)] +
                  static_cast<float>(config_.above_ratio) * above_[static_cast<std::size_t>(row)];
  }

 private:
  [[nodiscard]] int rows_of(double mm) const {
    return static_cast<int>(std::lround(mm / field_.grid.row_mm));
  }

  /// Likeness, less where the crease goes round by a part only.
  [[nodiscard]] float worth_at(std::size_t cell) const {
    if (evidence_.likeness[cell] == 0) return 0;
    const double whole = std::clamp((static_cast<double>(evidence_.round[cell]) - config_.part_share) /
                                        (config_.whole_share - config_.part_share),
                                    0.0, 1.0);
    return static_cast<float>(config_.part_ratio + (1 - config_.part_ratio) * whole) *
           evidence_.likeness[cell];
  }

  /// The most line-like crease above each row.
  void leave_above() {
    const int rows = field_.grid.rows;
    above_.assign(static_cast<std::size_t>(rows), 0.0F);
    const int from = rows_of(config_.above_from_mm);
    const int to = rows_of(config_.above_to_mm);
    const int reach = rows_of(1.0);
    for (int peak = from; peak < rows; ++peak) {
      const float value = worth_[static_cast<std::size_t>(peak)];
      if (value < 0.15F) continue;
      bool highest = true;
      for (int r = std::max(0, peak - reach); highest && r <= std::min(rows - 1, peak + reach); ++r)
        highest = worth_[static_cast<std::size_t>(r)] <= value;
      if (!highest) continue;
      for (int r = std::max(0, peak - to); r <= peak - from; ++r) {
        float& above = above_[static_cast<std::size_t>(r)];
        above = std::max(above, value);
      }
    }
  }

  const SideField& field_;
  const Evidence& evidence_;
  const EvidenceConfig& config_;
  std::vector<float> worth_;
  std::vector<float> above_;
};

}  // namespace

Evidence find_evidence(const SideField& field, const EvidenceConfig& config) {
  const SideGrid& grid = field.grid;
  Evidence evidence;
  evidence.likeness.resize(grid.size());
  evidence.cost.resize(grid.size());
  const Runs runs{field, config};
  using Cols = tbb::blocked_range<int>;
  tbb::parallel_for(Cols{0, grid.cols, 16}, [&](const Cols& range) {
    ColumnEvidence column{field, runs, config};
    for (int col = range.begin(); col != range.end(); ++col)
      column.of(col, evidence.likeness.data() + grid.at(0, col));
  });
  evidence.round = share_round(grid, {evidence.likeness.data(), evidence.likeness.size()}, config.chain);
  tbb::parallel_for(Cols{0, grid.cols, 16}, [&](const Cols& range) {
    ColumnCost column{field, evidence, config};
    for (int col = range.begin(); col != range.end(); ++col)
      column.of(col, evidence.cost.data() + grid.at(0, col));
  });
  return evidence;
}

}  // namespace biteline::bite_line
