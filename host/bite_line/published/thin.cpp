// SPDX-License-Identifier: MIT
#include "host/bite_line/published/thin.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "host/geometry/closed_curve.hpp"

namespace biteline::published {

std::vector<std::uint32_t> back_project(std::span<const Eigen::Vector3f> points,
                                        std::span<const std::uint32_t> candidates, const Unrolled& picture,
                                        const EightSections& sections, std::span<const float> path_row,
                                        double reach_mm) {
  std::vector<std::pair<double, std::uint32_t>> found;
  for (const std::uint32_t i : candidates) {
    const PixelPlace place = pixel_of(picture, sections, points[i]);
    if (place.row < 0) continue;
    const auto row = static_cast<double>(path_row[static_cast<std::size_t>(place.col)]);
    if (row < 0) continue;
    const double z = picture.top_mm - (row + 0.5) * picture.row_mm;
    if (std::abs(static_cast<double>(points[i].z()) - z) > reach_mm) continue;
    found.emplace_back(
        sections.along_mm(static_cast<double>(points[i].x()), static_cast<double>(points[i].y())), i);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> ordered;
  ordered.reserve(found.size());
  for (const auto& [along, index] : found) ordered.push_back(index);
  return ordered;
}

std::vector<Vec3> thin(std::vector<Vec3> points, const ThinConfig& config) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  if (count < 2 * config.lambda + 1) return points;
  for (int round = 0; round < config.rounds; ++round) {
    std::vector<Vec3> moved(points.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      Vec3 mean = Vec3::Zero();
      for (std::ptrdiff_t j = -config.lambda; j <= config.lambda; ++j)
        mean += points[static_cast<std::size_t>(((i + j) % count + count) % count)];
      mean /= 2 * config.lambda + 1;
      Mat3 scatter = Mat3::Zero();
      for (std::ptrdiff_t j = -config.lambda; j <= config.lambda; ++j) {
        const Vec3 d = points[static_cast<std::size_t>(((i + j) % count + count) % count)] - mean;
        scatter += d * d.transpose();
      }
      Eigen::SelfAdjointEigenSolver<Mat3> solver;
      solver.computeDirect(scatter);
      const Vec3 along = solver.eigenvectors().col(2);
      const Vec3& p = points[static_cast<std::size_t>(i)];
      moved[static_cast<std::size_t>(i)] = mean + (p - mean).dot(along) * along;
    }
    points = std::move(moved);
  }
  return points;
}

std::vector<Vec3> even_sequence(const std::vector<Vec3>& points, double spacing_mm) {
  if (points.size() < 8) return points;
  // The thinned points still lie in scan order across a stretch: means over about 2 mm of order give a clean
  // polyline.
  Vec3 low = points.front();
  Vec3 high = low;
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double rough_length = 2.4 * (high - low).head<2>().norm();
  const auto bins =
      static_cast<std::size_t>(std::clamp(rough_length / 2.0, 8.0, static_cast<double>(points.size())));
  std::vector<Vec3> polyline(bins, Vec3::Zero());
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * points.size() / bins;
    const std::size_t to = (b + 1) * points.size() / bins;
    for (std::size_t i = from; i < to; ++i) polyline[b] += points[i] / static_cast<double>(to - from);
  }
  const geometry::ArcLength along{bins, [&](std::size_t i) { return polyline[i]; }};
  std::vector<Vec3> even(along.count_for(spacing_mm));
  for (std::size_t k = 0; k < even.size(); ++k) {
    const geometry::OnCurve at = along.even(k, even.size());
    even[k] = at.between<Vec3>(polyline[at.before], polyline[at.after]);
  }
  return even;
}

}  // namespace biteline::published
