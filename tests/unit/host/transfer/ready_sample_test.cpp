// SPDX-License-Identifier: MIT
#include "host/transfer/ready_sample.hpp"

#include <CppUTest/TestHarness.h>

#include "host/transfer/transfer.hpp"
#include "tests/support/made_pair.hpp"

namespace biteline::transfer {

TEST_GROUP(ReadySample){};

TEST(ReadySample, ServesOneUpperAfterTheOtherAsIfItWereNew) {
  const test::MadePair pair =
      test::made_pair({.seed = 6, .scan = {.profile_step_mm = 1.2, .column_step_mm = 0.2}});
  const SampleFiles files{.cloud = pair.sample_cloud, .line = pair.sample_line};
  cloud::PointCloud scattered;  // no mesh: the sample's own walls are asked for
  scattered.points = pair.upper_cloud.points;
  const ReadySample sut{files};
  sut.make_all();
  const auto* walls = sut.walls_mm().data();
  for (const cloud::PointCloud& upper : {pair.upper_cloud, scattered, pair.upper_cloud}) {
    const Transfer ready = transfer_line(sut, upper, {}), anew = transfer_line(files, upper, {});
    CHECK(ready.found && anew.found);
    LONGS_EQUAL(anew.carried.line.points.size(), ready.carried.line.points.size());
    for (std::size_t i = 0; i < ready.carried.line.points.size(); ++i) {
      const cloud::LinePoint &a = anew.carried.line.points[i], &b = ready.carried.line.points[i];
      DOUBLES_EQUAL(0, (a.position - b.position).norm(), 1e-9);
      DOUBLES_EQUAL(*a.u95_mm, *b.u95_mm, 1e-9);
    }
  }
  POINTERS_EQUAL(walls, sut.walls_mm().data());
}

TEST(ReadySample, OneWithoutAShoeSaysSoAtEachUpper) {
  const test::MadePair pair =
      test::made_pair({.seed = 6, .scan = {.profile_step_mm = 1.2, .column_step_mm = 0.2}});
  const ReadySample sut{SampleFiles{.cloud = {}, .line = pair.sample_line}};
  sut.make_all();
  for (int i = 0; i < 2; ++i) {
    const Transfer transfer = transfer_line(sut, pair.upper_cloud, {});
    CHECK(transfer.refusal && transfer.refusal->code == Refused::SampleUnusable);
  }
}

}  // namespace biteline::transfer
