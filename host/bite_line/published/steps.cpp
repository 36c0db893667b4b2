// SPDX-License-Identifier: MIT
#include "host/bite_line/published/steps.hpp"

#include <algorithm>

#include "host/bite_line/published/thin.hpp"

namespace biteline::published {

Features find_features(const bite_line::Side& side, const Config& config) {
  CurvedSurface surface = curve_surface(
      side, config.surface_point_limit,
      {.solver = Solver::WeightedPca, .radius_mm = static_cast<float>(config.curvature_radius_mm)});
  std::vector<std::uint32_t> strong = feature_points(surface, {});
  std::vector<std::uint32_t> kept = denoised(surface, strong, {});
  const EightSections sections{{.length_mm = side.shoe.length_mm, .half_width_mm = 0.5 * side.shoe.width_mm}};
  Unrolled picture = unroll_features(surface, kept, sections);
  return {std::move(surface), std::move(strong), std::move(kept), sections, std::move(picture)};
}

std::vector<std::uint32_t> plain_svd_features(const bite_line::Side& side, const Config& config) {
  return feature_points(curve_surface(side, config.surface_point_limit,
                                      {.solver = Solver::PlainSvd,
                                       .radius_mm = static_cast<float>(config.curvature_radius_mm),
                                       .weight_ratio = 0}),
                        {});
}

std::vector<std::uint32_t> coarse_line(const Features& features, std::span<const float> path_row) {
  constexpr double k_reach_mm = 1.5;
  return back_project(features.surface.points, features.denoised, features.picture, features.sections,
                      path_row, k_reach_mm);
}

std::vector<Vec3> thin_line(const Features& features, std::span<const std::uint32_t> coarse) {
  std::vector<Vec3> points;
  points.reserve(coarse.size());
  for (const std::uint32_t i : coarse) points.push_back(features.surface.points[i].cast<double>());
  const double per_mm = static_cast<double>(points.size()) / features.sections.perimeter_mm();
  return thin(std::move(points), {.lambda = std::max(10, static_cast<int>(4.0 * per_mm))});
}

}  // namespace biteline::published
