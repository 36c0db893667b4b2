// SPDX-License-Identifier: MIT
#include "host/second_look/compare.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/geometry/closed_curve.hpp"

namespace biteline::second_look {
namespace {

/// The first scan is read by the nearest profiles along the line, standard deviation of their weights; how
/// much it scatters there is told by those across the next profile to either side.
constexpr double k_along_sigma_mm = 0.45, k_scatter_sigma_mm = 0.75;
/// A profile half a millimetre away is near enough.
constexpr double k_least_weight = 0.5;
/// Profiles this near together, variance, show no slope along.
constexpr double k_least_spread_mm2 = 0.05;
/// The surface's slope across is taken over so many cells to either side.
constexpr std::size_t k_slope_cells = 3;

/// The first scan at a place between its profiles.
struct FirstHere {
  Values value{};
  double across_mm{0};       ///< mean place of what was averaged, from the cell's middle
  double variance_ratio{0};  ///< of one point's variance
  bool clipped{false};       ///< how bright it is nobody knows
  Values scatter{};          ///< of the points about what they are averaged to, variance
};

/// Weighted sums of the points near a place along: a straight line through the heights, means of the others.
class AlongSums {
 public:
  struct Points {
    double count, at_mm;
    const std::array<float, k_channels>&sum, &square_sum;
  };
  void add(const Points& points, double weight) {
    const double w = weight * points.count;
    w_ += w;
    ww_ += weight * w;
    x_ += w * points.at_mm;
    xx_ += w * points.at_mm * points.at_mm;
    xh_ += weight * points.at_mm * points.sum[k_height];
    for (std::size_t c = 0; c < k_channels; ++c) {
      value_[c] += weight * points.sum[c];
      square_[c] += weight * points.square_sum[c];
    }
  }
  [[nodiscard]] double weight() const { return w_; }
  [[nodiscard]] double variance_ratio() const { return ww_ / (w_ * w_); }
  [[nodiscard]] double mean(std::size_t c) const { return value_[c] / w_; }
  /// At the place itself.
  [[nodiscard]] double height() const { return mean(k_height) - slope() * x_ / w_; }
  [[nodiscard]] double scatter(std::size_t c) const {
    const double slope_mm = c == k_height ? slope() : 0;
    return std::max(0.0, square_[c] / w_ - mean(c) * mean(c) - slope_mm * slope_mm * spread_mm2());
  }

 private:
  [[nodiscard]] double spread_mm2() const { return xx_ / w_ - x_ / w_ * (x_ / w_); }
  [[nodiscard]] double slope() const {
    return spread_mm2() > k_least_spread_mm2 ? (xh_ / w_ - x_ / w_ * mean(k_height)) / spread_mm2() : 0;
  }
  double w_{0}, ww_{0}, x_{0}, xx_{0}, xh_{0};
  Values value_{}, square_{};
};

class FirstScan {
 public:
  FirstScan(const Raster& raster, double step_mm)
      : raster_{raster},
        step_mm_{step_mm},
        reach_{static_cast<std::ptrdiff_t>(std::ceil(2 * k_scatter_sigma_mm / step_mm))} {}

  [[nodiscard]] std::optional<FirstHere> at(double on_line_mm, std::size_t cell) const {
    const double nearest = std::round(on_line_mm / step_mm_);
    const double along_mm = on_line_mm - nearest * step_mm_;
    const std::size_t station =
        geometry::round_index(0, static_cast<std::ptrdiff_t>(nearest), raster_.rows());
    AlongSums near, wide;
    double across_mm = 0;
    bool clipped = false;
    for (std::ptrdiff_t k = -reach_; k <= reach_; ++k) {
      const std::size_t i = raster_.at(geometry::round_index(station, k, raster_.rows()), cell);
      const double n = raster_.count[i];
      if (n <= 0) continue;
      const double at_mm = static_cast<double>(k) * step_mm_ + raster_.along_sum_mm[i] / n - along_mm;
      const AlongSums::Points points{
          .count = n, .at_mm = at_mm, .sum = raster_.sum[i], .square_sum = raster_.square_sum[i]};
      const double weight = std::exp(-0.5 * std::pow(at_mm / k_along_sigma_mm, 2));
      near.add(points, weight);
      wide.add(points, std::exp(-0.5 * std::pow(at_mm / k_scatter_sigma_mm, 2)));
      across_mm += weight * raster_.across_sum_mm[i];
      clipped = clipped || raster_.clipped[i] > 0;
    }
    if (near.weight() < k_least_weight) return std::nullopt;
    FirstHere here{
        .across_mm = across_mm / near.weight(), .variance_ratio = near.variance_ratio(), .clipped = clipped};
    for (std::size_t c = 0; c < k_channels; ++c) {
      here.value[c] = c == k_height ? near.height() : near.mean(c);
      here.scatter[c] = wide.scatter(c);
    }
    return here;
  }

 private:
  const Raster& raster_;
  double step_mm_;
  std::ptrdiff_t reach_;
};

/// Mean of a cell's and its neighbours': few points tell little each.
double scatter_at(const std::vector<std::optional<FirstHere>>& row, std::size_t j, std::size_t c) {
  double sum = 0, count = 0;
  for (std::size_t k = j >= 2 ? j - 2 : 0; k < std::min(j + 3, row.size()); ++k) {
    if (!row[k]) continue;
    sum += row[k]->scatter[c];
    count += 1;
  }
  return sum / count;
}

}  // namespace

Compared compare(Change& change, const Raster& first, const Raster& second, double step_mm) {
  Compared compared{.variance_ratio = std::vector<double>(change.variance.size(), 0.0),
                    .slope = std::vector<double>(change.variance.size(), 0.0)};
  const FirstScan scan{first, step_mm};
  std::vector<std::optional<FirstHere>> row(change.across.cells);
  for (std::size_t i = 0; i < change.rows(); ++i) {
    for (std::size_t j = 0; j < change.across.cells; ++j) {
      const std::size_t k = change.at(i, j);
      const double n = second.count[k];
      row[j] = n > 0 ? scan.at(change.along_mm[i] + second.along_sum_mm[k] / n, j) : std::nullopt;
    }
    for (std::size_t j = 0; j < change.across.cells; ++j) {
      if (!row[j]) continue;
      const std::size_t k = change.at(i, j);
      const double n = second.count[k];
      for (std::size_t c = 0; c < k_channels; ++c) {
        change.value[k][c] = second.sum[k][c] / n - row[j]->value[c];
        change.variance[k][c] = scatter_at(row, j, c);
      }
      if (row[j]->clipped || second.clipped[k] > 0) change.variance[k][k_log_amplitude] = k_says_nothing;
      // The two means do not lie at one place across; on a slope that is height.
      const std::size_t low = j >= k_slope_cells ? j - k_slope_cells : 0,
                        high = std::min(j + k_slope_cells, change.across.cells - 1);
      if (!row[low] || !row[high]) continue;  // beside what is hidden
      compared.variance_ratio[k] = row[j]->variance_ratio + 1 / n;
      const double slope = (row[high]->value[k_height] - row[low]->value[k_height]) /
                           (static_cast<double>(high - low) * k_cell_mm);
      change.value[k][k_height] -= slope * (second.across_sum_mm[k] / n - row[j]->across_mm);
      compared.slope[k] = slope;
    }
  }
  return compared;
}

}  // namespace biteline::second_look
