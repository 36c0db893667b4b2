// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/script.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "host/robot/link/ur/units.hpp"
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
  CHECK(lines[2].find("movej([") != std::string::npos);
  CHECK_EQUAL(1U, count("movej"));
}

TEST(UrScript, PosturesOnTheWayThereComeFirstInTheirOrder) {
  const test::FromBehind behind = test::from_behind("grind.yaml");
  CHECK_TEXT(behind.way.path.has_value(), behind.way.check.detail.c_str());
  const auto& via_rad = behind.way.path->path().via_rad;
  CHECK(!via_rad.empty());
  std::istringstream text{urscript(*behind.way.path)};
  std::string line;
  std::getline(text, line);  // def
  std::getline(text, line);  // set_tcp
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

TEST(UrScript, EveryLineWaypointIsOneProcessMoveBetweenToolOnAndOff) {
  const auto& waypoints = path.path().waypoints;
  const auto on_line =
      std::ranges::count_if(waypoints, [](const auto& w) { return w.segment == path::Segment::Line; });
  CHECK_EQUAL(static_cast<std::size_t>(on_line) - 1, count("movep("));  // the first is reached by movel
  CHECK_EQUAL(2U, count("set_digital_out(0"));
  const auto first =
      std::ranges::find_if(lines, [](const std::string& l) { return l.find("movep") != std::string::npos; });
  CHECK((first - 1)->find("True") != std::string::npos);
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
