// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/frame.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <cstring>

#include "host/interfaces/gige/depth.hpp"
#include "tests/support/made_head.hpp"

namespace biteline {

TEST_GROUP(GigeFrame) {
  profile::Profile profile;

  void add(std::uint16_t column, float z, float amplitude, std::uint16_t flags = 0) {
    profile::ProfilePoint point;
    point.point_cam = {1, 2, z};
    point.column = column;
    point.amplitude = amplitude;
    point.flags = flags;
    profile.points.push_back(point);
  }
  static float float_at(const std::vector<std::uint8_t>& line, std::size_t index) {
    float value = 0;
    std::memcpy(&value, line.data() + 4 * index, sizeof value);
    return value;
  }
  static int depth_at(const std::vector<std::uint8_t>& line, std::size_t column) {
    return line[2 * column] + 256 * line[2 * column + 1];
  }
};

TEST(GigeFrame, TheBrightestSurfaceOfAColumnStands) {
  add(1, 100, 50);
  add(1, 200, 90, profile::k_point_reflection);
  add(1, 300, 60);
  add(1, 400, 60);
  add(3, 500, 1, profile::k_point_saturated);
  add(9, 600, 99);  // beyond the line
  const auto line = gige::line_of(gige::Format::Abc32f, 4, {}, profile);
  LONGS_EQUAL(48, line.size());
  CHECK(std::isnan(float_at(line, 0)));
  DOUBLES_EQUAL(1, float_at(line, 3), 0);
  DOUBLES_EQUAL(2, float_at(line, 4), 0);
  DOUBLES_EQUAL(300, float_at(line, 5), 0);
  CHECK(std::isnan(float_at(line, 8)));
  DOUBLES_EQUAL(500, float_at(line, 11), 0);
}

TEST(GigeFrame, DepthsBeyondTheirRangeAreNoSurface) {
  const gige::Depth depth{.scale_mm = 0.01F, .offset_mm = 100};
  add(0, 100, 1);
  add(1, 123.456F, 1);
  add(2, 99.99F, 1);
  add(3, 755.34F, 1);
  add(4, 755.35F, 1);
  const auto line = gige::line_of(gige::Format::C16, 6, depth, profile);
  LONGS_EQUAL(0, depth_at(line, 0));
  LONGS_EQUAL(2346, depth_at(line, 1));
  LONGS_EQUAL(gige::k_no_depth, depth_at(line, 2));
  LONGS_EQUAL(65534, depth_at(line, 3));
  LONGS_EQUAL(gige::k_no_depth, depth_at(line, 4));
  LONGS_EQUAL(gige::k_no_depth, depth_at(line, 5));
}

TEST(GigeFrame, ProfilesHaveBothNumbersOrNone) {
  const gige::Depth depth{
      .scale_mm = 0.01F, .offset_mm = 100, .across = {.scale_mm = 0.001F, .offset_mm = -1.5F}};
  add(0, 123.456F, 1);
  add(1, 99, 1);  // beyond the depths
  add(2, 200, 1);
  profile.points[2].point_cam.x() = 70;  // beyond the width
  const auto line = gige::line_of(gige::Format::Ac16, 4, depth, profile);
  LONGS_EQUAL(16, line.size());
  LONGS_EQUAL(2500, depth_at(line, 0));
  LONGS_EQUAL(2346, depth_at(line, 1));
  for (std::size_t half = 2; half < 8; ++half) LONGS_EQUAL(gige::k_no_depth, depth_at(line, half));
}

TEST(GigeFrame, TheDepthsOfAHeadFitTheirRange) {
  const geometry::SensorModel model = test::made_head(1626, 320);
  const gige::Depth depth = gige::depth_of(model);
  for (const int u : {0, model.region.width_px / 2, model.region.width_px - 1}) {
    for (const int v : {0, model.region.height_px / 2, model.region.height_px - 1}) {
      const Vec2 pixel{model.region.offset_u_px + u, model.region.offset_v_px + v};
      const Vec3 point = geometry::triangulate(model.camera, model.laser_plane, pixel);
      const double z = (point.z() - depth.offset_mm) / depth.scale_mm,
                   x = (point.x() - depth.across.offset_mm) / depth.across.scale_mm;
      CHECK(z >= 0 && z < gige::k_no_depth);
      CHECK(x >= 0 && x < gige::k_no_depth);
    }
  }
  CHECK(depth.scale_mm < 0.05F);
  CHECK(depth.across.scale_mm < 0.05F);
}

}  // namespace biteline
