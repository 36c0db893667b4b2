// SPDX-License-Identifier: MIT
#include "hal/sim/live/arm_scan.hpp"

#include <CppUTest/TestHarness.h>

#include "hal/sim/record/made_scene.hpp"
#include "hal/sim/robot/arm_body.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::sim {

TEST_GROUP(ArmScan) {
  ArmKinematics arm = *ArmKinematics::named("ur10e");
  MadeHead head = draw_head(21, Holder::Bracket);

  static ShoeParameters shoe_of(double eu_size) {
    return draw_shoe(ShoeClass::Deep, 5, length_of_size_mm(eu_size));
  }
  ScanPath path_round(const ShoeParameters& shoe, double speed_mm_s, double turn_over_mm = 100,
                      const CheckLap& check = {}) const {
    return {Outline(shoe.outline),
            head,
            {.target_z_mm = 0.55 * shoe.upper.top_z_mm,
             .speed_mm_s = speed_mm_s,
             .turn_over_mm = turn_over_mm,
             .check = check}};
  }
  static ScanPlace place_of(const ShoeParameters& shoe, std::uint64_t seed, std::string_view arm_name) {
    return {.T_base_shoe = draw_place(seed, places_within_reach_of(arm_name), shoe.outline.length_mm),
            .top_z_mm = shoe.upper.top_z_mm};
  }

  /// Largest joint speed and acceleration over their limits, by differences of what a controller would be
  /// told.
  struct Load {
    double speed{0}, acceleration{0};
  };
  Load load_of(const ArmScan& scan) const {
    constexpr double k_cycle_s = 0.002;
    Load load;
    for (double t = k_cycle_s; t + k_cycle_s < scan.duration_s(); t += k_cycle_s) {
      const JointVector a = scan.q_rad_at(t - k_cycle_s), b = scan.q_rad_at(t),
                        c = scan.q_rad_at(t + k_cycle_s);
      const JointVector v = (c - a) / (2 * k_cycle_s), dv = (c - 2 * b + a) / (k_cycle_s * k_cycle_s);
      load.speed = std::max(load.speed, v.cwiseQuotient(arm.limits().speed_rad_s).cwiseAbs().maxCoeff());
      load.acceleration = std::max(load.acceleration,
                                   dv.cwiseQuotient(arm.limits().acceleration_rad_s2).cwiseAbs().maxCoeff());
    }
    return load;
  }
};

TEST(ArmScan, ABracketHoldsTheHeadAsTheStraightHolderDoes) {
  const MadeHead straight = draw_head(21);
  // The same head: light and camera agree, only the flange is elsewhere.
  CHECK(head.laser.beam_cam.isApprox(straight.laser.beam_cam));
  const ScanPath path = path_round(shoe_of(42), 100);
  const SE3 T_shoe_flange = path.T_shoe_cam_at(0) * head.model.T_flange_cam.inverse(Eigen::Isometry);
  // Upright to within a mounting's error of 0.008 rad in each direction.
  CHECK(T_shoe_flange.linear().col(2).dot(-Vec3::UnitZ()) > 0.999);
  CHECK(T_shoe_flange.translation().z() > 250);
}

TEST(ArmScan, GrownUpsShoesAreScannedAllTheWayRoundAndTheHeadIsWhereThePathWantsIt) {
  for (const double size : {36.0, 42.0, 47.0}) {
    const ShoeParameters shoe = shoe_of(size);
    const ScanPath path = path_round(shoe, 50);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const ScanPlace place = place_of(shoe, seed, "ur10e");
      const auto scan = ArmScan::plan(path, head, arm, place);
      SUCCEEDS(scan);
      for (const auto& [time_s, way_mm] :
           {std::pair{scan->full_from_s(), 0.0}, std::pair{scan->full_until_s(), path.length_mm()}}) {
        const SE3 expected =
            place.T_base_shoe * path.T_shoe_cam_at(way_mm) * head.model.T_flange_cam.inverse(Eigen::Isometry);
        TRANSFORMS_EQUAL(expected, arm.T_base_flange(scan->q_rad_at(time_s)), 0.1, 1e-3);
      }
      const JointVector turned = scan->q_rad_at(scan->duration_s()) - scan->q_rad_at(0);
      CHECK(std::abs(turned[5]) > 6);  // once round
    }
  }
}

TEST(ArmScan, NoJointGoesFasterOrFartherThanItMay) {
  const ShoeParameters shoe = shoe_of(42);
  for (const double speed_mm_s : {50.0, 250.0, 500.0}) {
    const auto scan = ArmScan::plan(path_round(shoe, speed_mm_s), head, arm, place_of(shoe, 5, "ur10e"));
    SUCCEEDS(scan);
    const Load load = load_of(*scan);
    CHECK_COMPARE(load.speed, <=, 1.02);
    CHECK_COMPARE(load.acceleration, <=, 1.1);
    for (double t = 0; t < scan->duration_s(); t += 0.05)
      CHECK((scan->q_rad_at(t).cwiseAbs() - arm.limits().most_rad).maxCoeff() <= 0);
    CHECK_COMPARE(scan->slowest_mm_s(), >, 0);
    CHECK_COMPARE(scan->slowest_mm_s(), <=, speed_mm_s);
  }
}

TEST(ArmScan, AGrownUpsShoeIsScannedWithinThreeSecondsFromTheWaist) {
  for (const double size : {39.0, 42.0, 44.0}) {
    const ShoeParameters shoe = shoe_of(size);
    const Outline outline(shoe.outline);
    const ScanPath path(outline, head,
                        {.target_z_mm = 0.55 * shoe.upper.top_z_mm,
                         .speed_mm_s = 400,
                         .turn_over_mm = 0.6 * outline.perimeter_mm(),
                         .begin_mm = 0.25 * outline.perimeter_mm()});
    const auto scan = ArmScan::plan(path, head, arm, place_of(shoe, 5, "ur10e"));
    SUCCEEDS(scan);
    CHECK_COMPARE(scan->full_until_s() - scan->full_from_s(), <=, 3);
    // It stands soon after: the wrist is slow there.
    CHECK_COMPARE(scan->duration_s() - scan->full_until_s(), <=, 0.5);
    CHECK_COMPARE(load_of(*scan).speed, <=, 1.02);
    CHECK_COMPARE(load_of(*scan).acceleration, <=, 1.1);
  }
}

TEST(ArmScan, ClockwiseTheHeadPassesTheSamePlacesBackwardsAndTheWristTurnsTheOtherWay) {
  const ShoeParameters shoe = shoe_of(42);
  const ScanPath path = path_round(shoe, 250);
  ScanPlace place = place_of(shoe, 5, "ur10e");
  const auto there = ArmScan::plan(path, head, arm, place);
  place.clockwise = true;
  const auto back = ArmScan::plan(path, head, arm, place);
  SUCCEEDS(there);
  SUCCEEDS(back);
  TRANSFORMS_EQUAL(arm.T_base_flange(there->q_rad_at(there->full_from_s())),
                   arm.T_base_flange(back->q_rad_at(back->full_until_s())), 0.1, 1e-3);
  TRANSFORMS_EQUAL(arm.T_base_flange(there->q_rad_at(there->full_until_s())),
                   arm.T_base_flange(back->q_rad_at(back->full_from_s())), 0.1, 1e-3);
  const auto turned_rad = [](const ArmScan& scan) {
    return scan.q_rad_at(scan.duration_s())[5] - scan.q_rad_at(0)[5];
  };
  CHECK(std::abs(turned_rad(*there)) > 6 && turned_rad(*there) * turned_rad(*back) < 0);
}

TEST(ArmScan, ACheckLapLastsThreeTenthsOfASecondAtMostAndSeesTheRamps) {
  const ShoeParameters shoe = shoe_of(42);
  const double over_mm = 0.6 * Outline(shoe.outline).perimeter_mm();
  const ScanPlace place = place_of(shoe, 5, "ur10e");
  const auto plain = ArmScan::plan(path_round(shoe, 250, over_mm), head, arm, place);
  const auto lap = ArmScan::plan(path_round(shoe, 250, over_mm, {.length_mm = 50}), head, arm, place);
  SUCCEEDS(plain);
  SUCCEEDS(lap);
  CHECK_COMPARE(lap->duration_s(), <=, plain->duration_s() + 0.3);
  CHECK_COMPARE(lap->full_until_s(), <=, plain->full_until_s() + 0.3);
  // The ramp before the path's begin is 31 mm long.
  const double seen_mm = (arm.T_base_flange(lap->q_rad_at(lap->full_from_s())).translation() -
                          arm.T_base_flange(plain->q_rad_at(plain->full_from_s())).translation())
                             .norm();
  CHECK_COMPARE(seen_mm, >, 20);
  const Load load = load_of(*lap);
  CHECK_COMPARE(load.speed, <=, 1.02);
  CHECK_COMPARE(load.acceleration, <=, 1.1);
}

TEST(ArmScan, WhatTheArmDoesNotReachIsRefusedWithThePlace) {
  const ShoeParameters shoe = shoe_of(42);
  const ScanPath path = path_round(shoe, 50);
  ScanPlace far = place_of(shoe, 5, "ur10e");
  far.T_base_shoe.pretranslate(Vec3(900, 0, 0));
  const auto refused = ArmScan::plan(path, head, arm, far);
  FAILS_NAMING(Errc::OutOfReach, "posture", refused);
  // Moved away bit by bit, the far side is out of reach first, in the middle of the way.
  const ScanPlace near = place_of(shoe, 5, "ur10e");
  for (double away_mm = 300;; away_mm += 20) {
    far.T_base_shoe = Eigen::Translation3d(away_mm, 0, 0) * near.T_base_shoe;
    const auto half = ArmScan::plan(path, head, arm, far);
    if (half) continue;
    FAILS_NAMING(Errc::OutOfReach, "mm along the outline", half);
    CHECK_COMPARE(away_mm, <, 700);
    break;
  }
}

TEST(ArmScan, ATableUnderTheHeadIsNotTouched) {
  const ShoeParameters shoe = shoe_of(42);
  ScanPathSettings low{.target_z_mm = 5, .speed_mm_s = 50};
  const auto refused =
      ArmScan::plan(ScanPath(Outline(shoe.outline), head, low), head, arm, place_of(shoe, 5, "ur10e"));
  FAILS_NAMING(Errc::OutOfReach, "touches the table", refused);
}

TEST(ArmScan, AShoeAsTallAsTheBracketIsRefused) {
  const ShoeParameters shoe = shoe_of(42);
  ScanPlace place = place_of(shoe, 5, "ur10e");
  place.top_z_mm = 320;
  const auto refused = ArmScan::plan(path_round(shoe, 50), head, arm, place);
  FAILS_NAMING(Errc::OutOfReach, "touches the shoe", refused);
}

TEST(ArmScan, AChildsShoeSuitsASmallerArm) {
  const ArmKinematics small = *ArmKinematics::named("ur5e");
  const ShoeParameters shoe = shoe_of(24);
  SUCCEEDS(ArmScan::plan(path_round(shoe, 50), head, small, place_of(shoe, 5, "ur5e")));
}

TEST(ArmScan, AnEaseGoesFromRestToRestWithinItsLimits) {
  const JointVector from = JointVector::Zero(), to = (JointVector() << 1, -2, 0.5, 0, 3, -6).finished();
  const JointEase sut(from, to, arm.limits());
  constexpr double k_cycle_s = 0.002;
  double most = 0;
  for (double t = 0; t < sut.duration_s(); t += k_cycle_s) {
    const JointVector v = (sut.q_rad_at(t + k_cycle_s) - sut.q_rad_at(t)) / k_cycle_s;
    most = std::max(most, v.cwiseQuotient(arm.limits().speed_rad_s).cwiseAbs().maxCoeff());
  }
  CHECK(most <= 1.0001 && most > 0.9);
  CHECK(sut.q_rad_at(sut.duration_s()).isApprox(to));
}

}  // namespace biteline::sim
