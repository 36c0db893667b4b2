// SPDX-License-Identifier: MIT
#include "common/geometry/camera.hpp"

#include <CppUTest/TestHarness.h>

#include "common/geometry/sensor_model.hpp"

namespace biteline::geometry {

TEST_GROUP(Camera) {
  Camera sut{.fu_px = 2730,
             .fv_px = 2712,
             .cu_px = 822,
             .cv_px = 628,
             .k1 = -0.11,
             .k2 = 0.14,
             .p1 = 3e-4,
             .p2 = -2e-4,
             .k3 = 0.01};
};

TEST(Camera, RayInvertsProjectOverTheWholeSensor) {
  for (int u_px = 0; u_px <= 1626; u_px += 271) {
    for (int v_px = 0; v_px <= 1236; v_px += 206) {
      const Vec2 pixel_px(u_px, v_px);
      DOUBLES_EQUAL(0.0, (sut.project(sut.ray(pixel_px) * 250.0) - pixel_px).norm(), 1e-8);
    }
  }
}

TEST(Camera, DistortionFollowsItsDefinition) {
  // Worked by hand for x = 0.2, y = -0.1: r2 = 0.05, radial = 1 - 0.0055 + 0.00035 + 0.00000125.
  const Vec2 distorted = sut.distort({0.2, -0.1});
  const double radial = 1 - 0.0055 + 0.00035 + 0.00000125;
  DOUBLES_EQUAL(0.2 * radial + 2 * 3e-4 * -0.02 + -2e-4 * (0.05 + 0.08), distorted.x(), 1e-12);
  DOUBLES_EQUAL(-0.1 * radial + 3e-4 * (0.05 + 0.02) + 2 * -2e-4 * -0.02, distorted.y(), 1e-12);
}

TEST(Camera, TriangulatedPointLiesOnThePlaneAndOnTheRay) {
  const LaserPlane plane{.normal_cam = Vec3(0.01, 0.704, -0.710).normalized(), .distance_mm = -142};
  const Vec2 pixel_px(300, 700);
  const Vec3 point_cam = triangulate(sut, plane, pixel_px);
  DOUBLES_EQUAL(0.0, plane.signed_distance_mm(point_cam), 1e-9);
  DOUBLES_EQUAL(0.0, (sut.project(point_cam) - pixel_px).norm(), 1e-8);
  CHECK(point_cam.z() > 100);
}

}  // namespace biteline::geometry
