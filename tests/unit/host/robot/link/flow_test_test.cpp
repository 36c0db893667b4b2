// SPDX-License-Identifier: MIT
// The test line's strokes, laid by the simulated controller with guns that nobody told of, and what the films
// tell of them.
#include "host/robot/path/flow_test.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hal/sim/glue/film.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "tests/support/errors.hpp"

namespace biteline::robot::ur {
namespace {

constexpr double k_cycle_s = 0.002;

path::PlanRequest plate_request(const char* name) {
  path::PlanRequest asked{.line = {},
                          .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / name),
                          .arm = *kinematics::arm_model("UR10e"),
                          .table_z_mm = 0,
                          .shoe = {},
                          .cloud = {}};
  asked.process.flow = path::Flow{.analog_output = 0, .full_mm_s = 1.25 * asked.process.motion.speed_mm_s};
  SUCCEEDS(path::ask_for_flow_test(asked, {.middle = {650, 0, 80}, .turn_rad = 1.57}));
  return asked;
}

const path::CheckedPath& plate_path(const char* name) {
  static const path::PlanOutcome spray = path::plan(plate_request("spray.yaml"));
  static const path::PlanOutcome cement = path::plan(plate_request("cement.yaml"));
  const path::PlanOutcome& outcome = std::string{name} == "spray.yaml" ? spray : cement;
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  return *outcome.path;
}

/// One stroke's film, in bins along it.
struct LaidFilm {
  static constexpr double k_bin_mm = 0.5;
  std::vector<double> per_mm = std::vector<double>(2000, 0.0);
  double begin_mm{1e9}, end_mm{0};
  std::vector<double> way_mm = std::vector<double>(2000, 0.0);
};

/// As whoever holds a ruler sees it: film behind the marks.
std::vector<path::MeasuredStroke> measured(const path::CheckedPath& checked, const sim::GunFacts& gun) {
  const path::PlannedPath& path = checked.path();
  sim::Script script = *sim::parse_script(urscript(checked));
  const auto arm = sim::ArmKinematics::named("ur10e");
  script.start_rad = path.waypoints.front().q_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, *arm, arm->T_base_flange(*script.start_rad), SE3::Identity()));
  const std::vector<path::FlowStroke> strokes = path::flow_strokes(path);
  std::vector<LaidFilm> films(strokes.size());
  for (const sim::FilmStep& step : sim::lay_film(program,
                                                 {.standoff_mm = path.standoff_mm,
                                                 .digital_output = path.digital_output,
                                                 .analog_output = 0,
                                                 .full_mm_s = path.flow->full_mm_s,
                                                 .gun = gun},
                                                 k_cycle_s)) {
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const Vec3 way = strokes[i].ends_base - strokes[i].begins_base;
      const Vec3 off = step.spot_base - strokes[i].begins_base;
      const double mm = off.dot(way.normalized());
      const bool here =
          (off - mm * way.normalized()).norm() < 1 && mm > -1 && mm < way.norm() + path.flow->dry_end_mm;
      if (!here || step.film_mm <= 0 || step.way_mm <= 0) continue;
      films[i].begin_mm = std::min(films[i].begin_mm, mm - step.way_mm);
      films[i].end_mm = std::max(films[i].end_mm, mm);
      const auto bin = static_cast<std::size_t>(std::max(0.0, mm) / LaidFilm::k_bin_mm);
      films[i].per_mm[bin] += step.film_mm;
      films[i].way_mm[bin] += step.way_mm;
    }
  }
  std::vector<path::MeasuredStroke> out;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const double length_mm = (strokes[i].ends_base - strokes[i].begins_base).norm();
    path::MeasuredStroke stroke{.begin_mm = films[i].begin_mm, .end_mm = films[i].end_mm - length_mm};
    if (strokes[i].step_mm) {
      const auto first = static_cast<std::size_t>(*strokes[i].step_mm / 2 / LaidFilm::k_bin_mm),
                 end = static_cast<std::size_t>(length_mm / LaidFilm::k_bin_mm);
      double widest = 0;
      for (std::size_t k = first; k < end; ++k)
        widest = std::max(widest, films[i].per_mm[k] / std::max(1e-9, films[i].way_mm[k]));
      stroke.widest_ratio = std::sqrt(widest);
    }
    out.push_back(stroke);
  }
  return out;
}

}  // namespace

TEST_GROUP(FlowTest){};

TEST(FlowTest, FourStrokesTwoEachWayAreLaidAtTheirSpeeds) {
  const path::PlannedPath& path = plate_path("spray.yaml").path();
  const std::vector<path::FlowStroke> strokes = path::flow_strokes(path);
  LONGS_EQUAL(4, strokes.size());
  std::vector<double> speeds;
  for (const path::FlowStroke& stroke : strokes) {
    speeds.push_back(stroke.speed_mm_s / path.motion.speed_mm_s);
    DOUBLES_EQUAL(80, stroke.begins_base.z(), 0.1);
  }
  std::ranges::sort(speeds);
  DOUBLES_EQUAL(0.4, speeds[0], 0.01);
  DOUBLES_EQUAL(0.4, speeds[1], 0.01);
  DOUBLES_EQUAL(0.7, speeds[2], 0.02);
  DOUBLES_EQUAL(1.0, speeds[3], 0.02);
  LONGS_EQUAL(1, std::ranges::count_if(strokes, [](const auto& s) { return s.step_mm.has_value(); }));
}

/// Guns of three kinds, whose delays nobody told: found again as a ruler shows them.
TEST(FlowTest, TheFilmsTellTheDelays) {
  for (const char* name : {"spray.yaml", "cement.yaml"}) {
    for (const sim::GunFacts& gun : {sim::GunFacts{.opens_s = 0.04, .closes_s = 0.025, .pump_lag_s = 0.03},
                                     sim::GunFacts{.opens_s = 0.09, .closes_s = 0.06, .pump_lag_s = 0.08},
                                     sim::GunFacts{.opens_s = 0.02, .closes_s = 0.01, .pump_lag_s = 0.05}}) {
      const auto fit = path::fit_flow(plate_path(name).path(), measured(plate_path(name), gun));
      SUCCEEDS(fit);
      // A cycle or two each: the word, the needle and the look come at a cycle's end.
      DOUBLES_EQUAL(gun.closes_s, fit->gun_off_s, 0.004);
      // The tip's ramp is the plan's, and the controller makes its own.
      DOUBLES_EQUAL(gun.opens_s, fit->gun_on_s, 0.003 + 0.15 * gun.opens_s);
      DOUBLES_EQUAL(gun.pump_lag_s, fit->lag_s.value_or(0), 0.003 + 0.1 * gun.pump_lag_s);
      CHECK(fit->rms_mm < 0.2);
    }
  }
}

/// Strokes the other way tell it.
TEST(FlowTest, APlateThatLiesOffIsFound) {
  const path::CheckedPath& path = plate_path("spray.yaml");
  std::vector<path::MeasuredStroke> strokes =
      measured(path, {.opens_s = 0.04, .closes_s = 0.025, .pump_lag_s = 0.03});
  const auto straight = path::fit_flow(path.path(), strokes);
  const std::vector<path::FlowStroke> planned = path::flow_strokes(path.path());
  const Vec3 first = planned[0].ends_base - planned[0].begins_base;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const double mm = first.dot(planned[i].ends_base - planned[i].begins_base) > 0 ? 0.8 : -0.8;
    strokes[i].begin_mm += mm;
    strokes[i].end_mm += mm;
  }
  const auto shifted = path::fit_flow(path.path(), strokes);
  SUCCEEDS(shifted);
  DOUBLES_EQUAL(0.8, shifted->shift_mm - straight->shift_mm, 1e-6);
  DOUBLES_EQUAL(straight->gun_off_s, shifted->gun_off_s, 1e-6);
  DOUBLES_EQUAL(straight->gun_on_s, shifted->gun_on_s, 1e-4);
}

TEST(FlowTest, StrokesThatNobodyMeasuredAndEndsThatNoGunHasAreRefused) {
  const path::PlannedPath& path = plate_path("spray.yaml").path();
  CHECK(!path::fit_flow(path, std::vector<path::MeasuredStroke>(3)));
  CHECK(!path::fit_flow(path, std::vector<path::MeasuredStroke>(4, {.begin_mm = 0, .end_mm = 100})));
}

TEST(FlowTest, AProcessWithoutAnOutputIsRefused) {
  path::PlanRequest asked{
      .line = {},
      .process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "spray.yaml"),
      .arm = *kinematics::arm_model("UR10e"),
      .shoe = {},
      .cloud = {}};
  asked.process.digital_output = -1;
  CHECK(!path::ask_for_flow_test(asked, {}));
}

}  // namespace biteline::robot::ur
