// SPDX-License-Identifier: MIT
#include "hal/sim/live/reachable_scan.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::sim {

TEST_GROUP(ReachableScan) {
  ArmKinematics arm = *ArmKinematics::named("ur10e");

  /// A shoe on the table, and a scan that aims at this height.
  static std::unique_ptr<MadeScene> scene_aimed_at(double target_z_mm) {
    auto scene = *make_scene({.shoe = draw_shoe(ShoeClass::Deep, 5, length_of_size_mm(42)),
                              .places = places_within_reach_of("ur10e"),
                              .holder = Holder::Bracket});
    ScanPathSettings path = scene->path.settings();
    path.target_z_mm = target_z_mm;
    scene->path = ScanPath(scene->shoe.outline(), scene->head, path);
    return scene;
  }
  Result<ReachableScan> placed(MadeScene & scene) const {
    return place_within_reach(scene, arm, "ur10e");
  }
};

TEST(ReachableScan, AUsualScanStaysAsHighAsItIs) {
  const auto scene = scene_aimed_at(36);
  SUCCEEDS(placed(*scene));
  DOUBLES_EQUAL(36, scene->path.settings().target_z_mm, 0);
}

TEST(ReachableScan, ACameraThatWouldTouchTheTableGoesHigher) {
  const auto scene = scene_aimed_at(18);
  const auto reachable = placed(*scene);
  SUCCEEDS(reachable);
  CHECK(scene->path.settings().target_z_mm > 18);
  CHECK_FALSE(reachable->moved_because.empty());
}

TEST(ReachableScan, WhatStaysOutOfReachIsRefusedWithTheFirstPlacesReason) {
  const auto scene = scene_aimed_at(-40);
  FAILS_NAMING(Errc::OutOfReach, "touches the table", placed(*scene));
  DOUBLES_EQUAL(-40, scene->path.settings().target_z_mm, 0);
}

}  // namespace biteline::sim
