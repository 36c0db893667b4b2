// SPDX-License-Identifier: MIT
#include "host/transfer/align/icp.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "tests/support/made_pair.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::transfer {

TEST_GROUP(Icp) {
  Surfels source, target;

  void setup() override {
    const sim::ShoeParameters upper = sim::bare_upper_of(sim::draw_shoe(sim::ShoeClass::Deep, 4), 0, 0);
    const sim::ScanSettings scan{.column_step_mm = 0.3, .noise_mm = 0};
    target = surfels_of(test::scanned(upper, SE3::Identity(), scan).points, 2);
    // Its back third is missing: what has no counterpart must not pull.
    source.pitch_mm = target.pitch_mm;
    const sim::ScanSettings shifted{.profile_step_mm = 1.3, .column_step_mm = 0.23, .noise_mm = 0};
    const Surfels all = surfels_of(test::scanned(upper, SE3::Identity(), shifted).points, 2);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.positions[i].x() < 80) continue;
      source.positions.push_back(all.positions[i]);
      source.normals.push_back(all.normals[i]);
    }
  }
};

TEST(Icp, FindsTheMotionOfAPartToAHundredth) {
  const NearestTable table{target, 15};
  const Surfaces surfaces{.source = source, .target = target, .target_table = table};
  Twist xi;
  xi << 3, -4, 2, 0.02, -0.015, 0.03;
  const Placement start{.T_target_source = geometry::exp_se3(xi)};
  const IcpResult wide = run_icp(surfaces, start, {.reach_mm = 15, .least_scale_mm = 0.5});
  const IcpResult sut = run_icp(surfaces, wide.placement, {.reach_mm = 3});
  CHECK(sut.converged);
  CHECK(sut.overlap_ratio > 0.97);
  // Surfels of two different samplings, exact points: what is left is curvature within a voxel (2² / (8 * 15)
  // = 0.03 mm), alike on both sides.  Along the upright the wall fixes the place ten times less well.
  TRANSFORMS_EQUAL(SE3::Identity(), sut.placement.T_target_source, 0.15, 0.002);
  CHECK(sut.rms_mm < 0.03);
}

TEST(Icp, InformationIsTheNumericSecondDerivativeOfTheCost) {
  const NearestTable table{target, 5};
  const Surfaces surfaces{.source = source, .target = target, .target_table = table};
  const IcpResult sut = run_icp(surfaces, {}, {.reach_mm = 5});
  const std::vector<Pair> pairs = find_pairs(surfaces, sut.placement, {.reach_mm = 5});
  const auto residuals_moved = [&](int k, double step) {
    Twist xi = Twist::Zero();
    xi[k] = step;
    const SE3 T = sut.placement.T_target_source * geometry::exp_se3(xi);
    std::vector<double> residuals;
    for (const Pair& pair : pairs) {
      residuals.push_back(
          (T * pair.point - target.positions[pair.target].cast<double>()).dot(pair.direction));
    }
    return residuals;
  };
  constexpr double k_step = 1e-4;
  for (int k = 0; k < 6; ++k) {
    const std::vector<double> plus = residuals_moved(k, k_step), minus = residuals_moved(k, -k_step);
    double sum = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double derivative = (plus[i] - minus[i]) / (2 * k_step);
      sum += derivative * derivative;
    }
    DOUBLES_EQUAL(1.0, sut.information(k, k) / sum, 1e-4);
  }
}

TEST(Icp, LineMovesWithTheGradeAsItsJacobianSays) {
  const Grade grade{.length = 1.1,
                    .width = 1.07,
                    .section_along = 1.05,
                    .section_across = 1.04,
                    .height = 1.02,
                    .offset_mm = 0.4};
  const Vec3 point{120, -30, 25};
  const Foot foot{.place = point.head<2>().cast<float>()};
  constexpr double k_step = 1e-6;
  const auto moved = [&](int parameter, double step) {
    Grade other = grade;
    double* const factors[] = {&other.length, &other.width, &other.section_along, &other.section_across,
                               &other.height};
    *factors[parameter] *= 1 + step;
    return other.apply(point, foot);
  };
  const LineJacobian J = line_jacobian(grade, point, Vec2::Zero(), parameter_count(Freedom::Graded));
  for (int parameter = 0; parameter < 5; ++parameter) {
    const Vec3 numeric = (moved(parameter, k_step) - moved(parameter, -k_step)) / (2 * k_step);
    CHECK((numeric - J.col(k_length + parameter)).norm() < 1e-5);
  }
}

TEST(Icp, NothingInReachConvergesToNothing) {
  const NearestTable table{target, 5};
  const Surfaces surfaces{.source = source, .target = target, .target_table = table};
  const Placement far{.T_target_source = geometry::make_se3(Eigen::Quaterniond::Identity(), {5000, 0, 0})};
  const IcpResult sut = run_icp(surfaces, far, {.reach_mm = 5});
  CHECK_FALSE(sut.converged);
  DOUBLES_EQUAL(0.0, sut.overlap_ratio, 0);
}

}  // namespace biteline::transfer
