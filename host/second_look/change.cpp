// SPDX-License-Identifier: MIT
#include "host/second_look/change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::second_look {
namespace {

/// The first scan is read by the nearest profiles along the line, standard deviation of their weights; how
/// much it scatters there is told by those across the next profile to either side.
constexpr double k_along_sigma_mm = 0.45, k_scatter_sigma_mm = 0.75;
/// A row with fewer unworked cells than this has no reference: 1 mm of them.
constexpr std::size_t k_least_reference = 10;
/// A profile half a millimetre away is near enough.
constexpr double k_least_weight = 0.5;
/// Profiles this near together, variance, show no slope along.
constexpr double k_least_spread_mm2 = 0.05;
/// What an arm does not repeat of its way, one coordinate (transfer/moved.cpp): on a slope that is height.
constexpr double k_repeat_mm = 0.014;
constexpr std::size_t k_patch_cells = 10;
/// A median's variance over a mean's: pi / 2.
constexpr double k_median_variance = 1.57;
/// The surface's slope across is taken over so many cells to either side.
constexpr std::size_t k_slope_cells = 3;

/// The first scan at a place between its profiles.
struct FirstHere {
  Values value{};
  double across_mm{0};       ///< mean place of what was averaged, from the cell's middle
  double variance_ratio{0};  ///< of one point's variance
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
    }
    if (near.weight() < k_least_weight) return std::nullopt;
    FirstHere here{.across_mm = across_mm / near.weight(), .variance_ratio = near.variance_ratio()};
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

/// Unworked cells of a row: below the plan and above it.
template <class Take>
void for_unworked(const Change& change, const Zones& zones, std::size_t row, Take&& take) {
  for (std::size_t j = 0; j < change.across.cells; ++j) {
    if (j >= zones.below_end_cell && j < zones.above_first_cell) continue;
    const std::size_t k = change.at(row, j);
    if (change.known(k)) take(k, j < zones.below_end_cell);
  }
}

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

/// Differences of the cells, and as `variance` the first scan's scatter there.  Gives the variances of the
/// differences, of one point's; 0 where nothing can be compared.
std::vector<double> compare(Change& change, const Raster& first, const Raster& second, double step_mm) {
  std::vector<double> variance_ratio(change.variance.size(), 0.0);
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
      // The two means do not lie at one place across; on a slope that is height.
      const std::size_t low = j >= k_slope_cells ? j - k_slope_cells : 0,
                        high = std::min(j + k_slope_cells, change.across.cells - 1);
      if (!row[low] || !row[high]) continue;  // beside what is hidden
      variance_ratio[k] = row[j]->variance_ratio + 1 / n;
      const double slope = (row[high]->value[k_height] - row[low]->value[k_height]) /
                           (static_cast<double>(high - low) * k_cell_mm);
      change.value[k][k_height] -= slope * (second.across_sum_mm[k] / n - row[j]->across_mm);
      change.variance[k][k_height] += slope * slope * k_repeat_mm * k_repeat_mm;
    }
  }
  return variance_ratio;
}

/// Cells' variances from `variance_ratio`, of one point's, and the first scan's scatter.  More than twice the
/// usual scatter is hardly by chance: it is the surface's own course between two profiles.  A straight line
/// between them is off by a third of what three of them scatter about one, and alike in every cell across.
void scale_variances(Change& change, const std::vector<double>& variance_ratio, std::size_t channels) {
  constexpr double k_common = 10;  // a third, squared, of some hundred cells
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<double> all;
    for (const Values& variance : change.variance)
      if (variance[k_height] > 0) all.push_back(variance[c]);
    if (all.empty()) continue;
    const double usual = geometry::median_of(std::span<double>{all});
    for (std::size_t k = 0; k < change.variance.size(); ++k) {
      double& variance = change.variance[k][c];
      if (variance_ratio[k] > 0)
        variance = variance_ratio[k] * usual + k_common * std::max(0.0, variance - 2 * usual);
    }
  }
  for (std::size_t k = 0; k < change.variance.size(); ++k)
    if (variance_ratio[k] <= 0) change.variance[k] = {};
}

/// Takes the unworked surface's own difference off, row by row; gives the differences taken.
std::vector<double> take_reference_off(Change& change, const Zones& zones) {
  std::vector<double> light;
  std::vector<double> values;
  for (std::size_t i = 0; i < change.rows(); ++i) {
    Values reference{};
    for (std::size_t c = 0; c < k_channels; ++c) {
      values.clear();
      for_unworked(change, zones, i, [&](std::size_t k, bool) { values.push_back(change.value[k][c]); });
      if (values.size() < k_least_reference) break;
      change.seen[i] = 1;
      reference[c] = geometry::median_of(std::span<double>{values});
    }
    if (change.seen[i] != 0) light.push_back(reference[k_log_amplitude]);
    for (std::size_t j = 0; j < change.across.cells; ++j) {
      const std::size_t k = change.at(i, j);
      if (change.seen[i] == 0) change.variance[k] = {};
      for (std::size_t c = 0; c < k_channels; ++c) change.value[k][c] -= reference[c];
    }
  }
  return light;
}

double robust_variance(std::vector<double>& values) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  const double sigma = geometry::k_sigma_per_mad * geometry::median_of(std::span<double>{values});
  return sigma * sigma;
}

/// Of one point, by the unworked cells.
double point_variance(const Change& change, const Zones& zones, std::size_t c) {
  std::vector<double> scaled;
  for (std::size_t i = 0; i < change.rows(); ++i)
    for_unworked(change, zones, i, [&](std::size_t k, bool) {
      scaled.push_back(change.value[k][c] / std::sqrt(change.variance[k][c]));
    });
  return robust_variance(scaled);
}

/// Two groups of a row's unworked cells against each other: below and above the band, or near and far on one
/// side of it.
struct Sides {
  double off{0};           ///< half of what they differ by
  double single_ratio{0};  ///< variance of that by the cells' single noise, of one point's
};
std::optional<Sides> sides_of(const Change& change, const Zones& zones, std::size_t row, std::size_t c) {
  std::array<std::vector<double>, 2> values{};
  std::array<double, 2> weight{};
  std::size_t all = 0, below = 0, number = 0;
  for_unworked(change, zones, row, [&](std::size_t, bool low) {
    ++all;
    below += low ? 1 : 0;
  });
  const bool both = below >= k_least_reference && all - below >= k_least_reference;
  for_unworked(change, zones, row, [&](std::size_t k, bool low) {
    const std::size_t group = (both ? low : number * 2 < all) ? 0 : 1;
    ++number;
    values[group].push_back(change.value[k][c]);
    weight[group] += 1 / change.variance[k][c];
  });
  if (std::min(values[0].size(), values[1].size()) < k_least_reference / 2) return std::nullopt;
  // Medians: a drop on one side is no difference of the two.
  return Sides{.off = (geometry::median_of(std::span<double>{values[1]}) -
                       geometry::median_of(std::span<double>{values[0]})) /
                      2,
               .single_ratio = k_median_variance * (1 / weight[0] + 1 / weight[1]) / 4};
}

/// What the unworked cells of a row have in common beyond their single noise.
class CommonVariance {
 public:
  CommonVariance(const Change& change, const Zones& zones, std::size_t c, double of_point)
      : of_point_{of_point} {
    std::vector<double> off;
    double single = 0;
    for (std::size_t i = 0; i < change.rows(); ++i) {
      sides_.push_back(sides_of(change, zones, i, c));
      if (!sides_.back()) continue;
      off.push_back(sides_.back()->off);
      single += of_point * sides_.back()->single_ratio;
    }
    if (off.empty()) return;
    usual_ = std::max(0.0, robust_variance(off) - single / static_cast<double>(off.size()));
  }
  /// A row whose sides differ by more than three standard deviations is judged by its own difference: a
  /// profile on a seam.
  [[nodiscard]] double of_row(std::size_t row) const {
    if (!sides_[row]) return usual_;
    const double own = sides_[row]->off * sides_[row]->off;
    return own > 9 * (usual_ + of_point_ * sides_[row]->single_ratio) ? own : usual_;
  }

 private:
  double of_point_, usual_{0};
  std::vector<std::optional<Sides>> sides_{};
};

/// Of patches of 1 mm of unworked cells against what their variances promise.
double patch_ratio_of(const Change& change, const Zones& zones, std::size_t c) {
  std::vector<double> off;
  for (std::size_t i = 0; i < change.rows(); ++i) {
    double sum = 0, weight = 0;
    std::size_t count = 0;
    for_unworked(change, zones, i, [&](std::size_t k, bool) {
      sum += change.value[k][c] / change.variance[k][c];
      weight += 1 / change.variance[k][c];
      if (++count < k_patch_cells) return;
      off.push_back(sum / std::sqrt(weight));
      sum = weight = 0;
      count = 0;
    });
  }
  return std::max(1.0, robust_variance(off));
}

}  // namespace

Change change_of(const Raster& first, const Raster& second, const Zones& zones, double step_mm, bool stripe) {
  Change change{.across = first.across, .along_mm = second.along_mm, .stripe = stripe};
  const std::size_t cells = change.rows() * change.across.cells;
  change.value.assign(cells, {});
  change.variance.assign(cells, {});
  change.seen.assign(change.rows(), 0);
  const std::vector<double> variance_ratio = compare(change, first, second, step_mm);
  const std::size_t channels = stripe ? std::size_t{k_channels} : 1;
  scale_variances(change, variance_ratio, channels);
  std::vector<double> light = take_reference_off(change, zones);
  if (!light.empty()) change.log_light = geometry::median_of(std::span<double>{light});
  for (std::size_t c = 0; c < channels; ++c) {
    const double of_point = point_variance(change, zones, c);
    const CommonVariance common{change, zones, c, of_point};
    std::vector<double> grown(change.rows());
    for (std::size_t i = 0; i < change.rows(); ++i) {
      // In sums over the band the common part counts once for each cell.
      double information = 0;
      for (std::size_t j = zones.low_cell; j < zones.end_cell; ++j) {
        const std::size_t k = change.at(i, j);
        if (change.known(k)) information += 1 / change.variance[k][c];
      }
      grown[i] = of_point + common.of_row(i) * information;
    }
    for (std::size_t i = 0; i < change.rows(); ++i)
      for (std::size_t j = 0; j < change.across.cells; ++j) change.variance[change.at(i, j)][c] *= grown[i];
    change.patch_ratio[c] = patch_ratio_of(change, zones, c);
  }
  return change;
}

}  // namespace biteline::second_look
