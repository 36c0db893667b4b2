// SPDX-License-Identifier: MIT
#include "host/second_look/change.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"
#include "host/second_look/compare.hpp"
#include "host/second_look/shift.hpp"

namespace biteline::second_look {
namespace {

/// A row with fewer unworked cells than this has no reference: 1 mm of them.
constexpr std::size_t k_least_reference = 10;
/// Across a steep place the scans lie on each other no nearer than this: an arm's repeatability, one
/// coordinate (transfer/moved.cpp).
constexpr double k_repeat_mm = 0.014;
constexpr std::size_t k_patch_cells = 10, k_part_cells = 20, k_least_parts = 3;
/// 99 of 100 normally distributed patches are within so many standard deviations.
constexpr double k_far_share = 0.99, k_far_share_sigmas = 2.576;

/// Cells' variances from `variance_ratio`, of one point's, and the first scan's scatter.  More than twice the
/// usual scatter is hardly by chance: it is the surface's own course between two profiles, a seam's or a
/// stitch's.  Gives its standard deviations: by these the first scan may be off there, alike in all cells.
std::vector<Values> scale_variances(Change& change, const Compared& compared, std::size_t channels) {
  std::vector<Values> course(change.variance.size(), Values{});
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<double> all;
    for (std::size_t k = 0; k < change.variance.size(); ++k)
      if (change.known(k, c)) all.push_back(change.variance[k][c]);
    if (all.empty()) continue;
    const double usual = geometry::median_of(std::span<double>{all});
    for (std::size_t k = 0; k < change.variance.size(); ++k) {
      if (!change.known(k, c) || compared.variance_ratio[k] <= 0) continue;
      const double beyond = std::max(0.0, change.variance[k][c] - 2 * usual);
      course[k][c] = std::sqrt(beyond);
      change.variance[k][c] = compared.variance_ratio[k] * usual + beyond;
    }
  }
  for (std::size_t k = 0; k < change.variance.size(); ++k) {
    if (compared.variance_ratio[k] <= 0) change.variance[k] = {};
    if (change.known(k)) change.variance[k][k_height] += std::pow(compared.slope[k] * k_repeat_mm, 2);
  }
  return course;
}

/// Takes the unworked surface's own difference off, row by row; gives the differences taken.
std::vector<double> take_reference_off(Change& change, const Zones& zones) {
  std::vector<double> light;
  std::vector<double> values;
  for (std::size_t i = 0; i < change.rows(); ++i) {
    for (std::size_t c = 0; c < k_channels; ++c) {
      values.clear();
      for_unworked(change, zones, i, c, [&](std::size_t k, bool) { values.push_back(change.value[k][c]); });
      const bool told = values.size() >= k_least_reference;
      const double reference = told ? geometry::median_of(std::span<double>{values}) : 0;
      if (c == k_height) change.seen[i] = told ? 1 : 0;
      if (c == k_log_amplitude && told) light.push_back(reference);
      for (std::size_t j = 0; j < change.across.cells; ++j) {
        const std::size_t k = change.at(i, j);
        change.value[k][c] -= reference;
        if (!told && change.known(k)) change.variance[k][c] = c == k_height ? 0 : k_says_nothing;
      }
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
    for_unworked(change, zones, i, c, [&](std::size_t k, bool) {
      scaled.push_back(change.value[k][c] / std::sqrt(change.variance[k][c]));
    });
  return robust_variance(scaled);
}

/// Unworked cells of a row, so many and so many together.
struct Patch {
  double mean{0}, weight{0};  ///< sum of 1 / variance
};
std::vector<Patch> patches_of(const Change& change, const Zones& zones, std::size_t row, std::size_t c,
                              std::size_t cells) {
  std::vector<Patch> patches;
  Patch open;
  std::size_t count = 0;
  for_unworked(change, zones, row, c, [&](std::size_t k, bool) {
    open.mean += change.value[k][c] / change.variance[k][c];
    open.weight += 1 / change.variance[k][c];
    if (++count < cells) return;
    patches.push_back({.mean = open.mean / open.weight, .weight = open.weight});
    open = {};
    count = 0;
  });
  return patches;
}

/// What a row's band may be off by, all of it, against its unworked cells: by what parts of those, 2 mm wide,
/// differ from each other beyond their single noise.  A drop on one of them is no such difference.
class CommonVariance {
 public:
  CommonVariance(const Change& change, const Zones& zones, std::size_t c, double of_point)
      : row_(change.rows(), 0.0) {
    std::vector<std::vector<double>> off(change.rows());
    std::vector<double> single(change.rows(), 0.0), parts(change.rows(), 0.0);
    for (std::size_t i = 0; i < change.rows(); ++i) {
      const std::vector<Patch> patches = patches_of(change, zones, i, c, k_part_cells);
      std::vector<double> means;
      for (const Patch& patch : patches) means.push_back(patch.mean);
      if (means.size() < k_least_parts) continue;
      const double middle = geometry::median_of(std::vector<double>{means});
      for (const Patch& patch : patches) {
        off[i].push_back(patch.mean - middle);
        single[i] += of_point / patch.weight;
      }
      parts[i] = static_cast<double>(patches.size());
    }
    // A seam lies on neighbours, too: each row is judged with the one before and the one behind.
    const auto band_parts = static_cast<double>(zones.end_cell - zones.low_cell) / k_part_cells;
    std::vector<double> all;
    for (std::size_t i = 0; i < row_.size(); ++i) {
      std::vector<double> near;
      double near_single = 0;
      for (const std::ptrdiff_t k : {-1, 0, 1}) {
        const std::size_t n = geometry::round_index(i, k, row_.size());
        near.insert(near.end(), off[n].begin(), off[n].end());
        near_single += single[n];
      }
      if (near.empty() || parts[i] == 0) continue;
      const double of_part = robust_variance(near) - near_single / static_cast<double>(near.size());
      row_[i] = of_part * (1 / band_parts + 1 / parts[i]);
      all.push_back(row_[i]);
    }
    const double usual = all.empty() ? 0 : std::max(0.0, geometry::median_of(std::span<double>{all}));
    for (double& row : row_) row = std::max(row, usual);
  }
  [[nodiscard]] double of_row(std::size_t row) const { return row_[row]; }

 private:
  std::vector<double> row_;
};

/// Of patches of 1 mm of unworked cells against what their variances promise: of the few that lie farthest
/// off, as a surface with ridges or stitches between the profiles has them.  Where somebody worked beside the
/// plan, that is less.
double patch_ratio_of(const Change& change, const Zones& zones, std::size_t c) {
  std::vector<double> off;
  for (std::size_t i = 0; i < change.rows(); ++i)
    for (const Patch& patch : patches_of(change, zones, i, c, k_patch_cells))
      off.push_back(std::abs(patch.mean) * std::sqrt(patch.weight));
  if (off.empty()) return 1;
  return std::max(1.0, std::pow(geometry::quantile_of(std::span{off}, k_far_share) / k_far_share_sigmas, 2));
}

}  // namespace

Change change_of(const Raster& first, const Raster& second, const Zones& zones, double step_mm, bool stripe) {
  Change change{.across = first.across, .along_mm = second.along_mm, .stripe = stripe};
  const std::size_t cells = change.rows() * change.across.cells;
  change.value.assign(cells, {});
  change.variance.assign(cells, {});
  change.seen.assign(change.rows(), 0);
  const Compared compared = compare(change, first, second, step_mm);
  take_shift_off(change, compared, zones, step_mm * static_cast<double>(first.rows()));
  const std::size_t channels = stripe ? std::size_t{k_channels} : 1;
  const std::vector<Values> course = scale_variances(change, compared, channels);
  std::vector<double> light = take_reference_off(change, zones);
  if (!light.empty()) change.log_light = geometry::median_of(std::span<double>{light});
  for (std::size_t c = 0; c < channels; ++c) {
    const double of_point = point_variance(change, zones, c);
    if (of_point <= 0) {  // nothing unworked tells
      for (Values& variance : change.variance)
        if (variance[k_height] > 0) variance[c] = k_says_nothing;
      continue;
    }
    const CommonVariance common{change, zones, c, of_point};
    std::vector<double> grown(change.rows());
    for (std::size_t i = 0; i < change.rows(); ++i) {
      // In sums over the band what cells have in common counts once for each of them.
      double information = 0, course_of_all = 0;
      for (std::size_t j = zones.low_cell; j < zones.end_cell; ++j) {
        const std::size_t k = change.at(i, j);
        if (!change.known(k)) continue;
        information += 1 / change.variance[k][c];
        course_of_all += course[k][c] / change.variance[k][c];
      }
      grown[i] = of_point + common.of_row(i) * information;
      if (information > 0) grown[i] += course_of_all * course_of_all / information;
    }
    for (std::size_t i = 0; i < change.rows(); ++i)
      for (std::size_t j = 0; j < change.across.cells; ++j) change.variance[change.at(i, j)][c] *= grown[i];
    change.patch_ratio[c] = patch_ratio_of(change, zones, c);
  }
  return change;
}

}  // namespace biteline::second_look
