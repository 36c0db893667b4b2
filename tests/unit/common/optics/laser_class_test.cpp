// SPDX-License-Identifier: MIT
// Worked by hand with the limits of IEC 60825-1:2014, tables 3, 5, 6, 8 and 9.
#include "common/optics/laser_class.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <numbers>

namespace biteline::optics {
namespace {

constexpr double k_right_angle = std::numbers::pi / 2, k_sixty_degrees = std::numbers::pi / 3;

/// All of it goes through both openings.
LineLaser spot(double power_mw, double wavelength_nm = 660) {
  return {.power_mw = power_mw, .wavelength_nm = wavelength_nm, .fan_rad = 0};
}

const char* class_of(const LineLaser& laser, const Emission& emission = k_continuous) {
  return name_of(judge(laser, emission).laser_class);
}

}  // namespace

TEST_GROUP(LaserClass){};

TEST(LaserClass, AFanSendsTheOpeningsShareThroughIt) {
  // 90 degrees: a line of 200 mm at 100 mm and of 4000 mm at 2000 mm.
  const LineLaser laser{.power_mw = 20, .fan_rad = k_right_angle};
  DOUBLES_EQUAL(20 * 7 / 200.0, through_mw(laser, k_condition_3), 1e-9);
  DOUBLES_EQUAL(20 * 50 / 4000.0, through_mw(laser, k_condition_1), 1e-9);
  LineLaser uneven = laser;
  uneven.peak_ratio = 1.5;
  DOUBLES_EQUAL(1.5 * 0.7, through_mw(uneven, k_condition_3), 1e-9);
  uneven.peak_ratio = 1000;
  DOUBLES_EQUAL(20, through_mw(uneven, k_condition_3), 1e-9);
  LineLaser deep = laser;
  deep.nearest_mm = 200;  // nobody comes nearer
  DOUBLES_EQUAL(20 * 7 / 400.0, through_mw(deep, k_condition_3), 1e-9);
  deep.nearest_mm = 20;
  DOUBLES_EQUAL(0.7, through_mw(deep, k_condition_3), 1e-9);
}

TEST(LaserClass, ContinuousRedLightHasItsFourLimits) {
  // 0.39 mW in 100 s; 1 mW and 5 mW in 0.25 s; 500 mW.
  STRCMP_EQUAL("1", class_of(spot(0.389)));
  STRCMP_EQUAL("2", class_of(spot(0.391)));
  STRCMP_EQUAL("2", class_of(spot(0.999)));
  STRCMP_EQUAL("3R", class_of(spot(1.001)));
  STRCMP_EQUAL("3R", class_of(spot(4.999)));
  STRCMP_EQUAL("3B", class_of(spot(5.001)));
  STRCMP_EQUAL("3B", class_of(spot(499)));
  STRCMP_EQUAL("4", class_of(spot(501)));
  DOUBLES_EQUAL(0.5 / 0.39, judge(spot(0.5), k_continuous).one.share, 1e-9);
  CHECK(judge(spot(0.5), k_continuous).one.rule == LaserRule::SinglePulse);
}

TEST(LaserClass, ContinuousLightOfALine) {
  LineLaser laser{.power_mw = 5, .fan_rad = k_right_angle};
  STRCMP_EQUAL("1", class_of(laser));  // 0.175 mW
  laser.power_mw = 20;
  STRCMP_EQUAL("2", class_of(laser));  // 0.7 mW
  laser.power_mw = 100;
  STRCMP_EQUAL("3R", class_of(laser));  // 3.5 mW
  laser.power_mw = 200;
  STRCMP_EQUAL("3B", class_of(laser));  // 7 mW
}

TEST(LaserClass, BlueLightIsBoundByItsChemistry) {
  // 3.9 mJ in 100 s with C3 = 1 up to 450 nm: 39 uW.  At 480 nm C3 = 10^0.6 = 3.981: 155 uW.
  STRCMP_EQUAL("1", class_of(spot(0.0389, 450)));
  STRCMP_EQUAL("2", class_of(spot(0.0391, 450)));
  CHECK(judge(spot(0.1, 450), k_continuous).one.rule == LaserRule::Photochemical);
  DOUBLES_EQUAL(0.1 / 0.039, judge(spot(0.1, 450), k_continuous).one.share, 1e-9);
  DOUBLES_EQUAL(0.1 / (0.039 * 3.9810717), judge(spot(0.1, 480), k_continuous).one.share, 1e-6);
  // From 500 nm on heat is stricter or the same.
  DOUBLES_EQUAL(0.1 / 0.39, judge(spot(0.1, 520), k_continuous).one.share, 1e-9);
}

TEST(LaserClass, InvisibleLightHasNoClassTwo) {
  // 808 nm: C4 = 10^0.216 = 1.6444; class 1 to 0.6413 mW, 3R to 2 mW * C4 = 3.289 mW.
  STRCMP_EQUAL("1", class_of(spot(0.641, 808)));
  STRCMP_EQUAL("3R", class_of(spot(0.642, 808)));
  STRCMP_EQUAL("3R", class_of(spot(3.28, 808)));
  STRCMP_EQUAL("3B", class_of(spot(3.30, 808)));
  DOUBLES_EQUAL(0, judge(spot(1, 808), k_continuous).two.share, 0);
}

TEST(LaserClass, AWideBeamIsWorseForBinoculars) {
  // 20 mm wide and parallel: 7 of 20 mm enter an eye, all of it binoculars.
  LineLaser beam{.power_mw = 1, .fan_rad = 0, .width_mm = 20};
  const LaserJudgement judgement = judge(beam, k_continuous);
  DOUBLES_EQUAL(0.35, judgement.eye_mw, 1e-9);
  DOUBLES_EQUAL(1, judgement.binoculars_mw, 1e-9);
  STRCMP_EQUAL("1M", name_of(judgement.laser_class));
  beam.power_mw = 2;  // 0.7 mW and 2 mW
  STRCMP_EQUAL("2M", class_of(beam));
  beam.power_mw = 600;
  STRCMP_EQUAL("4", class_of(beam));
}

// 100 mW in a fan of 60 degrees: 115.47 mm at 100 mm, 6.0622 mW through 7 mm.  100 pulses of 0.1 ms a second.
TEST(LaserClass, AStrobeMakesClassOneOfWhatIsThreeBWithoutIt) {
  const LineLaser laser{.power_mw = 100, .fan_rad = k_sixty_degrees};
  const Emission strobe{.length_s = 1e-4, .rate_hz = 100};
  const LaserJudgement lit = judge(laser, strobe);
  // A pulse: 0.60622 uJ of 7e-4 * (1e-4)^0.75 = 0.7 uJ.  Mean: 60.6 uW of 390 uW.
  DOUBLES_EQUAL(0.60622 / 0.7, lit.one.share, 1e-5);
  CHECK(lit.one.rule == LaserRule::SinglePulse);
  STRCMP_EQUAL("1", name_of(lit.laser_class));
  STRCMP_EQUAL("3B", class_of(laser));
  // Stuck on for the guard's 100 ms: 0.60622 mJ of 3.5e-3 * 0.1^0.75 = 0.62240 mJ.
  const LaserJudgement stuck = judge(laser, {.length_s = 0.1});
  DOUBLES_EQUAL(0.60622 / 0.62240, stuck.three_r.share, 1e-4);
  STRCMP_EQUAL("3R", name_of(stuck.laser_class));
}

TEST(LaserClass, ManyPulsesAreBoundByTheirMean) {
  // 20 mW, pulses of 0.4 ms at 100 a second: 8 uJ of 7e-4 * (4e-4)^0.75 = 1.980 uJ; a mean of 0.8 mW is less.
  const Emission strobe{.length_s = 4e-4, .rate_hz = 100};
  DOUBLES_EQUAL(8 / 1.97990, judge(spot(20), strobe).one.share, 1e-4);
  // 2000 a second of 0.3 ms are 60 %: 0.6 mW of 0.39 mW, a pulse 0.3 uJ of 1.596 uJ.
  const LaserJudgement dense = judge(spot(1), {.length_s = 3e-4, .rate_hz = 2000});
  DOUBLES_EQUAL(0.6 / 0.39, dense.one.share, 1e-9);
  CHECK(dense.one.rule == LaserRule::MeanPower);
  // In 0.25 s it is 500 pulses, 0.15 mJ of 0.25 mJ.
  DOUBLES_EQUAL(0.6, dense.two.share, 1e-9);
}

TEST(LaserClass, ShortPulsesAreBoundByTheirNumber) {
  // 2 us at 1000 a second: 10 000 in T2 = 10 s, C5 = 5 / 10 = 0.5; 7.7e-8 J.
  const Emission train{.length_s = 2e-6, .rate_hz = 1000};
  const LaserJudgement judgement = judge(spot(10), train);
  DOUBLES_EQUAL(2e-8 / (7.7e-8 * 0.5), judgement.one.share, 1e-9);
  CHECK(judgement.one.rule == LaserRule::PulseTrain);
  // 60 a second: 600 in 10 s, C5 = 1.  61: 610, no more than 1.  200: 2000, 5 / 6.6874 = 0.74767.
  DOUBLES_EQUAL(2e-8 / 7.7e-8, judge(spot(10), {.length_s = 2e-6, .rate_hz = 61}).one.share, 1e-9);
  DOUBLES_EQUAL(2e-8 / (7.7e-8 * 0.74767), judge(spot(10), {.length_s = 2e-6, .rate_hz = 200}).one.share,
                1e-5);
  DOUBLES_EQUAL(2e-8 / 7.7e-8, judge(spot(10), {.length_s = 2e-6, .rate_hz = 60}).one.share, 1e-9);
  // 50 000: 0.4 against a mean of 1 mW, which is stricter.
  const LaserJudgement dense = judge(spot(10), {.length_s = 2e-6, .rate_hz = 50'000});
  DOUBLES_EQUAL(1 / 0.39, dense.one.share, 1e-9);
  // Class 2 looks at 0.25 s alone: no C5.
  DOUBLES_EQUAL(2e-8 / 7.7e-8, judgement.two.share, 1e-9);
}

TEST(LaserClass, MoreLightIsNeverOfALowerClass) {
  for (const double wavelength_nm : {405.0, 450.0, 520.0, 660.0, 808.0, 940.0}) {
    for (const Emission& emission : {k_continuous, Emission{.length_s = 1e-3, .rate_hz = 100},
                                     Emission{.length_s = 2e-6, .rate_hz = 5000}}) {
      int before = 0;
      for (double power_mw = 0.01; power_mw < 1e5; power_mw *= 1.3) {
        const int now = static_cast<int>(judge(spot(power_mw, wavelength_nm), emission).laser_class);
        CHECK(now >= before);
        before = now;
      }
      LONGS_EQUAL(static_cast<int>(LaserClass::Four), before);
    }
  }
}

}  // namespace biteline::optics
