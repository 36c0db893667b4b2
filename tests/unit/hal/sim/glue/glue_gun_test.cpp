// SPDX-License-Identifier: MIT
#include "hal/sim/glue/glue_gun.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {
namespace {

constexpr double k_step_s = 0.002;

/// What comes out of `sut` in `time_s`, in seconds of full flow.
double comes_out(GlueGun& sut, double time_s, bool gun, double analog_ratio) {
  double sum_s = 0;
  const auto steps = static_cast<int>(std::lround(time_s / k_step_s));
  for (int i = 0; i < steps; ++i) sum_s += k_step_s * sut.step(k_step_s, gun, analog_ratio);
  return sum_s;
}

}  // namespace

TEST_GROUP(GlueGun){};

/// Delays that lie between two cycles are kept, too.
TEST(GlueGun, OpensAndClosesItsDelaysLater) {
  GlueGun sut{{.opens_s = 0.0413, .closes_s = 0.0251, .metered = false}};
  DOUBLES_EQUAL(0.2 - 0.0413, comes_out(sut, 0.2, true, 0), 1e-9);
  DOUBLES_EQUAL(0.0251, comes_out(sut, 0.2, false, 0), 1e-9);
}

TEST(GlueGun, AWordThatIsTakenBackInTimeOpensNothing) {
  GlueGun sut{{.opens_s = 0.04, .metered = false}};
  DOUBLES_EQUAL(0, comes_out(sut, 0.03, true, 0) + comes_out(sut, 0.2, false, 0), 1e-12);
}

/// A first-order lag: after a step so much of what is asked for is missing as lag times height.
TEST(GlueGun, ThePumpComesAfterItsOutput) {
  GlueGun sut{{.opens_s = 0, .closes_s = 0, .pump_lag_s = 0.03}};
  DOUBLES_EQUAL(0.5 * (1 - 0.03), comes_out(sut, 1, true, 0.5), 0.5 * k_step_s);
}

}  // namespace biteline::sim
