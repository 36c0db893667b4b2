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
struct Foundation {
  double newton, tolerance_newton;
};
Foundation foundation(const ContactTool& tool, double deep_mm) {
  constexpr double k_width_mm = 10, k_piece_mm = 2;
  const double radius_mm = tool.radius_mm + k_piece_head_mm;
  const auto upper = [&](double depth_mm) {
    return k_width_mm * k_newton_per_mm3 * 4 / 3 * depth_mm * std::sqrt(2 * radius_mm * depth_mm);
  };
  double low_mm = 0, high_mm = deep_mm;
  for (int i = 0; i < 60; ++i) {
    const double depth_mm = 0.5 * (low_mm + high_mm);
    (upper(depth_mm) > tool.newton_per_mm * (deep_mm - depth_mm) ? high_mm : low_mm) = depth_mm;
  }
  // A sum over pieces is off the integral of a parabola by (piece / contact)^2 at most (Euler and Maclaurin);
  // the arm's spring passes on its share.  A thousandth is left of the swings.
  const double contact_mm = 2 * std::sqrt(2 * radius_mm * low_mm);
  const double per_mm = 1.5 * upper(low_mm) / low_mm;
  const double share = tool.newton_per_mm / (tool.newton_per_mm + per_mm);
  const double off = share * std::pow(k_piece_mm / contact_mm, 2) + 0.001;
  return {upper(low_mm), off * upper(low_mm)};
}

ContactNow settled(ContactWorld& world, double deep_mm) {
  for (int i = 0; i < k_settled; ++i) world.step(pressed_in(deep_mm), k_step_s);
  return world.now();
}

}  // namespace

TEST_GROUP(ContactWorld){};

TEST(ContactWorld, PressesAsAnElasticFoundationDoes) {
  const ContactTool tool = disc();
  for (const double deep_mm : {0.6, 1.2, 2.4}) {
    auto world = ContactWorld::create(plate(), tool);
    CHECK(world.has_value());
    const Foundation expected = foundation(tool, deep_mm);
    const ContactNow now = settled(**world, deep_mm);
    DOUBLES_EQUAL(expected.newton, now.pressed_newton, expected.tolerance_newton);
    DOUBLES_EQUAL(expected.newton, now.force_base.x(), expected.tolerance_newton);
    // Square to the face along the strip: the rows are even.
    DOUBLES_EQUAL(0, now.force_base.z(), expected.tolerance_newton);
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
