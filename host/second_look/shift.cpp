// SPDX-License-Identifier: MIT
#include "host/second_look/shift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "host/geometry/robust.hpp"

namespace biteline::second_look {
namespace {

/// What an arm does not repeat is slow: rows are taken together over this, standard deviation.
constexpr double k_together_mm = 4;
constexpr int k_rounds = 5;
/// Steeper than this, in a groove's walls, a cell's mean depends on where in the cell its points lie.
constexpr double k_steepest = 1;
/// A cell that lies off by so many standard deviations has a quarter of its weight (Geman and McClure 1987).
constexpr double k_far_sigmas = 3;

/// A cell's difference is the row's own height and its shift on the slope: h = a + b s.  Residuals are taken
/// square to the surface, as in an iterative closest point with planes (Chen and Medioni 1992).
struct Cell {
  double height_mm, slope, square;  ///< 1 / (1 + s^2)
};
struct Sums {
  double w{0}, s{0}, h{0}, ss{0}, sh{0};
  void add(const Cell& cell, double weight) {
    w += weight;
    s += weight * cell.slope;
    h += weight * cell.height_mm;
    ss += weight * cell.slope * cell.slope;
    sh += weight * cell.slope * cell.height_mm;
  }
};

class Rows {
 public:
  Rows(const Change& change, const Compared& compared, const Zones& zones, double line_mm)
      : along_mm_{change.along_mm},
        line_mm_{line_mm},
        cells_(change.rows()),
        height_mm_(change.rows(), 0.0),
        shift_mm_(change.rows(), 0.0) {
    for (std::size_t i = 0; i < change.rows(); ++i)
      for_unworked(change, zones, i, k_height, [&](std::size_t k, bool) {
        const double slope = compared.slope[k];
        if (compared.variance_ratio[k] <= 0 || std::abs(slope) > k_steepest) return;
        cells_[i].push_back(
            {.height_mm = change.value[k][k_height], .slope = slope, .square = 1 / (1 + slope * slope)});
      });
    for (std::size_t i = 0; i < cells_.size(); ++i) height_mm_[i] = middle_of(i);
    // All cells have a say first: where the few steep ones were far ones from the beginning, they stayed so.
    fit(std::numeric_limits<double>::infinity());
    for (int round = 1; round < k_rounds; ++round) fit(std::max(k_far_sigmas * scale_mm(), 1e-6));
  }
  [[nodiscard]] double shift_mm(std::size_t row) const { return shift_mm_[row]; }

 private:
  [[nodiscard]] double middle_of(std::size_t row) const {
    std::vector<double> heights;
    for (const Cell& cell : cells_[row]) heights.push_back(cell.height_mm);
    return heights.empty() ? 0 : geometry::median_of(std::span<double>{heights});
  }
  [[nodiscard]] double off_mm(std::size_t row, const Cell& cell) const {
    return (cell.height_mm - height_mm_[row] - shift_mm_[row] * cell.slope) * std::sqrt(cell.square);
  }
  [[nodiscard]] double scale_mm() const {
    std::vector<double> off;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (const Cell& cell : cells_[i]) off.push_back(std::abs(off_mm(i, cell)));
    return off.empty() ? 0 : geometry::k_sigma_per_mad * geometry::median_of(std::span<double>{off});
  }

  void fit(double far_mm) {
    std::vector<Sums> sums(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (const Cell& cell : cells_[i]) {
        const double ratio = off_mm(i, cell) / far_mm;
        sums[i].add(cell, cell.square / std::pow(1 + ratio * ratio, 2));
      }
    // Of each row its own height is taken off; the shift is that of the rows together.
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      double ss = 0, sh = 0;
      for_near(i, [&](std::size_t n, double weight) {
        if (sums[n].w <= 0) return;
        ss += weight * (sums[n].ss - sums[n].s * sums[n].s / sums[n].w);
        sh += weight * (sums[n].sh - sums[n].s * sums[n].h / sums[n].w);
      });
      shift_mm_[i] = ss > 0 ? sh / ss : 0;
      if (sums[i].w > 0) height_mm_[i] = (sums[i].h - shift_mm_[i] * sums[i].s) / sums[i].w;
    }
  }

  template <class Take>
  void for_near(std::size_t row, Take&& take) const {
    const std::size_t count = cells_.size();
    for (const std::size_t step : {std::size_t{1}, count - 1}) {
      std::size_t n = step == 1 ? row : (row + step) % count;
      for (std::size_t seen = step == 1 ? 0 : 1; seen < count; ++seen, n = (n + step) % count) {
        const double ratio = std::remainder(along_mm_[n] - along_mm_[row], line_mm_) / k_together_mm;
        if (std::abs(ratio) > 3) break;
        take(n, std::exp(-0.5 * ratio * ratio));
      }
    }
  }

  const std::vector<double>& along_mm_;
  double line_mm_;
  std::vector<std::vector<Cell>> cells_;
  std::vector<double> height_mm_, shift_mm_;
};

}  // namespace

void take_shift_off(Change& change, const Compared& compared, const Zones& zones, double line_mm) {
  const Rows rows{change, compared, zones, line_mm};
  for (std::size_t i = 0; i < change.rows(); ++i)
    for (std::size_t j = 0; j < change.across.cells; ++j) {
      const std::size_t k = change.at(i, j);
      change.value[k][k_height] -= rows.shift_mm(i) * compared.slope[k];
    }
}

}  // namespace biteline::second_look
