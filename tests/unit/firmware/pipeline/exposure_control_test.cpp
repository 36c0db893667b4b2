// SPDX-License-Identifier: MIT
#include "firmware/pipeline/exposure_control.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>

namespace biteline::pipeline {

TEST_GROUP(ExposureControl) {
  static constexpr int k_columns = 1000;
  std::unique_ptr<profile::ProfileBuffer> buffer = std::make_unique<profile::ProfileBuffer>();

  /// A surface that gives `grey_per_us`, speckled: the brightest columns shine three times as much as the
  /// middle ones.
  const profile::ProfileBuffer& expose(double grey_per_us, Nanoseconds exposure, int columns = k_columns) {
    buffer->count = 0;
    for (int i = 0; i < columns; ++i) {
      const double share = static_cast<double>(i) / columns;
      const double light = grey_per_us * 1e-3 * static_cast<double>(exposure.count()) *
                           (0.8 + 0.4 * share + (share > 0.97 ? 1.0 : 0.0));
      if (light < 12) continue;
      profile::ProfilePoint& point = buffer->points[buffer->count++];
      point = {};
      point.column = static_cast<std::uint16_t>(i);
      point.amplitude = static_cast<float>(std::min(light, 260.0));
      if (light > 250) point.flags |= profile::k_point_saturated;
    }
    return *buffer;
  }
};

TEST(ExposureControl, FindsTheTargetFromDarkAndFromGlare) {
  for (const double grey_per_us : {0.1, 0.5, 2.0, 6.0}) {
    for (const Nanoseconds start :
         {Nanoseconds{std::chrono::microseconds{20}}, Nanoseconds{std::chrono::milliseconds{4}}}) {
      ExposureControl sut{{}, start};
      Nanoseconds exposure = start;
      ExposureControl::Decision last;
      int changes_late = 0;
      for (int i = 0; i < 120; ++i) {
        last = sut.rt_update(expose(grey_per_us, exposure), k_columns);
        exposure = last.exposure;
        if (i > 80 && last.changed) ++changes_late;
      }
      CHECK(last.valid_ratio > 0.95F);
      CHECK(last.saturated_ratio <= 0.05F);
      CHECK(last.amplitude > 100 && last.amplitude < 200);
      LONGS_EQUAL(0, changes_late);  // it settles and does not hunt
    }
  }
}

TEST(ExposureControl, KeepsToItsLimits) {
  ExposureControl sut{{}, std::chrono::microseconds{400}};
  ExposureControl::Decision decision;
  for (int i = 0; i < 100; ++i)
    decision = sut.rt_update(expose(0, std::chrono::microseconds{400}), k_columns);
  CHECK(decision.exposure == ExposureControl::Config{}.maximum);
  for (int i = 0; i < 100; ++i) decision = sut.rt_update(expose(1e6, decision.exposure), k_columns);
  CHECK(decision.exposure == ExposureControl::Config{}.minimum);
}

TEST(ExposureControl, ReflectionsDoNotCount) {
  expose(2.0, std::chrono::microseconds{400});
  for (std::size_t i = 0; i < buffer->count; ++i) buffer->points[i].flags |= profile::k_point_reflection;
  ExposureControl sut{{}, std::chrono::microseconds{400}};
  DOUBLES_EQUAL(0, sut.rt_update(*buffer, k_columns).valid_ratio, 0);
}

}  // namespace biteline::pipeline
