// SPDX-License-Identifier: MIT
#include "hal/sim/record/arrival_stamps.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

namespace biteline::sim {

TEST_GROUP(ArrivalStamps) {
  std::vector<SensorClock::time_point> mids;

  void setup() override {
    for (int i = 0; i < 2000; ++i)
      mids.emplace_back(Nanoseconds{1'000'000'000} + i * Nanoseconds{10'000'000});
  }
  /// Stamp minus middle of the exposure.
  struct Late {
    double mean_ms{0}, sigma_ms{0};
  };
  /// From the first second on: before, a clock is not mapped yet.
  Late late(const ArrivalStamps& settings) const {
    constexpr std::size_t k_first = 100;
    const auto stamps = arrival_stamps(mids, settings, 5);
    LONGS_EQUAL(mids.size(), stamps.size());
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < mids.size(); ++i) {
      if (i > 0) CHECK(stamps[i] > stamps[i - 1]);
      if (i < k_first) continue;
      const double ms = 1e-6 * static_cast<double>((stamps[i] - mids[i]).count());
      sum += ms;
      squares += ms * ms;
    }
    const auto count = static_cast<double>(mids.size() - k_first);
    return {.mean_ms = sum / count, .sigma_ms = std::sqrt(squares / count - std::pow(sum / count, 2))};
  }
};

TEST(ArrivalStamps, OfArrivalHaveTheJitterAboutTheMeanThatIsCalibratedAway) {
  const Late jitter = late({.jitter_ms = 1});
  // An exponential law's standard deviation is its mean; of 1900 of them, to 3 standard deviations.
  DOUBLES_EQUAL(0, jitter.mean_ms, 0.07);
  DOUBLES_EQUAL(1, jitter.sigma_ms, 0.13);
  const Late late_ms = late({.jitter_ms = 1, .unknown_late_ms = 4});
  DOUBLES_EQUAL(jitter.mean_ms + 4, late_ms.mean_ms, 1e-3);
}

TEST(ArrivalStamps, OfTheCamerasOwnClockScatterFarLess) {
  const Late mapped = late({.jitter_ms = 1, .camera_stamps = true});
  // The least of 25 delays of 1 ms is 0.04 ms; so much, and as much scatter, is left.
  CHECK(mapped.mean_ms > 0);
  CHECK(mapped.mean_ms < 0.12);
  CHECK(mapped.sigma_ms < 0.05);
}

TEST(ArrivalStamps, NeitherJitterNorDelayIsATrigger) {
  const auto stamps = arrival_stamps(mids, {}, 5);
  CHECK(stamps == mids);
}

}  // namespace biteline::sim
