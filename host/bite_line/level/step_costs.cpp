// SPDX-License-Identifier: MIT
#include "host/bite_line/level/step_costs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_axes = k_grid_steps.size() / 2;
constexpr double k_fine_mm = 0.5;
constexpr double k_noise_rad = 0.05;

/// A cell's neighbours, whole shifts away.
class Shifts {
 public:
  explicit Shifts(const Patch& patch) : patch_{patch} {}

  struct Shift {
    int cols, rows;
  };
  [[nodiscard]] static Shift along(std::size_t k, double mm) {
    const GridStep step = k_grid_steps[k % k_grid_steps.size()];
    const double cells = mm / Patch::k_cell_mm / std::hypot(step.cols, step.rows);
    return {static_cast<int>(std::lround(step.cols * cells)),
            static_cast<int>(std::lround(step.rows * cells))};
  }
  /// To the right of a step.
  [[nodiscard]] static Shift right(std::size_t k, double mm) { return along(k + 12, mm); }

  /// The cell a shift away; none beyond the edge.
  [[nodiscard]] std::ptrdiff_t cell(int row, int col, Shift shift) const {
    const int r = row + shift.rows;
    const int c = col + shift.cols;
    if (r < 0 || r >= patch_.rows || c < 0 || c >= patch_.cols) return -1;
    return static_cast<std::ptrdiff_t>(patch_.at(r, c));
  }
  /// Calls `use(here, there)` with each cell that has one a shift away, column by column.
  template <class Use>
  void for_shifted(Shift shift, Use&& use) const {
    const int first = std::max(0, -shift.rows);
    const int count = patch_.rows - std::abs(shift.rows);
    for (int col = std::max(0, -shift.cols); col < patch_.cols - std::max(0, shift.cols); ++col) {
      if (count <= 0) return;
      const std::size_t here = patch_.at(first, col);
      const std::size_t there = patch_.at(first + shift.rows, col + shift.cols);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) use(here + i, there + i);
    }
  }
  [[nodiscard]] bool seen(std::ptrdiff_t cell) const {
    return cell >= 0 && patch_.seen[static_cast<std::size_t>(cell)] != 0;
  }
  [[nodiscard]] double o(std::ptrdiff_t cell) const {
    return static_cast<double>(patch_.o_mm[static_cast<std::size_t>(cell)]);
  }

 private:
  const Patch& patch_;
};

class Reader : Shifts {
 public:
  Reader(const Patch& patch, const StepLookConfig& config) : Shifts{patch}, patch_{patch}, config_{config} {}

  StepLooks run() {
    tbb::parallel_for(std::size_t{0}, k_axes, [&](std::size_t axis) { read_turns(axis); });
    tbb::parallel_for(std::size_t{0}, looks_.likeness.size(), [&](std::size_t k) {
      read_likeness(k, looks_.likeness[k]);
      add_rims(k, looks_.likeness[k]);
    });
    return std::move(looks_);
  }

 private:
  /// Turn of the surface across an axis, concave > 0, as a mean along that.
  void read_turns(std::size_t axis) {
    constexpr double k_run_mm = 3.0;
    const Shift to_right = right(axis, config_.flank_mm);
    const Shift to_left = right(axis, -config_.flank_mm);
    const double mm = Patch::k_cell_mm * std::hypot(to_right.cols, to_right.rows);
    std::vector<float> turn(patch_.size(), 0.0F);
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        const std::size_t here = patch_.at(row, col);
        const std::ptrdiff_t a = cell(row, col, to_left);
        const std::ptrdiff_t b = cell(row, col, to_right);
        if (patch_.seen[here] == 0 || !seen(a) || !seen(b)) continue;
        const double own = static_cast<double>(patch_.o_mm[here]);
        turn[here] = static_cast<float>(std::atan((o(b) - own) / mm) - std::atan((own - o(a)) / mm));
      }
    }
    std::vector<float>& mean = looks_.turn_rad[axis];
    mean.assign(patch_.size(), 0.0F);
    float count = 0;
    for (double d = -k_run_mm; d <= k_run_mm + 1e-9; d += k_fine_mm, ++count)
      for_shifted(along(axis, d), [&](std::size_t here, std::size_t there) { mean[here] += turn[there]; });
    for (float& value : mean) value /= count;
  }

  struct Place {
    double away_mm;
    Shift shift;
  };
  /// To the right of a step where `side` is 1, to its left where it is -1.
  [[nodiscard]] static std::vector<Place> places_beside(std::size_t k, double side, double from_mm,
                                                        double to_mm) {
    std::vector<Place> all;
    for (double d = from_mm; d <= to_mm + 1e-9; d += k_fine_mm)
      all.push_back({.away_mm = d, .shift = right(k, side * d)});
    return all;
  }

  struct Flank {
    double at_mm, slope;
  };
  /// The surface on one side as a straight line, from the place on.
  [[nodiscard]] std::optional<Flank> flank(int row, int col, std::span<const Place> places) const {
    double n = 0, x = 0, xx = 0, y = 0, xy = 0;
    for (const auto& [d, shift] : places) {
      const std::ptrdiff_t there = cell(row, col, shift);
      if (!seen(there)) continue;
      n += 1;
      x += d;
      xx += d * d;
      y += o(there);
      xy += d * o(there);
    }
    if (n < std::max(2.0, 0.6 * static_cast<double>(places.size()))) return std::nullopt;
    const double slope = (xy / n - x / n * y / n) / std::max(xx / n - x / n * x / n, 1e-6);
    return Flank{y / n - slope * x / n, slope};
  }

  /// Where a sole ends close below a place: the turn there between the sole up to its rim, and the upper over
  /// the same length.
  [[nodiscard]] std::optional<double> turn_at_rim(int row, int col, std::size_t k,
                                                  std::span<const Place> places) const {
    if (config_.rim_rad <= 0) return std::nullopt;
    const std::vector<float>& turns = looks_.turn_rad[k % k_axes];
    double most = config_.rim_rad;
    double rim_mm = 0;
    for (const auto& [d, shift] : places) {
      const std::ptrdiff_t there = cell(row, col, shift);
      const double out = there >= 0 ? -static_cast<double>(turns[static_cast<std::size_t>(there)]) : 0;
      if (rim_mm > 0 && out < most) break;
      if (out <= most) continue;
      most = out;
      rim_mm = d;
    }
    if (rim_mm == 0) return std::nullopt;
    const std::ptrdiff_t rim = cell(row, col, right(k, rim_mm));
    const std::ptrdiff_t wall = cell(row, col, right(k, -rim_mm));
    if (!seen(rim) || !seen(wall)) return std::nullopt;
    const double own = static_cast<double>(patch_.o_mm[patch_.at(row, col)]);
    return std::atan((o(rim) - own) / rim_mm) + std::atan((o(wall) - own) / rim_mm);
  }

  /// As ColumnLikeness has it for a level crease.
  void read_likeness(std::size_t k, std::vector<float>& like) const {
    const EvidenceConfig as{};
    constexpr double k_one_side = 0.6;
    constexpr double k_overhang_mm = 0.5, k_soft_mm = 0.1, k_near_mm = 2.0;
    const std::vector<float>& turns = looks_.turn_rad[k % k_axes];
    like.assign(patch_.size(), 0.0F);
    const std::vector<Place> to_rim = places_beside(k, 1, 1.0, 3.0);
    const std::vector<Place> on_sole = places_beside(k, 1, 1.5, 4.0);
    const std::vector<Place> on_upper = places_beside(k, -1, 1.5, 4.0);
    std::vector<float> crest = turns;  // the sharpest turn about each cell
    for (const double d : {-1.5, -1.0, -0.5, 0.5, 1.0, 1.5})
      for_shifted(right(k, d), [&](std::size_t here, std::size_t there) {
        crest[here] = std::max(crest[here], turns[there]);
      });
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        const std::size_t here = patch_.at(row, col);
        const double turn = static_cast<double>(turns[here]);
        if (patch_.seen[here] == 0 || turn <= k_noise_rad) continue;
        const auto most = static_cast<double>(crest[here]);
        const double plain = 1 - std::exp(-(turn - k_noise_rad) / as.crease_rad);
        if (const std::optional<double> at_rim = turn_at_rim(row, col, k, to_rim)) {
          const double two = geometry::logistic(*at_rim / as.flank_soft_rad);
          like[here] = static_cast<float>(turn / most * plain *
                                          (as.one_surface_ratio + (1 - as.one_surface_ratio) * two));
          continue;
        }
        const std::optional<Flank> sole = flank(row, col, on_sole);
        const std::optional<Flank> upper = flank(row, col, on_upper);
        double two = k_one_side;
        double not_over = 1;
        if (sole && upper) {
          const double step_mm = std::max(sole->at_mm - upper->at_mm, 0.0);
          two = geometry::logistic(
              (std::atan(sole->slope) + std::atan(upper->slope) + as.rad_per_step_mm * step_mm) /
              as.flank_soft_rad);
          const double out_mm =
              upper->at_mm + k_near_mm * upper->slope - sole->at_mm - k_near_mm * sole->slope;
          not_over = geometry::logistic((k_overhang_mm - out_mm) / k_soft_mm);
        }
        like[here] = static_cast<float>(turn / most * plain *
                                        (as.one_surface_ratio + (1 - as.one_surface_ratio) * two) * not_over);
      }
    }
  }

  /// Where a sole is a thin plate, its edge right below a place tells of a crease that hardly shows.
  void add_rims(std::size_t k, std::vector<float>& like) const {
    constexpr double k_rim_ratio = 0.6;  // of a plain crease
    constexpr double k_from_mm = 1.0, k_to_mm = 2.0;
    constexpr float k_least_rad = 0.15F;
    const std::vector<float>& turns = looks_.turn_rad[k % k_axes];
    std::vector<float> out(patch_.size(), k_least_rad);
    for (double d = k_from_mm; d <= k_to_mm + 1e-9; d += k_fine_mm)
      for_shifted(right(k, d), [&](std::size_t here, std::size_t there) {
        out[here] = std::max(out[here], -turns[there]);
      });
    for (std::size_t i = 0; i < like.size(); ++i) {
      if (patch_.seen[i] == 0 || out[i] <= k_least_rad) continue;
      const double over = static_cast<double>(out[i] - k_least_rad);
      const double plain = 1 - std::exp(-over / EvidenceConfig{}.crease_rad);
      like[i] = std::max(like[i], static_cast<float>(k_rim_ratio * plain));
    }
  }

  const Patch& patch_;
  const StepLookConfig& config_;
  StepLooks looks_;
};

class CostMaker : Shifts {
 public:
  CostMaker(const Patch& patch, const StepLooks& looks) : Shifts{patch}, patch_{patch}, looks_{looks} {}

  /// The most line-like place on the upper's side of each one, of a crease that runs nearly alike.
  [[nodiscard]] std::vector<float> left_above(std::size_t k, double to_mm) const {
    const EvidenceConfig as{};
    constexpr double k_every_mm = 1.0;
    constexpr std::size_t k_alike = 2;
    std::vector<float> above(patch_.size(), 0.0F);
    if (to_mm < as.above_from_mm) return above;
    std::vector<float> like = looks_.likeness[k];
    for (std::size_t j = 1; j <= k_alike; ++j) {
      for (const std::size_t other : {k + j, k + looks_.likeness.size() - j})
        for (std::size_t i = 0; i < like.size(); ++i)
          like[i] = std::max(like[i], looks_.likeness[other % looks_.likeness.size()][i]);
    }
    for (double d = as.above_from_mm; d <= to_mm; d += k_every_mm)
      for_shifted(right(k, -d), [&](std::size_t here, std::size_t there) {
        above[here] = std::max(above[here], like[there]);
      });
    return above;
  }

  [[nodiscard]] std::vector<float> cost_of(std::size_t k, std::vector<float> above) const {
    constexpr float k_least_cost = 0.02F;
    constexpr float k_ridge_cost = 20;  // per radian that the surface turns outwards on the way
    const auto above_ratio = static_cast<float>(EvidenceConfig{}.above_ratio);
    const std::vector<float>& like = looks_.likeness[k];
    // The surface's turn on the way along a step is that across the axis square to it.
    const std::vector<float>& ahead = looks_.turn_rad[(k + k_axes / 2) % k_axes];
    std::vector<float> costs = std::move(above);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      float cost = k_unseen_cost;
      if (patch_.seen[i] != 0) {
        const float out = std::clamp(-ahead[i] - static_cast<float>(k_noise_rad), 0.0F, 1.0F);
        cost = (1 - like[i]) * (1 - like[i]) * (1 + k_ridge_cost * out);
      }
      costs[i] = std::max(k_least_cost, cost + above_ratio * costs[i]);
    }
    return costs;
  }

 private:
  const Patch& patch_;
  const StepLooks& looks_;
};

}  // namespace

StepLooks look_at_steps(const Patch& patch, const StepLookConfig& config) {
  return Reader{patch, config}.run();
}

StepCosts step_costs(const Patch& patch, const StepLooks& looks, double above_to_mm) {
  const CostMaker maker{patch, looks};
  StepCosts costs;
  tbb::parallel_for(std::size_t{0}, costs.size(),
                    [&](std::size_t k) { costs[k] = maker.cost_of(k, maker.left_above(k, above_to_mm)); });
  return costs;
}

}  // namespace biteline::bite_line
