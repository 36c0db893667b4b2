// SPDX-License-Identifier: MIT
// The film that a program's flow lays, cycle by cycle in the simulated controller's made time.
#include "host/robot/link/ur/flow_script.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hal/sim/glue/film.hpp"
#include "hal/sim/robot/program_watch.hpp"
#include "host/robot/link/ur/script.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::ur {
namespace {

constexpr double k_step_s = 0.002;

/// Round the toe slower than elsewhere, as its turns ask for.
path::PlanRequest request() {
  path::PlanRequest asked = test::plan_request("spray.yaml");
  path::Process& process = asked.process;
  process.flow = path::Flow{.gun_on_s = 0.04,
                            .gun_off_s = 0.025,
                            .film_overlap_mm = 2,
                            .analog_output = 1,
                            .full_mm_s = process.motion.speed_mm_s,
                            .lag_s = 0.03};
  process.motion.cross_acceleration_mm_s2 = 100;
  return asked;
}

const path::CheckedPath& planned() {
  static const path::PlanOutcome outcome = path::plan(request());
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  return *outcome.path;
}

// A cycle's way is 2 % of it.
constexpr double k_bin_mm = 10;

struct Film {
  std::vector<double> per_mm;       ///< of each 10 mm of the line's film, of nominal
  double begin_mm{1e9}, end_mm{0};  ///< of the spot's way since the gun was asked for
  double least_mm_s{1e9};
};

Film film_of(const sim::GunFacts& gun) {
  const path::PlannedPath& path = planned().path();
  sim::Script script = *sim::parse_script(urscript(planned()));
  const auto arm = sim::ArmKinematics::named("ur5e");
  const sim::JointVector from_rad = path.waypoints.front().q_rad;
  script.start_rad = from_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(from_rad), SE3::Identity()));
  const sim::FilmTool tool{.standoff_mm = path.standoff_mm,
                           .digital_output = path.digital_output,
                           .analog_output = 1,
                           .full_mm_s = path.flow->full_mm_s,
                           .gun = gun};

  Film film;
  film.per_mm.assign(400, 0.0);
  double way_mm = 0;
  bool begun = false;
  for (const sim::FilmStep& step : sim::lay_film(program, tool, k_step_s)) {
    begun = begun || step.gun_wanted;
    if (!begun) continue;
    if (step.film_mm > 0.5 * step.way_mm && step.film_mm > 0) {
      film.begin_mm = std::min(film.begin_mm, way_mm);
      film.end_mm = way_mm + step.way_mm;
      if (way_mm > 20) film.least_mm_s = std::min(film.least_mm_s, step.way_mm / k_step_s);
    }
    film.per_mm[std::min<std::size_t>(399, static_cast<std::size_t>(way_mm / k_bin_mm))] +=
        step.film_mm / k_bin_mm;
    way_mm += step.way_mm;
  }
  return film;
}

FilmEnd wanted_end() {
  const path::PlannedPath& path = planned().path();
  return film_end(path, path::runs_of(path, path::Segment::Line).front(), true);
}

}  // namespace

TEST_GROUP(FlowScript){};

/// The closing film reaches so far over its own beginning, measured along the line.
TEST(FlowScript, FilmEndsWhereItHasComeOverItsBeginning) {
  const path::PlannedPath& path = planned().path();
  const path::PathRun run = path::runs_of(path, path::Segment::Line).front();
  const auto spot = [&](std::size_t i) {
    const SE3& T = path.waypoints[i].T_base_tcp;
    return Vec3{T.translation() + path.standoff_mm * T.linear().col(2)};
  };
  // The tip's spot lies on a parallel of the line: the same share longer or shorter, some per cent.
  DOUBLES_EQUAL(2, (wanted_end().spot_base - spot(run.first)).norm(), 0.4);
  const FilmEnd whole = film_end(path, run, false);
  DOUBLES_EQUAL(0, (whole.spot_base - spot(run.last)).norm(), 1e-9);
  DOUBLES_EQUAL(8, whole.way_mm - wanted_end().way_mm, 0.5);
}

/// A metered pump and a program that knows its lag: each 10 mm have their film, whatever the speed.
TEST(FlowScript, FilmIsEvenWhereTheSpeedIsNot) {
  const Film film = film_of({.opens_s = 0.04, .closes_s = 0.025, .pump_lag_s = 0.03});
  CHECK(film.least_mm_s < 0.7 * request().process.motion.speed_mm_s);
  const double end_mm = wanted_end().way_mm;
  // The first and the last bin are the ends' own.  A bead's width goes with the root: 4 % is 0.2 mm of 10 mm.
  for (std::size_t i = 1; i < static_cast<std::size_t>(end_mm / k_bin_mm) - 1; ++i)
    DOUBLES_EQUAL_TEXT(1, film.per_mm[i], 0.04, std::to_string(i).c_str());
  DOUBLES_EQUAL(0, film.begin_mm, 0.5);
  // Three cycles' way: the word, the needle and the look each come at a cycle's end.
  DOUBLES_EQUAL(end_mm, film.end_mm, 0.75);
}

/// What the delays are for: a gun slower than told begins late and ends late by its way in that time.
TEST(FlowScript, AGunThatIsSlowerThanToldIsSeenAtTheEnds) {
  const Film film = film_of({.opens_s = 0.24, .closes_s = 0.125, .pump_lag_s = 0.03});
  CHECK(film.begin_mm > 2);
  CHECK(film.end_mm > wanted_end().way_mm + 1);
}

/// A slider at nothing: the gun closes while the tool stands, and opens again when it goes on.
TEST(FlowScript, NothingFlowsWhileTheToolStands) {
  const std::string text = urscript(planned());
  CHECK(text.find("speed < 0.0005000") != std::string::npos);
  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
  sim::Arm arm{kinematics, sim::JointVector{planned().path().waypoints.front().q_rad}};
  sim::ProgramWatch watch{arm, k_step_s};
  struct NoInputs final : sim::RtdeInputs {
    int input_register(int) const override { return 0; }
    std::optional<SensorClock::time_point> written(const std::string&) const override { return {}; }
  } inputs;
  const SensorClock::time_point begin{Nanoseconds{1'000'000'000}};
  arm.run(*sim::parse_script(text), begin);
  const auto bit = static_cast<unsigned>(planned().path().digital_output);
  bool flowed = false, stood_open = false, goes_on = false;
  std::optional<double> stands_s;
  for (int i = 0; i < 20000; ++i) {
    const double time_s = i * k_step_s;
    const SensorClock::time_point now = begin + Nanoseconds{static_cast<std::int64_t>(time_s * 1e9)};
    CHECK(watch.step(now, inputs).empty());
    const sim::ArmState state = arm.at(now);
    const bool open = ((state.outputs >> bit) & 1U) != 0;
    if (!flowed && open && state.analog_ratio[1] > 0.5) {
      flowed = true;
      stands_s = time_s;
      arm.set_speed(0, now);
    }
    if (stands_s && time_s > *stands_s + 0.01 && time_s < *stands_s + 2)
      stood_open = stood_open || open || state.analog_ratio[1] > 0;
    if (stands_s && std::abs(time_s - *stands_s - 2) < k_step_s / 2) arm.set_speed(1, now);
    if (stands_s && time_s > *stands_s + 2.01) goes_on = goes_on || (open && state.analog_ratio[1] > 0.5);
  }
  CHECK(flowed);
  CHECK_FALSE(stood_open);
  CHECK(goes_on);
}

/// In the air nothing flows at all, and a watched program's last word is for both outputs.
TEST(FlowScript, NothingFlowsInTheAirAndTheDeadManClosesBoth) {
  path::PlanRequest air = request();
  air.tool_off = true;
  const path::PlanOutcome outcome = path::plan(air);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const std::string dry = urscript(*outcome.path, 47);
  CHECK(dry.find("True)") == std::string::npos);
  CHECK(dry.find("biteline_flow") == std::string::npos);
  const std::string wet = urscript(planned(), 47);
  CHECK(wet.find("    set_standard_digital_out(2, False)\n    set_standard_analog_out(1, 0)\n    sync()\n    "
                 "halt") != std::string::npos);
}

/// A piece of rework is shorter than the way from whose end on a run's end is looked for.
TEST(FlowScript, AShortPieceGetsItsFilmFromEndToEnd) {
  path::PlanRequest piece = request();
  piece.process.only = {{.from_mm = 100, .to_mm = 104}};
  const path::PlanOutcome outcome = path::plan(piece);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const path::PlannedPath& path = outcome.path->path();
  sim::Script script = *sim::parse_script(urscript(*outcome.path));
  const auto arm = sim::ArmKinematics::named("ur5e");
  script.start_rad = path.waypoints.front().q_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(*script.start_rad), SE3::Identity()));
  const sim::FilmTool tool{.standoff_mm = path.standoff_mm,
                           .digital_output = path.digital_output,
                           .analog_output = 1,
                           .full_mm_s = path.flow->full_mm_s,
                           .gun = {.opens_s = 0.04, .closes_s = 0.025, .pump_lag_s = 0.03}};
  double way_mm = 0, film_mm = 0;
  for (const sim::FilmStep& step : sim::lay_film(program, tool, k_step_s)) {
    if (step.film_mm > 0) way_mm += step.way_mm;
    film_mm += step.film_mm;
  }
  DOUBLES_EQUAL(4, way_mm, 0.4);
  DOUBLES_EQUAL(4, film_mm, 0.4);
}

/// Beside the shoe, and between there and the line nothing.
TEST(FlowScript, APurgeFallsBesideTheShoeBeforeTheLine) {
  const Vec3 at{420, 260, 200};
  path::PlanRequest purged = request();
  purged.process.flow->purge_s = 0.5;
  purged.process.flow->purge_at_base = at;
  purged.from_rad = planned().path().waypoints.back().q_rad;
  const path::PlanOutcome outcome = path::plan(purged);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const path::PlannedPath& path = outcome.path->path();
  CHECK(path.purge_via.has_value());
  sim::Script script = *sim::parse_script(urscript(*outcome.path, 47));
  const auto arm = sim::ArmKinematics::named("ur5e");
  script.start_rad = *purged.from_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(*purged.from_rad), SE3::Identity()));
  const sim::FilmTool tool{.digital_output = path.digital_output,
                           .analog_output = 1,
                           .full_mm_s = path.flow->full_mm_s,
                           .gun = {.opens_s = 0.04, .closes_s = 0.025, .pump_lag_s = 0.03}};
  double purged_s = 0, line_s = 0;
  bool on_line = false;
  for (const sim::FilmStep& step : sim::lay_film(program, tool, k_step_s)) {
    if (!(step.film_mm > 0)) continue;
    const bool there = (step.spot_base - at).norm() < 1;
    CHECK_TEXT(!there || !on_line, "the purge comes before the line");
    on_line = on_line || !there;
    (there ? purged_s : line_s) += k_step_s;
    // Of the tip, which stands off.
    if (!there) {
      double nearest_mm = 1e9;
      for (const path::Waypoint& w : path.waypoints)
        if (w.segment == path::Segment::Line)
          nearest_mm = std::min(nearest_mm, (w.T_base_tcp.translation() - step.spot_base).norm());
      CHECK(nearest_mm < 3);
    }
  }
  DOUBLES_EQUAL(0.5 - 0.04 + 0.025, purged_s, 0.01);
  CHECK(line_s > 3);
}

TEST(FlowScript, WithoutAWayThereOrInTheAirNothingIsPurged) {
  path::PlanRequest purged = request();
  purged.process.flow->purge_s = 0.5;
  purged.process.flow->purge_at_base = {420, 260, 200};
  const path::PlanOutcome unknown = path::plan(purged);
  CHECK_TEXT(unknown.path.has_value(), unknown.reason().c_str());
  CHECK(urscript(*unknown.path).find("sleep(0.5") == std::string::npos);
  purged.from_rad = planned().path().waypoints.back().q_rad;
  purged.tool_off = true;
  const path::PlanOutcome air = path::plan(purged);
  CHECK_TEXT(air.path.has_value(), air.reason().c_str());
  CHECK(urscript(*air.path).find("sleep(") == std::string::npos);
}

}  // namespace biteline::robot::ur
