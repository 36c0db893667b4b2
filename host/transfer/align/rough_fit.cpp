// SPDX-License-Identifier: MIT
#include "host/transfer/align/rough_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/transfer/align/fit.hpp"
#include "host/transfer/align/starts.hpp"

namespace biteline::transfer {
namespace {

constexpr std::size_t k_search_places = 80, k_coarse_places = 200, k_few_places = 200;
constexpr std::size_t k_kept_starts = 3, k_kept_fits = 2;
constexpr int k_coarse_steps = 8, k_fine_steps = 12;

/// Every so many-th: surfels come in the order of the scan.
Surfels drawn(const Surfels& all, std::size_t most) {
  Surfels out{.pitch_mm = all.pitch_mm};
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * all.size() / count;
    out.positions.push_back(all.positions[at]);
    out.normals.push_back(all.normals[at]);
    if (!all.feet.empty()) out.feet.push_back(all.feet[at]);
  }
  return out;
}

double better_half_mm(const Surfels& source, const std::vector<Pair>& pairs) {
  const std::size_t half = source.size() / 2;
  if (half == 0 || pairs.size() < half) return std::numeric_limits<double>::infinity();
  std::vector<double> squares;
  squares.reserve(pairs.size());
  for (const Pair& pair : pairs) squares.push_back(pair.residual_mm * pair.residual_mm);
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(half - 1), squares.end());
  double sum = 0;
  for (std::size_t i = 0; i < half; ++i) sum += squares[i];
  return std::sqrt(sum / static_cast<double>(half));
}

}  // namespace

RoughShape rough_shape_of(const Sample& sample) {
  return {.coarse = drawn(sample.common_coarse, k_coarse_places),
          .few = drawn(sample.common, k_few_places),
          .length_mm = shoe_axes(sample.common).length_mm};
}

RoughShape mirrored(const RoughShape& shape) {
  RoughShape other = shape;
  for (Surfels* surfels : {&other.coarse, &other.few}) {
    for (Eigen::Vector3f& p : surfels->positions) p.y() = -p.y();
    for (Eigen::Vector3f& n : surfels->normals) n.y() = -n.y();
    for (Foot& foot : surfels->feet) foot = mirrored(foot);
  }
  return other;
}

RoughTarget::RoughTarget(const Upper& upper_ready)
    : upper{upper_ready},
      coarse{upper.surfels_coarse, static_cast<float>(k_coarse_reach_mm)},
      fine{upper.surfels, static_cast<float>(k_fine_reach_mm)} {}

RoughFit rough_fit(const RoughShape& shape, const RoughTarget& target, const GradingLaw* law) {
  const Upper& upper = target.upper;
  RoughFit best{.off_mm = std::numeric_limits<double>::infinity()};
  if (shape.coarse.size() == 0) return best;
  const Surfels search = drawn(shape.coarse, k_search_places);
  const Surfaces sparse{.source = search, .target = upper.surfels_coarse, .target_table = target.coarse};
  const Surfaces coarse{
      .source = shape.coarse, .target = upper.surfels_coarse, .target_table = target.coarse};
  const Surfaces fine{.source = shape.few, .target = upper.surfels, .target_table = target.fine};
  const auto free = [&](IcpOptions options) {
    if (law == nullptr) return options;
    options.freedom = Freedom::Graded;
    options.law = *law;
    return options;
  };

  Vec3 centre = Vec3::Zero();
  for (const Eigen::Vector3f& p : shape.coarse.positions) centre += p.cast<double>();
  centre /= static_cast<double>(shape.coarse.size());

  const Grade grade = law != nullptr ? start_grade(*law, shape.length_mm, upper) : Grade{};
  std::vector<IcpResult> fits;
  for (const Placement& start : starts(graded(shape.coarse, grade), upper, grade)) {
    fits.push_back(run_icp(
        sparse, start,
        {.reach_mm = k_coarse_reach_mm, .min_normal_cosine = 0.5, .least_scale_mm = 2, .max_iterations = 6}));
  }
  fits = different_ones(std::move(fits), centre);
  fits.resize(std::min(fits.size(), k_kept_starts));
  for (IcpResult& fit : fits) {
    fit = run_icp(
        coarse, fit.placement,
        free({.reach_mm = k_middle_reach_mm, .least_scale_mm = 0.5, .max_iterations = k_coarse_steps}));
  }
  fits = different_ones(std::move(fits), centre);
  fits.resize(std::min(fits.size(), k_kept_fits));
  for (const IcpResult& fit : fits) {
    const IcpOptions options = free({.reach_mm = k_fine_reach_mm, .max_iterations = k_fine_steps});
    const IcpResult placed = run_icp(fine, fit.placement, options);
    const double off_mm = better_half_mm(shape.few, find_pairs(fine, placed.placement, options));
    if (off_mm < best.off_mm) best = {.off_mm = off_mm, .length = placed.placement.grade.length};
  }
  return best;
}

}  // namespace biteline::transfer
