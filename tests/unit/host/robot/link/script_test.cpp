// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/script.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <sstream>
#include <utility>

#include "host/robot/link/ur/units.hpp"
#include "host/robot/path/first_run.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::ur {

TEST_GROUP(UrScript) {
  path::CheckedPath path = test::planned_path("grind.yaml");
  std::vector<std::string> lines;

  void setup() override {
    std::istringstream text{urscript(path)};
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  std::size_t count(const char* word) {
    return static_cast<std::size_t>(std::ranges::count_if(
        lines, [&](const std::string& line) { return line.find(word) != std::string::npos; }));
  }
};

TEST(UrScript, IsOneProgramThatBeginsWithToolAndJoints) {
  STRCMP_EQUAL("def biteline_path():", lines.front().c_str());
  STRCMP_EQUAL("end", lines.back().c_str());
  CHECK(lines[1].find("set_tcp(p[0.0000000,0.0000000,0.1800000") != std::string::npos);
  CHECK(lines[2].find("set_payload(") != std::string::npos);
  CHECK(lines[4].find("movej([") != std::string::npos);
  CHECK_EQUAL(1U, count("movej"));
}

TEST(UrScript, PosturesOnTheWayThereComeFirstInTheirOrder) {
  const test::FromBehind behind = test::from_behind("grind.yaml");
  CHECK_TEXT(behind.way.path.has_value(), behind.way.check.detail.c_str());
  const auto& via_rad = behind.way.path->path().via_rad;
  CHECK(!via_rad.empty());
  std::istringstream text{urscript(*behind.way.path)};
  std::string line;
  for (int i = 0; i < 4; ++i) std::getline(text, line);  // def, set_tcp, set_payload, the tool off
  std::vector<kinematics::Joints> stops = via_rad;
  stops.push_back(path.path().waypoints.front().q_rad);
  for (const kinematics::Joints& stop : stops) {
    std::getline(text, line);
    kinematics::Joints q_rad;
    LONGS_EQUAL(6, std::sscanf(line.c_str(), "  movej([%lf,%lf,%lf,%lf,%lf,%lf]", &q_rad[0], &q_rad[1],
                               &q_rad[2], &q_rad[3], &q_rad[4], &q_rad[5]));
    DOUBLES_EQUAL(0, (stop - q_rad).norm(), 1e-6);
  }
  std::getline(text, line);
  CHECK(line.find("movej") == std::string::npos);
}

/// Before anything moves, the tool off before the program ends, and gone with it.
TEST(UrScript, DeadManStandsBeforeAnythingElseAlsoInTheAir) {
  const path::PlanOutcome air = path::plan(path::first_run(test::plan_request("grind.yaml")));
  CHECK_TEXT(air.path.has_value(), air.reason().c_str());
  for (const auto* checked : std::initializer_list<const path::CheckedPath*>{&path, &*air.path}) {
    const std::string text = urscript(*checked, 47);
    const auto at = [&](const char* words) { return text.find(words); };
    CHECK(
        text.starts_with("def biteline_path():\n  rtde_set_watchdog(\"input_int_register_47\", 2, \"stop\")\n"
                         "  thread biteline_dead_man():\n"));
    const std::size_t run = at("  biteline_watch = run biteline_dead_man()\n");
    CHECK(run < at("set_tcp("));
    CHECK(at("    set_standard_digital_out(0, False)\n    sync()\n    halt\n  end\n") < run);
    CHECK(text.ends_with("  kill biteline_watch\nend\n"));
    // Beside it the program is the same.
    std::string plain = text;
    plain.erase(plain.find("  kill biteline_watch\n"), std::string{"  kill biteline_watch\n"}.size());
    const std::size_t begin = plain.find("  rtde_set_watchdog");
    plain.erase(begin, plain.find("  set_tcp(") - begin);
    STRCMP_EQUAL(urscript(*checked).c_str(), plain.c_str());
  }
}

/// The thread is done before the controller's own watchdog, which leaves the tool on, also on a CB3.
TEST(UrScript, DeadMansThreadComesBeforeTheControllersWatchdog) {
  constexpr double k_cb3_cycle_s = 0.008;
  CHECK((k_most_still_looks + 1) * (k_look_s + k_cb3_cycle_s) < 1 / k_watchdog_hz);
  CHECK(1 / k_watchdog_hz <= k_dead_man_s);
}

TEST(UrScript, EveryLineWaypointIsOneProcessMoveBetweenToolOnAndOff) {
  const auto& waypoints = path.path().waypoints;
  const auto on_line =
      std::ranges::count_if(waypoints, [](const auto& w) { return w.segment == path::Segment::Line; });
  CHECK_EQUAL(static_cast<std::size_t>(on_line) - 1, count("movep("));  // the first is reached by movel
  const auto first =
      std::ranges::find_if(lines, [](const std::string& l) { return l.find("movep") != std::string::npos; });
  CHECK((first - 1)->find("True") != std::string::npos);
}

/// On for the line alone: off before the first move, off before the arm leaves; the joint moves and the
/// straight ones are made without it.
TEST(UrScript, ToolIsOffOnEveryWayThatIsNotTheLine) {
  CHECK_EQUAL(3U, count("set_standard_digital_out(0, "));
  bool on = false, told = false;
  for (const std::string& line : lines) {
    if (line.find("set_standard_digital_out(0, ") != std::string::npos) {
      on = line.find("True") != std::string::npos;
      told = true;
    }
    if (line.find("  move") != 0) continue;
    CHECK_TEXT(told, line.c_str());
    CHECK_EQUAL_TEXT(line.find("  movep") == 0, on, line.c_str());
  }
  CHECK_FALSE(on);
}

/// Of a run in the air: whatever was on before.
TEST(UrScript, WithTheToolOffItIsSwitchedOffAtEachPlaceAndNeverOn) {
  const path::PlanOutcome outcome = path::plan(path::first_run(test::plan_request("grind.yaml")));
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  lines.clear();
  std::istringstream text{urscript(*outcome.path)};
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  CHECK_EQUAL(0U, count("True"));
  CHECK_EQUAL(3U, count("set_standard_digital_out(0, False)"));
  const auto first = [&](const char* word) {
    return std::ranges::find_if(
        lines, [&](const std::string& line) { return line.find(word) != std::string::npos; });
  };
  CHECK(first("digital_out") < first("  move"));
}

TEST(UrScript, WithZonesTheToolIsOnOnEachStretchAndOffBetween) {
  path::PlanRequest asked = test::plan_request("grind.yaml");
  asked.line = path::test::made_line({.taper = 0.15});
  asked.process.zones = {
      {.name = "heel", .where = path::Zone::Where::Heel, .reach_ratio = 0.15, .left_out = true},
      {.name = "side", .from_ratio = 0.3, .to_ratio = 0.4, .passes = 2}};
  const path::PlanOutcome outcome = path::plan(asked);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  lines.clear();
  std::istringstream text{urscript(*outcome.path)};
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  CHECK_EQUAL(2U, count("digital_out(0, True)"));
  CHECK_EQUAL(3U, count("digital_out(0, False)"));
  bool on = false;
  std::size_t rounded = 0, between = 0;
  double z_m = 0, lowest_m = 1e9;
  for (const std::string& line : lines) {
    if (line.find("digital_out(0, ") != std::string::npos) {
      on = line.find("True") != std::string::npos;
      between += on ? 1 : 0;
    }
    if (line.find("  move") != 0 || line.find("movej") != std::string::npos) continue;
    CHECK_EQUAL_TEXT(line.find("  movep") == 0, on, line.c_str());
    const bool is_rounded = line.find("r=0.00000") == std::string::npos;
    CHECK(std::sscanf(line.c_str(), "  move%*c(p[%*f,%*f,%lf", &z_m) == 1);
    if (on || !is_rounded) continue;
    ++rounded;
    lowest_m = std::min(lowest_m, z_m);
  }
  // The way back to the side: lifted, with a blend at each target.
  CHECK(rounded > 3);
  CHECK(lowest_m > 0.001 * (85 + asked.process.motion.lift_mm));
}

TEST(UrScript, LastWayToTheShoeIsAtTheApproachSpeedHoweverShortAndWhereverTheToolWorks) {
  for (const auto& [approach_mm, up_mm] : {std::pair{12.0, 3.0}, {12.0, 7.0}, {8.0, 3.0}, {30.0, 3.0}}) {
    path::PlanRequest asked = test::plan_request("grind.yaml");
    asked.process.motion.approach_mm = approach_mm;
    asked.process.placement.up_mm = up_mm;
    // Else a short way in, begun softly, never comes to its speed.
    asked.process.motion.give_mm.reset();
    const path::PlanOutcome outcome = path::plan(asked);
    CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
    std::istringstream text{urscript(*outcome.path)};
    std::string last_straight, line;
    while (std::getline(text, line) && line.find("movep") == std::string::npos) {
      if (line.find("movel") != std::string::npos) last_straight = line;
    }
    const std::size_t at = last_straight.find("v=");
    CHECK(at != std::string::npos);
    DOUBLES_EQUAL_TEXT(0.001 * asked.process.motion.approach_speed_mm_s,
                       std::strtod(last_straight.c_str() + at + 2, nullptr), 1e-6, last_straight.c_str());
  }
}

TEST(UrScript, PayloadOfTheProcessIsSetBeforeTheArmMoves) {
  STRCMP_EQUAL("  set_payload(1.800, [0.00000,0.00000,0.07000])", lines[2].c_str());
}

/// What controllers refuse or skip: blends that meet, radii below the least, ends in motion, long programs.
/// On every shipped process, of the text itself.
TEST(UrScript, BlendsOfNeighboursNeverMeetAndEndsAreAtRest) {
  for (const char* process : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    struct Target {
      Vec3 tip_m;
      double r_m;
      bool process;
    };
    std::vector<Target> targets;
    std::size_t moves = 0;
    std::istringstream text{urscript(test::planned_path(process))};
    for (std::string line; std::getline(text, line);) {
      moves += line.find("  move") == 0 ? 1 : 0;
      double p[6], a = 0, v = 0, r = 0;
      char kind = 0;
      if (std::sscanf(line.c_str(), "  move%c(p[%lf,%lf,%lf,%lf,%lf,%lf], a=%lf, v=%lf, r=%lf)", &kind, p,
                      p + 1, p + 2, p + 3, p + 4, p + 5, &a, &v, &r) == 10)
        targets.push_back({.tip_m = {p[0], p[1], p[2]}, .r_m = r, .process = kind == 'p'});
    }
    CHECK(moves <= 1000);
    CHECK(targets.size() > 200);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const bool inside = i + 1 < targets.size() && targets[i].process && targets[i + 1].process;
      if (!inside) {
        DOUBLES_EQUAL(0, targets[i].r_m, 0);
        continue;
      }
      CHECK(targets[i].r_m >= 0.001);
      CHECK(targets[i].r_m + targets[i + 1].r_m < (targets[i + 1].tip_m - targets[i].tip_m).norm());
      CHECK(targets[i].r_m + targets[i - 1].r_m < (targets[i].tip_m - targets[i - 1].tip_m).norm());
    }
  }
}

TEST(UrScript, MovesAreInMetresAndRotationVectors) {
  // The last movel goes to the last waypoint.
  double p[6], a = 0, v = 0, r = 0;
  const std::string& last = lines[lines.size() - 2];
  CHECK_EQUAL(9, std::sscanf(last.c_str(), "  movel(p[%lf,%lf,%lf,%lf,%lf,%lf], a=%lf, v=%lf, r=%lf)", p,
                             p + 1, p + 2, p + 3, p + 4, p + 5, &a, &v, &r));
  const SE3 T = from_ur_pose({p[0], p[1], p[2], p[3], p[4], p[5]});
  TRANSFORMS_EQUAL(path.path().waypoints.back().T_base_tcp, T, 1e-3, 1e-6);
  DOUBLES_EQUAL(path.path().motion.acceleration_mm_s2 / 1000, a, 1e-6);
  CHECK(v > 0.01 && v < 0.5);
  DOUBLES_EQUAL(0, r, 0);
}

TEST_GROUP(UrUnits){};

TEST(UrUnits, PosesSurviveTheBorderAlsoNearHalfATurn) {
  for (const double angle_rad : {0.0, 1e-9, 1.0, std::numbers::pi - 1e-7, std::numbers::pi}) {
    const SE3 T = geometry::make_se3(
        Eigen::Quaterniond{Eigen::AngleAxisd{angle_rad, Vec3{1, -2, 3}.normalized()}}, Vec3{100, -200, 300});
    TRANSFORMS_EQUAL(T, from_ur_pose(to_ur_pose(T)), 1e-9, 1e-7);
  }
}

}  // namespace biteline::robot::ur
