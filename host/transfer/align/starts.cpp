// SPDX-License-Identifier: MIT
#include "host/transfer/align/starts.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <numbers>

namespace biteline::transfer {
namespace {

constexpr double k_rad_per_deg = std::numbers::pi / 180;
constexpr double k_same_mm = 5;
constexpr double k_same_rad = 5 * k_rad_per_deg;

struct Frame {
  Vec3 mean{Vec3::Zero()};
  Mat3 axes{Mat3::Identity()};  ///< x along the shoe, z upwards
};

Vec3 mean_of(const Surfels& surfels) {
  Vec3 mean = Vec3::Zero();
  for (const Eigen::Vector3f& p : surfels.positions) mean += p.cast<double>();
  return mean / static_cast<double>(surfels.size());
}

/// Principal axes: x the longest; z the shortest, turned upwards; they tilt with the shoe.
Frame principal_frame(const Surfels& surfels) {
  Frame frame{.mean = mean_of(surfels)};
  Mat3 covariance = Mat3::Zero();
  for (const Eigen::Vector3f& p : surfels.positions) {
    const Vec3 d = p.cast<double>() - frame.mean;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> solver{covariance / static_cast<double>(surfels.size())};
  Vec3 x = solver.eigenvectors().col(2), z = solver.eigenvectors().col(0);
  // A short high shoe may have its height as the middle axis.
  if (std::abs(z.z()) < std::abs(solver.eigenvectors().col(1).z())) z = solver.eigenvectors().col(1);
  if (z.z() < 0) z = -z;
  frame.axes.col(0) = x;
  frame.axes.col(1) = z.cross(x);
  frame.axes.col(2) = z;
  return frame;
}

/// Upright: z is base's, x as found from the plan.
Frame upright_frame(const Surfels& surfels, const SE3& T_base_shoe) {
  return {.mean = mean_of(surfels), .axes = T_base_shoe.linear()};
}

double top_along(const Surfels& surfels, const Vec3& mean, const Vec3& up) {
  double top_mm = 0;
  for (const Eigen::Vector3f& p : surfels.positions)
    top_mm = std::max(top_mm, (p.cast<double>() - mean).dot(up));
  return top_mm;
}

bool alike(const Placement& a, const Placement& b, const Vec3& centre) {
  const Foot foot{.place = centre.head<2>().cast<float>()};
  return (a.place(centre, foot) - b.place(centre, foot)).norm() < k_same_mm &&
         geometry::angle_between_rad(a.T_target_source.linear(), b.T_target_source.linear()) < k_same_rad;
}

}  // namespace

std::vector<Placement> starts(const Surfels& source, const Upper& upper, const Grade& grade) {
  const std::array<std::array<Frame, 2>, 2> pairs{{
      {upright_frame(source, SE3::Identity()), upright_frame(upper.surfels_coarse, upper.axes.T_base_shoe)},
      {principal_frame(source), principal_frame(upper.surfels_coarse)},
  }};
  std::vector<Placement> placements;
  for (const auto& [from, to] : pairs) {
    const double rise_mm = top_along(upper.surfels_coarse, to.mean, to.axes.col(2)) -
                           top_along(source, from.mean, from.axes.col(2));
    for (const double yaw_deg : {0.0, 180.0, 12.0, -12.0, 168.0, 192.0}) {
      const Mat3 R = to.axes * Eigen::AngleAxisd(yaw_deg * k_rad_per_deg, Vec3::UnitZ()).toRotationMatrix() *
                     from.axes.transpose();
      for (const double height_mm : {0.0, rise_mm}) {
        Placement placement{.T_target_source = SE3::Identity(), .grade = grade};
        placement.T_target_source.linear() = R;
        placement.T_target_source.translation() = to.mean + height_mm * to.axes.col(2) - R * from.mean;
        placements.push_back(placement);
      }
    }
  }
  return placements;
}

Surfels graded(const Surfels& surfels, const Grade& grade) {
  Surfels out = surfels;
  for (std::size_t i = 0; i < out.size(); ++i)
    out.positions[i] = grade.apply(surfels.positions[i].cast<double>(), surfels.foot(i)).cast<float>();
  return out;
}

Grade start_grade(const GradingLaw& law, double length_mm, const Upper& upper) {
  return law.at_length(std::clamp(upper.axes.length_mm / length_mm, 0.7, 1.4));
}

std::vector<IcpResult> different_ones(std::vector<IcpResult> fits, const Vec3& centre) {
  std::sort(fits.begin(), fits.end(),
            [](const IcpResult& a, const IcpResult& b) { return a.cost_mm2 < b.cost_mm2; });
  std::vector<IcpResult> different;
  for (const IcpResult& fit : fits) {
    const bool known = std::any_of(different.begin(), different.end(), [&](const IcpResult& other) {
      return alike(fit.placement, other.placement, centre);
    });
    if (!known) different.push_back(fit);
  }
  return different;
}

std::vector<IcpResult> coarse_fits(const Sample& sample, const Upper& upper, const AlignOptions& options) {
  // The common part's own length, not the sample's: its sole is longer than its upper.
  const Grade grade =
      options.grade ? start_grade(options.law, shoe_axes(sample.common).length_mm, upper) : Grade{};
  const std::vector<Placement> placements = starts(graded(sample.common_coarse, grade), upper, grade);
  const NearestTable wide{upper.surfels_coarse, static_cast<float>(k_coarse_reach_mm)};
  const Surfaces surfaces{
      .source = sample.common_coarse, .target = upper.surfels_coarse, .target_table = wide};

  std::vector<IcpResult> fits(placements.size());
  tbb::parallel_for(std::size_t{0}, placements.size(), [&](std::size_t i) {
    const IcpResult rough = run_icp(
        surfaces, placements[i],
        {.reach_mm = k_coarse_reach_mm, .min_normal_cosine = 0.5, .least_scale_mm = 2, .max_iterations = 20});
    fits[i] = run_icp(surfaces, rough.placement,
                      {.reach_mm = k_middle_reach_mm,
                       .least_scale_mm = 0.5,
                       .max_iterations = 20,
                       .freedom = options.grade ? Freedom::Graded : Freedom::Rigid,
                       .law = options.law});
  });
  return different_ones(std::move(fits), mean_of(sample.common_coarse));
}

}  // namespace biteline::transfer
