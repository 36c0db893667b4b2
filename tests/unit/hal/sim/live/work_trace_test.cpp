// SPDX-License-Identifier: MIT
// A tool that goes along a made shoe's line, as the controller's cycles tell it.
#include "hal/sim/live/work_trace.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {
namespace {

constexpr double k_step_s = 0.002, k_speed_mm_s = 100, k_up_mm = 5, k_width_mm = 6;
/// A step of the tool, and a station.
constexpr double k_end_mm = k_speed_mm_s * k_step_s + WorkTrace::k_station_mm;

}  // namespace

TEST_GROUP(WorkTrace) {
  PlacedShoe placed{place_shoe({.shoe = draw_shoe(ShoeClass::Deep, 4101)})};
  WorkingTool tool{.work = Work::WetGlue, .digital_output = 2, .width_mm = k_width_mm, .gun = instant()};
  SensorClock::time_point now{};

  static GunFacts instant() {
    return {.opens_s = 0, .closes_s = 0, .metered = false};
  }
  /// Upright over the wall, `k_up_mm` above the line's nominal height.
  SE3 T_base_flange_at(double s_mm) const {
    const Section section = placed.shoe.section(s_mm);
    const Vec3 place = section.point(section.line_height_mm() + k_up_mm);
    return placed.T_base_shoe * geometry::make_se3(Eigen::Quaterniond::Identity(), place);
  }
  void rest(WorkTrace & trace) const {
    trace.step({}, T_base_flange_at(0), k_step_s);
  }
  /// With the output on from `from_mm` to `to_mm`; one program.
  void run(WorkTrace & trace, double from_mm, double to_mm) const {
    ArmState state{.moving = true, .program_running = true};
    trace.step(state, T_base_flange_at(from_mm), k_step_s);
    state.outputs = 1U << 2U;
    for (double s = from_mm; s <= to_mm; s += k_speed_mm_s * k_step_s)
      trace.step(state, T_base_flange_at(s), k_step_s);
    rest(trace);
  }
  static double layers(const MadeShoe& shoe, double s_mm, double above_mm = k_up_mm) {
    return band_at(*shoe.parameters().worked, s_mm).layers_at(shoe.section(s_mm).line_height_mm() + above_mm);
  }
};

TEST(WorkTrace, FilmLiesWhereTheOutputWasOnAndNowhereElse) {
  WorkTrace sut{placed, tool};
  CHECK(!sut.due());
  run(sut, 100, 160);
  CHECK(sut.due());
  const MadeShoe worked = sut.lay();
  CHECK(!sut.due());
  for (const double s_mm : {100 + k_end_mm, 130.0, 160 - k_end_mm})
    DOUBLES_EQUAL(1, layers(worked, s_mm), 1e-6);
  for (const double s_mm : {0.0, 100 - k_end_mm, 160 + k_end_mm, 400.0})
    DOUBLES_EQUAL(0, layers(worked, s_mm), 1e-6);
  // As wide as the tool: the wall leans by no more than a third here.
  DOUBLES_EQUAL(1, layers(worked, 130, k_up_mm + 0.4 * k_width_mm), 1e-6);
  DOUBLES_EQUAL(0, layers(worked, 130, k_up_mm + 0.6 * k_width_mm), 1e-6);
  DOUBLES_EQUAL(0, layers(worked, 130, k_up_mm - 0.6 * k_width_mm), 1e-6);
  const double film_mm = draw_film(tool.work, tool.film_seed).height_mm;
  const double z_mm = worked.section(130).line_height_mm() + k_up_mm;
  DOUBLES_EQUAL(film_mm, worked.section(130).offset_mm(z_mm) - placed.shoe.section(130).offset_mm(z_mm),
                1e-9);
}

TEST(WorkTrace, AProgramThatSwitchesNothingOnLeavesNothing) {
  WorkTrace sut{placed, tool};
  const ArmState other{.moving = true, .program_running = true, .outputs = 1U << 3U};
  for (double s = 100; s < 120; s += 1) sut.step(other, T_base_flange_at(s), k_step_s);
  rest(sut);
  CHECK(!sut.due());
}

TEST(WorkTrace, AToolFarFromTheShoeLeavesNothing) {
  WorkTrace sut{placed, tool};
  ArmState state{.moving = true, .program_running = true, .outputs = 1U << 2U};
  for (double s = 100; s < 120; s += 1) {
    SE3 T = T_base_flange_at(s);
    T.translation().z() += 100;
    sut.step(state, T, k_step_s);
  }
  rest(sut);
  const MadeShoe worked = sut.lay();
  for (double s = 0; s < worked.perimeter_mm(); s += 5) DOUBLES_EQUAL(0, layers(worked, s), 1e-6);
}

TEST(WorkTrace, AGapIsWorkedByALaterProgramAndTwiceIsTwoLayers) {
  tool.gap = OutlinePart{.from_s_mm = 120, .length_mm = 10};
  WorkTrace sut{placed, tool};
  run(sut, 100, 160);
  const MadeShoe first = sut.lay();
  DOUBLES_EQUAL(0, layers(first, 125), 1e-6);
  DOUBLES_EQUAL(1, layers(first, 120 - k_end_mm), 1e-6);
  DOUBLES_EQUAL(1, layers(first, 130 + k_end_mm), 1e-6);
  run(sut, 119, 131);
  const MadeShoe second = sut.lay();
  DOUBLES_EQUAL(1, layers(second, 125), 1e-6);
  DOUBLES_EQUAL(2, layers(second, 119.5), 1e-6);
  DOUBLES_EQUAL(2, layers(second, 130.5), 1e-6);
  DOUBLES_EQUAL(1, layers(second, 140), 1e-6);
}

TEST(WorkTrace, ALateGunLeavesItsFilmSoMuchFartherOn) {
  tool.gun.opens_s = 0.1;
  tool.gun.closes_s = 0.05;
  WorkTrace sut{placed, tool};
  ArmState state{.moving = true, .program_running = true};
  for (double s = 100; s < 160; s += k_speed_mm_s * k_step_s) {
    state.outputs = s < 140 ? 1U << 2U : 0;
    sut.step(state, T_base_flange_at(s), k_step_s);
  }
  rest(sut);
  const MadeShoe worked = sut.lay();
  DOUBLES_EQUAL(0, layers(worked, 110 - 2 * k_end_mm), 1e-6);
  DOUBLES_EQUAL(1, layers(worked, 110 + 2 * k_end_mm), 1e-6);
  DOUBLES_EQUAL(1, layers(worked, 145 - 2 * k_end_mm), 1e-6);
  DOUBLES_EQUAL(0, layers(worked, 145 + 2 * k_end_mm), 1e-6);
}

}  // namespace biteline::sim
