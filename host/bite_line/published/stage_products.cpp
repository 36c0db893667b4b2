// SPDX-License-Identifier: MIT
#include "host/bite_line/published/stage_products.hpp"

#include <algorithm>
#include <cmath>

#include "host/bite_line/published/thin.hpp"

namespace biteline::bite_line {

namespace {

EightSections sections_of(const Shoe& shoe) {
  return EightSections{{.length_mm = shoe.length_mm, .half_width_mm = 0.5 * shoe.width_mm}};
}

}  // namespace

Stages run_stages(const Side& side, const ExtractConfig& config, StageClock& clock) {
  const curvature::CurvatureConfig curvature_config{
      .solver = config.method == Method::Published ? curvature::Solver::WeightedPca
                                                   : curvature::Solver::LeastSquares,
      .radius_mm = static_cast<float>(config.curvature_radius_mm)};
  CurvedSurface surface = clock.run("curvature", [&] {
    return curve_surface(side.shoe, side.field, side.outline, config.surface_point_limit, curvature_config);
  });
  std::vector<std::uint32_t> features = clock.run("features", [&] { return feature_points(surface, {}); });
  std::vector<std::uint32_t> kept = clock.run("denoise", [&] { return denoised(surface, features, {}); });
  const EightSections sections = sections_of(side.shoe);
  Unrolled picture = clock.run("eight sections", [&] { return unroll_features(surface, kept, sections); });
  return {std::move(surface), std::move(features), std::move(kept), sections, std::move(picture)};
}

std::vector<std::uint32_t> plain_svd_features(const Side& side, const ExtractConfig& config) {
  return feature_points(curve_surface(side.shoe, side.field, side.outline, config.surface_point_limit,
                                      {.solver = curvature::Solver::PlainSvd,
                                       .radius_mm = static_cast<float>(config.curvature_radius_mm),
                                       .weight_ratio = 0}),
                        {});
}

std::vector<Vec3> thin_line(const Stages& stages, std::span<const float> path_row,
                            std::vector<std::uint32_t>& coarse) {
  constexpr double k_reach_mm = 1.5;
  coarse = published::back_project(stages.surface.points, stages.denoised_features, stages.picture,
                                   stages.sections, path_row, k_reach_mm);
  std::vector<Vec3> points;
  points.reserve(coarse.size());
  for (const std::uint32_t i : coarse) points.push_back(stages.surface.points[i].cast<double>());
  const double per_mm = static_cast<double>(points.size()) / stages.sections.perimeter_mm();
  return published::thin(std::move(points), {.lambda = std::max(10, static_cast<int>(4.0 * per_mm))});
}

std::vector<float> row_per_column(const cloud::ClosedLine& line, const SE3& T_base_shoe,
                                  const Unrolled& picture, const EightSections& sections) {
  std::vector<double> sum(static_cast<std::size_t>(picture.cols), 0.0);
  std::vector<int> count(sum.size(), 0);
  const SE3 T_shoe_base = T_base_shoe.inverse();
  for (const cloud::LinePoint& point : line.points) {
    const Vec3 p = T_shoe_base * point.position;
    const auto col = static_cast<std::size_t>(
        std::clamp(static_cast<int>(sections.along_mm(p.x(), p.y()) / picture.col_mm), 0, picture.cols - 1));
    sum[col] += (picture.top_mm - p.z()) / picture.row_mm - 0.5;
    ++count[col];
  }
  std::vector<float> row(sum.size(), -1.0F);
  float last = -1.0F;
  for (std::size_t pass = 0; pass < 2; ++pass) {
    for (std::size_t c = 0; c < sum.size(); ++c) {
      if (count[c] > 0) last = static_cast<float>(sum[c] / count[c]);
      if (row[c] < 0) row[c] = last;
      if (count[c] > 0) row[c] = last;
    }
  }
  return row;
}

void hand_on(Stages&& stages, Products& products, const cloud::PointCloud& cloud, const SE3& T_base_shoe,
             std::vector<float> path_row) {
  std::vector<Vec3> thinned = thin_line(stages, path_row, products.coarse_line);
  for (Vec3& p : thinned) p = T_base_shoe * p;
  products.thinned_line = std::move(thinned);
  const Eigen::Matrix3f R_base_shoe = T_base_shoe.linear().cast<float>();
  products.surface.points.reserve(stages.surface.index.size());
  products.surface.normals = std::move(stages.surface.curvature.normal);
  for (Eigen::Vector3f& normal : products.surface.normals) normal = R_base_shoe * normal;
  for (const std::uint32_t i : stages.surface.index) products.surface.points.push_back(cloud.points[i]);
  products.mean_curvature_per_mm = std::move(stages.surface.curvature.mean_per_mm);
  products.gaussian_curvature_per_mm2 = std::move(stages.surface.curvature.gaussian_per_mm2);
  products.feature_points = std::move(stages.features);
  products.denoised_points = std::move(stages.denoised_features);
  // The picture shows all of the mean curvature, not only the features.
  std::vector<Eigen::Vector3f>& points = stages.surface.points;
  products.unrolled = unroll(points, products.mean_curvature_per_mm, stages.sections, {});
  products.path_row = std::move(path_row);
}

}  // namespace biteline::bite_line
