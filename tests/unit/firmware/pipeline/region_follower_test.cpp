// SPDX-License-Identifier: MIT
#include "firmware/pipeline/region_follower.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>

namespace biteline::pipeline {

TEST_GROUP(RegionFollower) {
  std::unique_ptr<profile::ProfileBuffer> buffer = std::make_unique<profile::ProfileBuffer>();
  RegionFollower sut{{}};
  RegionFollower::Proposal region{.offset_v_px = 0, .height_px = 1236};

  /// A stripe between two rows, as far as the region shows it.
  void see(double first_row, double last_row) {
    buffer->count = 0;
    buffer->header = {};
    for (int i = 0; i < 200; ++i) {
      const double row = first_row + (last_row - first_row) * i / 199;
      if (row < region.offset_v_px || row > region.offset_v_px + region.height_px - 1) continue;
      profile::ProfilePoint& point = buffer->points[buffer->count++];
      point = {};
      point.row_px = static_cast<float>(row);
      point.width_px = 5;
      if (row < region.offset_v_px + 5 || row > region.offset_v_px + region.height_px - 6)
        point.flags |= profile::k_point_clipped;
    }
    if (buffer->count < 4) buffer->header.flags |= profile::k_profile_stripe_lost;
    region = sut.rt_update(*buffer);
  }
};

TEST(RegionFollower, ClosesOnTheStripeAndTellsTheRate) {
  see(600, 700);
  CHECK(region.changed);
  CHECK(!region.searching);
  CHECK(region.offset_v_px <= 600 - 40 && region.offset_v_px > 600 - 60);
  CHECK(region.height_px < 220);
  LONGS_EQUAL(0, region.offset_v_px % 4);
  DOUBLES_EQUAL(1e6 / (300 + 38 * region.height_px), region.rate_max_hz, 1e-6);
  CHECK(region.rate_max_hz > 100);
}

TEST(RegionFollower, FollowsAMovingStripeWithoutLosingAColumn) {
  see(600, 700);
  for (int i = 0; i < 2000; ++i) {
    const double shift = 300 * std::sin(0.02 * i);  // up to six rows per profile
    see(600 + shift, 700 + shift);
    LONGS_EQUAL(200, buffer->count);
  }
}

TEST(RegionFollower, FindsAStripeThatJumpedAway) {
  see(600, 700);
  int profiles = 0;
  for (; profiles < 20; ++profiles) {
    see(150, 180);
    if (!region.searching && buffer->count == 200 && region.height_px < 200) break;
  }
  CHECK(profiles <= RegionFollower::Config{}.profiles_to_lose + 2);
  CHECK(region.offset_v_px < 150 && region.offset_v_px + region.height_px > 180);
}

TEST(RegionFollower, ShrinksOnlyAfterAWhile) {
  see(400, 800);
  const int height = region.height_px;
  int changes = 0;
  for (int i = 0; i < 40; ++i) {
    see(550, 650);
    changes += region.changed ? 1 : 0;
  }
  LONGS_EQUAL(0, changes);
  LONGS_EQUAL(height, region.height_px);
}

}  // namespace biteline::pipeline
