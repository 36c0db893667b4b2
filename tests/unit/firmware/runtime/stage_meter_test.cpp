// SPDX-License-Identifier: MIT
#include "firmware/runtime/stage_meter.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::runtime {

TEST_GROUP(StageMeter){};

TEST(StageMeter, NothingMeasuredIsZero) {
  const StageMeter sut;
  LONGS_EQUAL(0, sut.summary().count);
  LONGS_EQUAL(0, sut.summary().min.count());
}

TEST(StageMeter, KeepsShortestMeanAndLongest) {
  StageMeter sut;
  for (const int ns : {30, 10, 20, 40}) sut.rt_add(Nanoseconds{ns});
  const StageMeter::Summary summary = sut.summary();
  LONGS_EQUAL(4, summary.count);
  LONGS_EQUAL(10, summary.min.count());
  LONGS_EQUAL(25, summary.mean.count());
  LONGS_EQUAL(40, summary.max.count());
}

}  // namespace biteline::runtime
