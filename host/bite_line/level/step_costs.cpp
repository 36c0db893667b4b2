// SPDX-License-Identifier: MIT
#include "host/bite_line/level/step_costs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <tbb/parallel_for.h>

#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_axes = k_grid_steps.size() / 2;
constexpr double k_fine_mm = 0.5;

class Reader {
 public:
  Reader(const Patch& patch, const StepCostConfig& config) : patch_{patch}, config_{config} {}

  StepCosts run() {
    tbb::parallel_for(std::size_t{0}, k_axes, [&](std::size_t axis) { read_turns(axis); });
    StepCosts values;
    tbb::parallel_for(std::size_t{0}, values.size(), [&](std::size_t k) { read_likeness(k, values[k]); });
    tbb::parallel_for(std::size_t{0}, values.size(), [&](std::size_t k) { add_rims(k, values[k]); });
    const auto likeness = values;
    tbb::parallel_for(std::size_t{0}, values.size(), [&](std::size_t k) {
      const std::vector<float> above = leave_above(likeness, k);
      to_cost(k, above, values[k]);
    });
    return values;
  }

 private:
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
  [[nodiscard]] bool seen(std::ptrdiff_t cell) const {
    return cell >= 0 && patch_.seen[static_cast<std::size_t>(cell)] != 0;
  }
  [[nodiscard]] double o(std::ptrdiff_t cell) const {
    return static_cast<double>(patch_.o_mm[static_cast<std::size_t>(cell)]);
  }

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
    std::vector<Shift> run;
    for (double d = -k_run_mm; d <= k_run_mm + 1e-9; d += k_fine_mm) run.push_back(along(axis, d));
    std::vector<float>& mean = turns_[axis];
    mean.resize(patch_.size());
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        float sum = 0;
        for (const Shift shift : run) {
          const std::ptrdiff_t there = cell(row, col, shift);
          if (there >= 0) sum += turn[static_cast<std::size_t>(there)];
        }
        mean[patch_.at(row, col)] = sum / static_cast<float>(run.size());
      }
    }
  }

  struct Flank {
    double at_mm, slope;
  };
  /// The surface on one side as a straight line, from the place on.
  [[nodiscard]] std::optional<Flank> flank(int row, int col, std::size_t k, double side) const {
    constexpr double k_from_mm = 1.5, k_to_mm = 4.0;
    double n = 0, x = 0, xx = 0, y = 0, xy = 0, all = 0;
    for (double d = k_from_mm; d <= k_to_mm + 1e-9; d += k_fine_mm) {
      const std::ptrdiff_t there = cell(row, col, right(k, side * d));
      ++all;
      if (!seen(there)) continue;
      n += 1;
      x += d;
      xx += d * d;
      y += o(there);
      xy += d * o(there);
    }
    if (n < std::max(2.0, 0.6 * all)) return std::nullopt;
    const double slope = (xy / n - x / n * y / n) / std::max(xx / n - x / n * x / n, 1e-6);
    return Flank{y / n - slope * x / n, slope};
  }

  /// Where a sole ends close below a place: the turn there between the sole up to its rim, and the upper over
  /// the same length.
  [[nodiscard]] std::optional<double> turn_at_rim(int row, int col, std::size_t k) const {
    constexpr double k_from_mm = 1.0, k_to_mm = 3.0;
    if (config_.rim_rad <= 0) return std::nullopt;
    const std::vector<float>& turns = turns_[k % k_axes];
    double most = config_.rim_rad;
    double rim_mm = 0;
    for (double d = k_from_mm; d <= k_to_mm + 1e-9; d += k_fine_mm) {
      const std::ptrdiff_t there = cell(row, col, right(k, d));
      const double out = there >= 0 ? -static_cast<double>(turns[static_cast<std::size_t>(there)]) : 0;
      if (rim_mm > 0 && out < most) break;
      if (out <= most) continue;
      most = out;
      rim_mm = d;
    }
    const std::ptrdiff_t rim = cell(row, col, right(k, rim_mm));
    const std::ptrdiff_t wall = cell(row, col, right(k, -rim_mm));
    if (rim_mm == 0 || !seen(rim) || !seen(wall)) return std::nullopt;
    const double own = static_cast<double>(patch_.o_mm[patch_.at(row, col)]);
    return std::atan((o(rim) - own) / rim_mm) + std::atan((o(wall) - own) / rim_mm);
  }

  /// As ColumnLikeness has it for a level crease.
  void read_likeness(std::size_t k, std::vector<float>& like) const {
    const EvidenceConfig as{};
    constexpr double k_one_side = 0.6;
    constexpr double k_overhang_mm = 0.5, k_soft_mm = 0.1, k_near_mm = 2.0;
    const std::vector<float>& turns = turns_[k % k_axes];
    like.assign(patch_.size(), 0.0F);
    std::vector<Shift> crest;
    for (const double d : {-1.5, -1.0, -0.5, 0.5, 1.0, 1.5}) crest.push_back(right(k, d));
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        const std::size_t here = patch_.at(row, col);
        const double turn = static_cast<double>(turns[here]);
        if (patch_.seen[here] == 0 || turn <= k_noise_rad) continue;
        double most = turn;
        for (const Shift shift : crest) {
          const std::ptrdiff_t there = cell(row, col, shift);
          if (there >= 0) most = std::max(most, static_cast<double>(turns[static_cast<std::size_t>(there)]));
        }
        const double plain = 1 - std::exp(-(turn - k_noise_rad) / as.crease_rad);
        if (const std::optional<double> at_rim = turn_at_rim(row, col, k)) {
          const double two = geometry::logistic(*at_rim / as.flank_soft_rad);
          like[here] = static_cast<float>(turn / most * plain *
                                          (as.one_surface_ratio + (1 - as.one_surface_ratio) * two));
          continue;
        }
        const std::optional<Flank> sole = flank(row, col, k, 1);
        const std::optional<Flank> upper = flank(row, col, k, -1);
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
    constexpr double k_least_rad = 0.15;
    const std::vector<float>& turns = turns_[k % k_axes];
    std::vector<Shift> below;
    for (double d = k_from_mm; d <= k_to_mm + 1e-9; d += k_fine_mm) below.push_back(right(k, d));
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        const std::size_t here = patch_.at(row, col);
        if (patch_.seen[here] == 0) continue;
        double out = k_least_rad;
        for (const Shift shift : below) {
          const std::ptrdiff_t there = cell(row, col, shift);
          if (there >= 0) out = std::max(out, -static_cast<double>(turns[static_cast<std::size_t>(there)]));
        }
        const double plain = 1 - std::exp(-(out - k_least_rad) / EvidenceConfig{}.crease_rad);
        like[here] = std::max(like[here], static_cast<float>(k_rim_ratio * plain));
      }
    }
  }

  /// The most line-like place on the upper's side of each one, of a crease that runs nearly alike.
  [[nodiscard]] std::vector<float> leave_above(
      const std::array<std::vector<float>, k_grid_steps.size()>& likeness, std::size_t k) const {
    const EvidenceConfig as{};
    constexpr double k_every_mm = 1.0;
    constexpr std::size_t k_alike = 2;
    std::vector<float> like = likeness[k];
    for (std::size_t j = 1; j <= k_alike; ++j) {
      for (const std::size_t other : {k + j, k + likeness.size() - j})
        for (std::size_t i = 0; i < like.size(); ++i)
          like[i] = std::max(like[i], likeness[other % likeness.size()][i]);
    }
    std::vector<Shift> shifts;
    for (double d = as.above_from_mm; d <= config_.above_to_mm; d += k_every_mm)
      shifts.push_back(right(k, -d));
    std::vector<float> above(patch_.size(), 0.0F);
    for (int col = 0; col < patch_.cols; ++col) {
      for (int row = 0; row < patch_.rows; ++row) {
        float& most = above[patch_.at(row, col)];
        for (const Shift shift : shifts) {
          const std::ptrdiff_t there = cell(row, col, shift);
          if (there >= 0) most = std::max(most, like[static_cast<std::size_t>(there)]);
        }
      }
    }
    return above;
  }

  void to_cost(std::size_t k, const std::vector<float>& above, std::vector<float>& like) const {
    constexpr float k_least_cost = 0.02F;
    constexpr float k_ridge_cost = 20;  // per radian that the surface turns outwards on the way
    const auto above_ratio = static_cast<float>(EvidenceConfig{}.above_ratio);
    // The surface's turn on the way along a step is that across the axis square to it.
    const std::vector<float>& ahead = turns_[(k + k_axes / 2) % k_axes];
    for (std::size_t i = 0; i < like.size(); ++i) {
      float cost = k_unseen_cost;
      if (patch_.seen[i] != 0) {
        const float out = std::clamp(-ahead[i] - static_cast<float>(k_noise_rad), 0.0F, 1.0F);
        cost = (1 - like[i]) * (1 - like[i]) * (1 + k_ridge_cost * out);
      }
      like[i] = std::max(k_least_cost, cost + above_ratio * above[i]);
    }
  }

  static constexpr double k_noise_rad = 0.05;
  const Patch& patch_;
  const StepCostConfig& config_;
  std::array<std::vector<float>, k_axes> turns_;
};

}  // namespace

StepCosts step_costs(const Patch& patch, const StepCostConfig& config) {
  return Reader{patch, config}.run();
}

}  // namespace biteline::bite_line
