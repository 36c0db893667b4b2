// SPDX-License-Identifier: MIT
#include "firmware/pipeline/triangulation_table.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

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

TEST(TriangulationTable, PlaneBehindTheCameraIsRefused) {
  geometry::SensorModel sensor = test::made_head(320, 200);
  sensor.laser_plane.distance_mm = -sensor.laser_plane.distance_mm;
  CHECK(!TriangulationTable::create(sensor));
}

}  // namespace biteline::pipeline
