// SPDX-License-Identifier: MIT
#include "host/robot/path/track.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::path {

TEST_GROUP(Track) {
  CheckedPath checked = robot::test::planned_path("spray.yaml");
  const PlannedPath& path = checked.path();

  /// The plan itself, twice as dense, every pose changed by `change` on the right.
  std::vector<TrackSample> track(const SE3& change) {
    std::vector<TrackSample> out;
    for (std::size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
      for (const double t : {0.0, 0.5}) {
        out.push_back({.time_s = 0,
                       .T_base_tcp = geometry::interpolate(path.waypoints[i].T_base_tcp,
                                                           path.waypoints[i + 1].T_base_tcp, t) *
                                     change});
      }
    }
    out.push_back({.time_s = 0, .T_base_tcp = path.waypoints.back().T_base_tcp * change});
    return out;
  }
};

TEST(Track, PlanItselfHasNoDeviationAndCoversAll) {
  const TrackDeviation d = deviation(path, track(SE3::Identity()));
  CHECK(d.completed);
  DOUBLES_EQUAL(1.0, d.covered, 1e-12);
  // Interpolated on SE(3) between waypoints against straight chords of 2 mm.
  DOUBLES_EQUAL(0.0, d.max_mm, 0.02);
  DOUBLES_EQUAL(0.0, d.max_rad, 1e-3);
  CHECK(d.line_max_mm < 0.1);
}

TEST(Track, OffsetAcrossTheAxisShowsInBothMeasures) {
  SE3 change = SE3::Identity();
  change.translation().z() = 0.3;  // along the tool, across the way
  const TrackDeviation d = deviation(path, track(change));
  DOUBLES_EQUAL(0.3, d.mean_mm, 0.02);
  DOUBLES_EQUAL(0.3, d.line_mean_mm, 0.05);
  DOUBLES_EQUAL(0.3, d.p95_mm, 0.02);
  CHECK(d.line_p95_mm >= d.line_mean_mm - 0.05 && d.line_p95_mm <= d.line_max_mm);
  DOUBLES_EQUAL(0.0, d.max_rad, 1e-3);
}

TEST(Track, TurnOfTheToolShowsAsAngle) {
  SE3 change = SE3::Identity();
  change.linear() = Eigen::AngleAxisd(0.01, Vec3::UnitZ()).toRotationMatrix();
  DOUBLES_EQUAL(0.01, deviation(path, track(change)).max_rad, 1e-3);
}

TEST(Track, StretchesBetweenZonesAndTheirSecondPassesAreAllCovered) {
  path::PlanRequest asked = robot::test::plan_request("grind.yaml");
  asked.line = test::made_line({.taper = 0.15});
  asked.process.zones = {{.name = "heel", .where = Zone::Where::Heel, .left_out = true},
                         {.name = "toe", .where = Zone::Where::Toe, .passes = 2}};
  const PlanOutcome outcome = plan(asked);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  checked = *outcome.path;
  const std::vector<TrackSample> whole = track(SE3::Identity());
  const TrackDeviation d = deviation(path, whole);
  CHECK(d.completed);
  DOUBLES_EQUAL(1.0, d.covered, 1e-12);
  DOUBLES_EQUAL(0.0, d.max_mm, 0.02);
  // Without the second pass the job is not done.
  std::vector<TrackSample> once = whole;
  const auto travel =
      std::ranges::find_if(path.waypoints, [](const Waypoint& w) { return w.segment == Segment::Travel; });
  once.resize(2 * static_cast<std::size_t>(travel - path.waypoints.begin()));
  const TrackDeviation less = deviation(path, once);
  CHECK_FALSE(less.completed);
  CHECK(less.covered < 0.95);
}

TEST(Track, HalfAPathIsNotCompleted) {
  std::vector<TrackSample> half = track(SE3::Identity());
  half.resize(half.size() / 2);
  const TrackDeviation d = deviation(path, half);
  CHECK_FALSE(d.completed);
  CHECK(d.covered > 0.3 && d.covered < 0.7);
}

}  // namespace biteline::path
