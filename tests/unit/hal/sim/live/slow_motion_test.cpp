// SPDX-License-Identifier: MIT
#include "hal/sim/live/slow_motion.hpp"

#include <CppUTest/TestHarness.h>

#include <thread>

namespace biteline::sim {

using namespace std::chrono_literals;

TEST_GROUP(SlowMotion){};

TEST(SlowMotion, RealTimeWhereAPictureTakesHalfOfItsTimeAndLess) {
  DOUBLES_EQUAL(1, affordable_ratio(1ms, 10ms), 0);
  DOUBLES_EQUAL(1, affordable_ratio(5ms, 10ms), 1e-12);
  DOUBLES_EQUAL(1, affordable_ratio(0ms, 10ms), 0);
}

TEST(SlowMotion, SlowerInProportionElsewhere) {
  DOUBLES_EQUAL(0.4, affordable_ratio(12'500us, 10ms), 1e-12);
}

TEST(SlowMotion, NeverSoSlowThatTheLaserGuardTakesTheCameraForSilent) {
  DOUBLES_EQUAL(0.2, affordable_ratio(10s, 10ms), 1e-12);
  DOUBLES_EQUAL(0.4, affordable_ratio(10s, 20ms), 1e-12);
  // Asked to be slower than that already: as it is.
  DOUBLES_EQUAL(1, affordable_ratio(10s, 100ms), 0);
}

TEST(SlowMotion, TurnsAreTimedAfterTheFirstOne) {
  int calls = 0;
  const Nanoseconds mean = mean_turn(2, [&](int turn) {
    if (++calls == 2) std::this_thread::sleep_for(20ms);
    CHECK(turn < 2);
  });
  LONGS_EQUAL(3, calls);
  CHECK(mean >= 10ms);
}

TEST(SlowMotion, AScanAfterLatePicturesGoesAtHalfTheTimeUntilNothingIsLate) {
  TimeShare sut{1.0, 20ms};
  sut.late_by(24ms);
  CHECK(!sut.settle());
  DOUBLES_EQUAL(1, sut.ratio(), 0);
  sut.late_by(26ms);
  sut.late_by(1ms);
  CHECK(sut.settle());
  DOUBLES_EQUAL(0.5, sut.ratio(), 1e-12);
  CHECK(!sut.settle());
  sut.late_by(300ms);
  CHECK(sut.settle());
  // No slower than 20 Hz.
  DOUBLES_EQUAL(0.4, sut.ratio(), 1e-12);
  sut.late_by(300ms);
  CHECK(!sut.settle());
  DOUBLES_EQUAL(0.4, sut.ratio(), 1e-12);
}

TEST(SlowMotion, AMotionGoesThroughTheSamePlacesLater) {
  FlangeMotion straight{.name = "straight", .duration_s = 2, .T_base_flange_at = [](double time_s) -> SE3 {
                          return SE3(Eigen::Translation3d(100 * time_s, 0, 0));
                        }};
  const FlangeMotion sut = slowed(straight, 0.25);
  DOUBLES_EQUAL(8, sut.duration_s, 1e-12);
  DOUBLES_EQUAL(50, sut.T_base_flange_at(2).translation().x(), 1e-9);
  DOUBLES_EQUAL(200, sut.T_base_flange_at(8).translation().x(), 1e-9);
  CHECK(!sut.q_rad_at);
}

}  // namespace biteline::sim
