// SPDX-License-Identifier: MIT
// What MuJoCo makes of a disc on an elastic strip, against the closed form of an elastic foundation.
#include "hal/sim/contact/contact_world.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {
namespace {

constexpr double k_newton_per_mm3 = 1, k_step_s = 0.002;
/// All swings of the arm's spring are down to a thousandth then: 10 Hz, a tenth of the critical damping.
constexpr int k_settled = 600;

/// Flat, along y, its outside towards x.
UpperStrip plate() {
  UpperStrip strip{.piece_mm = 2, .rows = 5, .low_mm = 0, .pieces = {}};
  for (int column = 0; column < 41; ++column) {
    for (int row = 0; row < 5; ++row) {
      strip.pieces.push_back({.point_base = {0, 2.0 * column, 2.0 * row},
                              .normal_base = Vec3::UnitX(),
                              .area_mm2 = 4,
                              .newton_per_mm = 4 * k_newton_per_mm3});
    }
  }
  return strip;
}

/// Wider than the strip, its face square to its own axis.
ContactTool disc() {
  ContactTool tool = grinding_disc();
  tool.width_mm = 14;
  tool.tilt_rad = tool.lead_rad = tool.friction_ratio = 0;
  return tool;
}

/// Its tip so deep below the plate's surface as if nothing gave.
SE3 pressed_in(double deep_mm) {
  SE3 T = SE3::Identity();
  T.linear() << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  T.translation() = Vec3{-deep_mm, 40.3, 4};
  return T;
}

/// Force of a rigid roller on a foundation of springs: width * modulus * 4/3 * depth * sqrt(2 * radius *
/// depth) (K. L. Johnson, "Contact Mechanics", 4.3), in a row with the arm's spring.
double foundation_newton(const ContactTool& tool, double deep_mm) {
  constexpr double k_width_mm = 10;
  double low_mm = 0, high_mm = deep_mm;
  for (int i = 0; i < 60; ++i) {
    const double depth_mm = 0.5 * (low_mm + high_mm);
    const double upper =
        k_width_mm * k_newton_per_mm3 * 4 / 3 * depth_mm * std::sqrt(2 * tool.radius_mm * depth_mm);
    (upper > tool.newton_per_mm * (deep_mm - depth_mm) ? high_mm : low_mm) = depth_mm;
  }
  return tool.newton_per_mm * (deep_mm - low_mm);
}

ContactNow settled(ContactWorld& world, double deep_mm) {
  for (int i = 0; i < k_settled; ++i) world.step(pressed_in(deep_mm), k_step_s);
  return world.now();
}

}  // namespace

TEST_GROUP(ContactWorld){};

/// Pieces of 2 mm under a contact of 8 to 11 mm: the sum is off the integral by less than 3 %, and the arm's
/// spring, five times as soft, takes most of that.
TEST(ContactWorld, PressesAsAnElasticFoundationDoes) {
  const ContactTool tool = disc();
  for (const double deep_mm : {0.6, 1.2, 2.4}) {
    auto world = ContactWorld::create(plate(), tool);
    CHECK(world.has_value());
    const double expected = foundation_newton(tool, deep_mm);
    const ContactNow now = settled(**world, deep_mm);
    DOUBLES_EQUAL(expected, now.pressed_newton, 0.03 * expected);
    DOUBLES_EQUAL(expected, now.force_base.x(), 0.03 * expected);
    DOUBLES_EQUAL(0, now.force_base.z(), 0.02 * expected);
  }
}

TEST(ContactWorld, MeetsNothingBesideThePlateAndTakesOffWhereItPresses) {
  auto world = ContactWorld::create(plate(), disc());
  CHECK(world.has_value());
  DOUBLES_EQUAL(0, settled(**world, -0.5).pressed_newton, 1e-9);
  for (const double width_mm : (*world)->removed_width_mm(0.001)) DOUBLES_EQUAL(0, width_mm, 1e-9);
  static_cast<void>(settled(**world, 1.2));
  const std::vector<double> widths = (*world)->removed_width_mm(0.001);
  DOUBLES_EQUAL(8, widths[20], 1e-9);  // all five rows where it stands
  DOUBLES_EQUAL(0, widths[5], 1e-9);
}

/// A rim that slides pulls by its share of the force, along the line.
TEST(ContactWorld, SlidingRimPullsAlongTheLine) {
  ContactTool tool = disc();
  tool.friction_ratio = 0.4;
  auto world = ContactWorld::create(plate(), tool);
  CHECK(world.has_value());
  const ContactNow now = settled(**world, 1.2);
  DOUBLES_EQUAL(0.4 * now.pressed_newton, now.force_base.y(), 0.02 * now.pressed_newton);
}

TEST(ContactWorld, StripWithoutPiecesIsRefused) {
  CHECK_FALSE(ContactWorld::create({}, disc()).has_value());
}

}  // namespace biteline::sim
