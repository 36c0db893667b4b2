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

namespace biteline::bite_line {

namespace {

/// Sums along a column from its bottom, so that a straight line through any of its rows takes two look-ups.
struct RunningSums {
  struct Sums {
    double n{0}, z{0}, zz{0}, o{0}, zo{0};
  };
  std::vector<Sums> upto;  ///< of the rows below each

  void of(const SideField& field, int col) {
    const SideGrid& grid = field.grid;
    upto.assign(static_cast<std::size_t>(grid.rows) + 1, {});
    for (int row = 0; row < grid.rows; ++row) {
      const auto at = static_cast<std::size_t>(row);
      Sums sums = upto[at];
      const std::size_t cell = grid.at(row, col);
      if (field.seen[cell] != 0) {
        const double z = row * grid.row_mm;
        const auto o = static_cast<double>(field.o_mm[cell]);
        sums = {sums.n + 1, sums.z + z, sums.zz + z * z, sums.o + o, sums.zo + z * o};
      }
      upto[at + 1] = sums;
    }
  }
  /// Line o = at + slope (z - z0) through the rows low to high; false with less than 60 % of them seen.
  bool line(int low, int high, double z0_mm, double& at_mm, double& slope) const {
    const int rows = static_cast<int>(upto.size()) - 1;
    const int first = std::max(low, 0);
    const int end = std::min(high + 1, rows);
    if (first >= end) return false;
    const Sums& a = upto[static_cast<std::size_t>(first)];
    const Sums& b = upto[static_cast<std::size_t>(end)];
    const double n = b.n - a.n;
    if (n < 0.6 * (high - low + 1)) return false;
    const double z = (b.z - a.z) / n;
    const double o = (b.o - a.o) / n;
    const double spread = (b.zz - a.zz) / n - z * z;
    if (spread < 1e-6) return false;
    slope = ((b.zo - a.zo) / n - z * o) / spread;
    at_mm = o + slope * (z0_mm - z);
    return true;
  }
};

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

  /// Of one column; `along` is room for as many values.
  void of(int col, std::span<float> most, std::vector<float>& along) const {
    std::fill(most.begin(), most.end(), 0.0F);
    along.resize(most.size());
    std::vector<Tap> taps(static_cast<std::size_t>(2 * reach_ + 1));
    const float weight = 1.0F / static_cast<float>(taps.size());
    for (const int half : k_half_rows) {
      for (int j = -reach_; j <= reach_; ++j) {
        const int other = ((col + 2 * j) % grid_.cols + grid_.cols) % grid_.cols;
        taps[static_cast<std::size_t>(j + reach_)] = {
            turn_.data() + height_ * static_cast<std::size_t>(other) + margin_ + half * j, weight};
      }
      sum_taps(along, taps);
      for (std::size_t row = 0; row < most.size(); ++row) most[row] = std::max(most[row], along[row]);
    }
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
      : field_{field}, runs_{runs}, config_{config} {}

  void of(int col, float* likeness) {
    const SideGrid& grid = field_.grid;
    sums_.of(field_, col);
    turn_.resize(static_cast<std::size_t>(grid.rows));
    runs_.of(col, turn_, along_);
    noise_rad_ = std::max(config_.noise_rad, config_.rough_ratio * roughness(col));
    for (int row = 0; row < grid.rows; ++row) likeness[row] = static_cast<float>(likeness_at(row));
  }

 private:
  [[nodiscard]] int rows_of(double mm) const {
    return static_cast<int>(std::lround(mm / field_.grid.row_mm));
  }

  /// Median turn of the column, either way: weave, noise, or few points.
  double roughness(int col) {
    const SideGrid& grid = field_.grid;
    along_.clear();
    for (int row = 0; row < grid.rows; row += 2) {
      const std::size_t cell = grid.at(row, col);
      if (field_.seen[cell] != 0) along_.push_back(std::abs(field_.turn_rad[cell]));
    }
    if (along_.empty()) return 0;
    const auto middle = along_.begin() + static_cast<std::ptrdiff_t>(along_.size() / 2);
    std::nth_element(along_.begin(), middle, along_.end());
    return static_cast<double>(*middle);
  }

  [[nodiscard]] double likeness_at(int row) const {
    const auto turn = static_cast<double>(turn_[static_cast<std::size_t>(row)]);
    if (turn <= noise_rad_) return 0;
    // A line is where the surface turns most, and not on the flank of that.
    double most = turn;
    const int reach = rows_of(config_.crest_mm);
    for (int r = std::max(0, row - reach); r <= std::min(field_.grid.rows - 1, row + reach); ++r)
      most = std::max(most, static_cast<double>(turn_[static_cast<std::size_t>(r)]));
    const double crease = turn / most * (1 - std::exp(-(turn - noise_rad_) / config_.crease_rad));
    return crease * (config_.one_surface_ratio + (1 - config_.one_surface_ratio) * two_surfaces(row)) *
           not_overhung(row);
  }

  /// That what lies 1 to 3 mm above does not stand out beyond what lies as far below: the lower edge of a
  /// piece laid on the upper is a crease, too.
  [[nodiscard]] double not_overhung(int row) const {
    const double z0_mm = row * field_.grid.row_mm;
    double above_mm = 0, above = 0, below_mm = 0, below = 0;
    if (!sums_.line(row + rows_of(1.0), row + rows_of(3.0), z0_mm, above_mm, above) ||
        !sums_.line(row - rows_of(3.0), row - rows_of(1.0), z0_mm, below_mm, below))
      return 1;
    constexpr double k_overhang_mm = 0.5;
    constexpr double k_soft_mm = 0.1;
    constexpr double k_certain = 30;  // beyond it the power of e leaves what a number holds
    return 1.0 / (1.0 + std::exp(std::clamp((above_mm - below_mm - k_overhang_mm) / k_soft_mm, -k_certain,
                                            k_certain)));
  }

  /// That the surfaces 2 to 6 mm above and below are two: they turn against each other or one stands out.
  [[nodiscard]] double two_surfaces(int row) const {
    const double z0_mm = row * field_.grid.row_mm;
    double above_mm = 0, above = 0, below_mm = 0, below = 0;
    if (!sums_.line(row + rows_of(2.0), row + rows_of(6.0), z0_mm, above_mm, above) ||
        !sums_.line(row - rows_of(6.0), row - rows_of(2.0), z0_mm, below_mm, below))
      return 0.6;
    const double between =
        std::atan(above) - std::atan(below) + config_.rad_per_step_mm * std::max(below_mm - above_mm, 0.0);
    return 1.0 / (1.0 + std::exp(-between / config_.flank_soft_rad));
  }

  const SideField& field_;
  const Runs& runs_;
  const EvidenceConfig& config_;
  RunningSums sums_;
  std::vector<float> turn_;   ///< along the best direction
  std::vector<float> along_;  ///< room for that
  double noise_rad_{0};
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
