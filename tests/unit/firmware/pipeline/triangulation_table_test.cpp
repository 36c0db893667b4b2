// SPDX-License-Identifier: MIT
#include "firmware/pipeline/triangulation_table.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "tests/support/errors.hpp"
#include "tests/support/made_head.hpp"

namespace biteline::pipeline {

TEST_GROUP(TriangulationTable){};

TEST(TriangulationTable, IsTheDirectFormulaToATenthOfAMicrometreOverTheWholeRegion) {
  // The whole sensor, twice the distortion of the head in use.
  geometry::SensorModel sensor = test::made_head(1626, 1236);
  sensor.camera.k1 *= 2;
  sensor.camera.k2 *= 2;
  const auto sut = TriangulationTable::create(sensor);
  CHECK(sut.has_value());
  constexpr double k_tenth_um_mm = 1e-4;
  double worst_mm = 0, worst_slope_ratio = 0;
  for (int column = 0; column < 1626; column += 25) {
    for (double row_px = 0; row_px <= 1235; row_px += 0.731) {
      const Vec2 pixel_px{column + sensor.region.offset_u_px, row_px + sensor.region.offset_v_px};
      const Vec3 direct = geometry::triangulate(sensor.camera, sensor.laser_plane, pixel_px);
      const auto point = sut->rt_point(column, static_cast<float>(row_px));
      // The row itself is single precision too: its rounding is the peak's affair and left out.
      const Vec3 same_row = geometry::triangulate(
          sensor.camera, sensor.laser_plane,
          {pixel_px.x(), static_cast<double>(static_cast<float>(row_px)) + sensor.region.offset_v_px});
      worst_mm = std::max(worst_mm, (point.point_cam.cast<double>() - same_row).norm());
      const Vec3 next = geometry::triangulate(sensor.camera, sensor.laser_plane, pixel_px + Vec2{0, 0.01});
      worst_slope_ratio =
          std::max(worst_slope_ratio,
                   std::fabs(static_cast<double>(point.mm_per_row) / ((next - direct).norm() / 0.01) - 1));
    }
  }
  CHECK_TEXT(worst_mm < k_tenth_um_mm, StringFromFormat("worst %g mm", worst_mm).asCharString());
  CHECK(worst_slope_ratio < 0.01);
}

TEST(TriangulationTable, SinglePrecisionAddsLessThanAPercentToThePeaksOwnVariance) {
  // Proof that float is enough behind the peak: a row as float is off by at most half a unit in the last
  // place of 1236, 0.00006 px, and a point as float by 0.00002 mm at 400 mm, where the noise limit of a
  // bright peak is 0.01 px and 0.001 mm.
  const geometry::SensorModel sensor = test::made_head(1626, 1236);
  const double row_rounding_px = 0.5 * std::ldexp(1.0, 10 - 23);
  const double mm_per_row = (geometry::triangulate(sensor.camera, sensor.laser_plane, {800, 601}) -
                             geometry::triangulate(sensor.camera, sensor.laser_plane, {800, 600}))
                                .norm();
  const double point_rounding_mm = 0.5 * std::ldexp(1.0, 8 - 23) * std::sqrt(3.0);
  constexpr double k_best_peak_px = 0.01;
  const double rounding_mm = row_rounding_px * mm_per_row + point_rounding_mm,
               noise_mm = k_best_peak_px * mm_per_row;
  CHECK(rounding_mm * rounding_mm < 0.01 * noise_mm * noise_mm);
}

TEST(TriangulationTable, ColumnsAndRowsAreNotExchanged) {
  const geometry::SensorModel sensor = test::made_head(320, 200);
  const auto sut = TriangulationTable::create(sensor);
  CHECK(sut.has_value());
  CHECK(sut->rt_point(300, 100).point_cam.x() > sut->rt_point(10, 100).point_cam.x() + 10);
  DOUBLES_EQUAL(sut->rt_point(10, 20).point_cam.x(), sut->rt_point(10, 190).point_cam.x(), 3);
}

TEST(TriangulationTable, ACornerThatThePlaneMissesHasNoValueAndTheRestIsExact) {
  // A wide lens, and a plane that some rays run along: by its middle, in a corner, under an edge.
  for (const Vec3& normal : {Vec3{0.05, 0.75, -0.2}, Vec3{0.3, 0.7, -0.25}, Vec3{-0.4, 0.6, -0.3}}) {
    geometry::SensorModel sensor = test::made_head(1626, 1236);
    sensor.region = {.width_px = 1626, .height_px = 1236};
    sensor.camera.fu_px = sensor.camera.fv_px = 900;
    sensor.camera.k1 = sensor.camera.k2 = 0;
    sensor.laser_plane = {.normal_cam = normal.normalized(), .distance_mm = -150};
    const auto sut = TriangulationTable::create(sensor);
    SUCCEEDS(sut);
    int with = 0, without = 0, missed = 0;
    double worst_px = 0;
    for (int column = 0; column < 1626; column += 25) {
      for (int row_px = 0; row_px <= 1235; row_px += 3) {
        const Vec2 pixel_px{static_cast<double>(column), static_cast<double>(row_px)};
        const double towards = sensor.laser_plane.normal_cam.dot(sensor.camera.ray(pixel_px)) * -150;
        const auto point = sut->rt_point(column, static_cast<float>(row_px));
        if (std::isnan(point.point_cam.z())) {
          ++without;
          missed += towards <= 0 ? 1 : 0;
          continue;
        }
        ++with;
        CHECK(towards > 0);
        const Vec3 direct = geometry::triangulate(sensor.camera, sensor.laser_plane, pixel_px);
        worst_px = std::max(worst_px, ((point.point_cam.cast<double>() - direct).norm() - 1e-3) /
                                          static_cast<double>(point.mm_per_row));
      }
    }
    CHECK(with > 5000 && missed > 100);
    // Nothing that is seen goes: only where a row is metres.
    CHECK_COMPARE(without - missed, <, with / 10);
    CHECK_COMPARE(worst_px, <, 0.02);
  }
}

TEST(TriangulationTable, NoRayIsLostOfAHeadWhosePlaneIsSeenEverywhere) {
  const geometry::SensorModel sensor = test::made_head(1626, 1236);
  const auto sut = TriangulationTable::create(sensor);
  SUCCEEDS(sut);
  for (int column = 0; column < 1626; column += 5) {
    for (int row_px = 0; row_px <= 1235; row_px += 5)
      CHECK_FALSE(std::isnan(sut->rt_point(column, static_cast<float>(row_px)).point_cam.z()));
  }
}

TEST(TriangulationTable, PlaneBehindTheCameraIsRefused) {
  geometry::SensorModel sensor = test::made_head(320, 200);
  sensor.laser_plane.distance_mm = -sensor.laser_plane.distance_mm;
  CHECK(!TriangulationTable::create(sensor));
}

}  // namespace biteline::pipeline
