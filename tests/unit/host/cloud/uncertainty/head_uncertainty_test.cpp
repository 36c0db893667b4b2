// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/head_uncertainty.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/uncertain_scan.hpp"

namespace biteline::uncertainty {

TEST_GROUP(HeadUncertainty) {
  const test::UncertainScan scan = test::uncertain_scan({.profile_step_mm = 60});
  const geometry::SensorModel& model = scan.head.model;
  const HeadUncertainty& known = scan.head.uncertainty;
  const Vec2 pixel{700, 600};

  Vec3 point_flange(const geometry::SensorModel& head) const {
    return head.T_flange_cam * geometry::triangulate(head.camera, head.laser_plane, pixel);
  }
};

TEST(HeadUncertainty, NoErrorIsTheHeadItself) {
  const geometry::SensorModel sut = perturbed(model, known, Parameters::Zero());
  CHECK((point_flange(sut) - point_flange(model)).norm() < 1e-9);
}

TEST(HeadUncertainty, TheJacobianForeseesWhereAPointGoes) {
  const auto J = point_jacobian(model, known, pixel);
  for (int i = 0; i < k_clock_at; ++i) {
    const double sigma = std::sqrt(known.covariance(i, i));
    const Vec3 moved =
        point_flange(perturbed(model, known, sigma * Parameters::Unit(i))) - point_flange(model);
    // The second order of so small a change is far below a thousandth of it.
    CHECK_TEXT((moved - sigma * J.col(i)).norm() <= 1e-3 * moved.norm() + 1e-7, "parameter");
  }
}

TEST(HeadUncertainty, AShiftOfTheMountingMovesThePointByItself) {
  const auto J = point_jacobian(model, known, pixel);
  const Mat3 shift = J.middleCols<3>(k_mounting_at);
  CHECK((shift - model.T_flange_cam.linear()).norm() < 1e-6);
}

}  // namespace biteline::uncertainty
