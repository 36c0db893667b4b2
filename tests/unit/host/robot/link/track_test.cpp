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

TEST(Track, EachPartsTimeIsThatOfThePlan) {
  std::vector<TrackSample> samples;
  constexpr double k_way_there_s = 1.5;
  SE3 T_before = path.waypoints.front().T_base_tcp;
  T_before.pretranslate(Vec3{0, 0, 100});
  for (double time_s = 0; time_s < k_way_there_s; time_s += 0.1)
    samples.push_back({.time_s = time_s, .T_base_tcp = T_before});
  double begin_s = -1, come_on_s = -1, end_s = 0;
  for (const Waypoint& w : path.waypoints) {
    samples.push_back({.time_s = k_way_there_s + w.time_s, .T_base_tcp = w.T_base_tcp});
    if (w.segment != Segment::Line) continue;
    if (begin_s >= 0 && come_on_s < 0) come_on_s = w.time_s;
    if (begin_s < 0) begin_s = w.time_s;
    end_s = w.time_s;
  }
  // As it stands at the end until the program is over.
  samples.push_back({.time_s = samples.back().time_s + 3, .T_base_tcp = samples.back().T_base_tcp});
  const PartTimes parts = deviation(path, samples).parts;
  // On the line is a tip that has come on along it, and each waypoint is a sample.
  constexpr double k_sample_s = 0.1;
  const double on_line_s = k_sample_s + come_on_s - begin_s;
  DOUBLES_EQUAL(k_way_there_s, parts.way_there_s, k_sample_s);
  DOUBLES_EQUAL(begin_s, parts.approach_s, on_line_s);
  DOUBLES_EQUAL(end_s - begin_s, parts.line_s, k_sample_s + on_line_s);
  DOUBLES_EQUAL(path.waypoints.back().time_s - end_s, parts.retreat_s, 2 * k_sample_s);
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
