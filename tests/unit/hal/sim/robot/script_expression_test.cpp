// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script_expression.hpp"

#include <CppUTest/TestHarness.h>

#include <string>

namespace biteline::sim {
namespace {

SE3 at_mm(double x, double y, double z) {
  SE3 T = SE3::Identity();
  T.translation() = Vec3{x, y, z};
  return T;
}

const ScriptWorld& world() {
  static const ScriptWorld made{
      .input_register = [](int number) { return 10 * number; },
      .T_base_tcp = [](bool actual) { return at_mm(actual ? 100 : 400, 0, 0); },
      .step_s = 0.002,
      .set_output = [](int, bool) {},
      .set_analog = [](int, double) {},
  };
  return made;
}

std::optional<ScriptValue> value(const char* text) {
  RowReader row{text, 1};
  const Result<Expression> read = row.expression();
  CHECK_TEXT(read.has_value(), read ? "" : to_line(read.error()).c_str());
  CHECK_TEXT(row.at_end(), text);
  return value_of(*read, {{"a", 3.0}, {"here", ScriptPose{0.1, 0, 0, 0, 0, 0}}}, {{"a", 7.0}, {"b", 2.0}},
                  world());
}

double number(const char* text) {
  const auto found = value(text);
  CHECK_TEXT(found.has_value(), text);
  return std::get<double>(*found);
}

}  // namespace

TEST_GROUP(ScriptExpression){};

TEST(ScriptExpression, BindsAsTheLanguageDoes) {
  DOUBLES_EQUAL(7, number("1 + 2 * a"), 0);
  DOUBLES_EQUAL(9, number("(1 + 2) * a"), 0);
  DOUBLES_EQUAL(-4, number("2 - a - a"), 0);
  DOUBLES_EQUAL(1.5, number("-a / -b"), 0);
  DOUBLES_EQUAL(1, number("a > 2 and b <= 2"), 0);
  DOUBLES_EQUAL(1, number("False or not a == 2"), 0);
  DOUBLES_EQUAL(0, number("a != 3 or (b < 2 and True)"), 0);
}

/// The thread's own a hides the program's; order, to, android are names.
TEST(ScriptExpression, TakesVariablesByTheirWholeNames) {
  DOUBLES_EQUAL(3, number("a"), 0);
  DOUBLES_EQUAL(2, number("b"), 0);
  CHECK_FALSE(value("nothing + 1").has_value());
  CHECK_FALSE(value("a + android").has_value());
}

TEST(ScriptExpression, FunctionsOfPosesAndTheController) {
  DOUBLES_EQUAL(470, number("read_input_integer_register(47)"), 0);
  DOUBLES_EQUAL(0.002, number("get_steptime()"), 0);
  DOUBLES_EQUAL(0.3, number("point_dist(get_target_tcp_pose(), here)"), 1e-12);
  DOUBLES_EQUAL(0, number("point_dist(get_actual_tcp_pose(), here)"), 1e-12);
  // Half a turn about x: what lies 50 mm ahead of the tool lies below it.
  DOUBLES_EQUAL(0,
                number("point_dist(pose_trans(p[0,0,0,3.14159265358979,0,0], p[0,0,0.05,0,0,0]),"
                       " p[0,0,-0.05,0,0,0])"),
                1e-9);
  DOUBLES_EQUAL(0, number("point_dist(pose_trans(pose_inv(here), here), p[0,0,0,0,0,0])"), 1e-12);
  DOUBLES_EQUAL(5, number("sqrt(a * a + 16)"), 1e-12);
}

TEST(ScriptExpression, APoseIsNoNumber) {
  CHECK_FALSE(value("here + 1").has_value());
  CHECK_FALSE(value("point_dist(here, 1)").has_value());
  CHECK_FALSE(value("sqrt(0 - 1)").has_value());
}

TEST(ScriptExpression, WhatCannotBeReadIsRefusedWithItsLine) {
  for (const char* text : {"1 +", "(1", "popup(1)", "p[1,2]", "point_dist(here)", ""}) {
    RowReader row{text, 12};
    const Result<Expression> read = row.expression();
    CHECK_TEXT(!read, text);
    STRCMP_CONTAINS("line 12", to_line(read.error()).c_str());
  }
  const std::string deep(200, '(');
  CHECK(!RowReader(deep, 1).expression());
  const std::string signs(200, '-');
  CHECK(!RowReader(signs, 1).expression());
}

}  // namespace biteline::sim
