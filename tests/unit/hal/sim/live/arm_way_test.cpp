// SPDX-License-Identifier: MIT
#include "hal/sim/live/arm_way.hpp"

#include <CppUTest/TestHarness.h>

#include "hal/sim/record/made_scene.hpp"

#include "tests/support/errors.hpp"

namespace biteline::sim {

namespace {

ScanPath path_round(const ShoeParameters& shoe, const MadeHead& head) {
  return {Outline(shoe.outline),
          head,
          {.target_z_mm = 0.55 * shoe.upper.top_z_mm, .speed_mm_s = 250, .turn_over_mm = 100}};
}

}  // namespace

TEST_GROUP(ArmWay) {
  ArmKinematics arm = *ArmKinematics::named("ur10e");
  MadeHead head = draw_head(21, Holder::Bracket);
  ShoeParameters shoe = draw_shoe(ShoeClass::Deep, 5, length_of_size_mm(42));
  ScanPath path = path_round(shoe, head);
  SE3 T_base_shoe = draw_place(5, places_within_reach_of("ur10e"), shoe.outline.length_mm);
  Result<ArmScan> scan =
      ArmScan::plan(path, head, arm, {.T_base_shoe = T_base_shoe, .top_z_mm = shoe.upper.top_z_mm});

  /// Between where the flange is and where the arm says it is, over the scan.
  struct Apart {
    double mean_mm{0}, most_mm{0};
  };
  static Apart apart(const HeadWay& way) {
    Apart result;
    int count = 0;
    for (double t = 0; t < way.duration_s; t += 0.005, ++count) {
      const double off_mm =
          (way.T_base_flange_at(t).translation() - way.T_base_flange_told_at(t).translation()).norm();
      result.mean_mm += off_mm;
      result.most_mm = std::max(result.most_mm, off_mm);
    }
    result.mean_mm /= count;
    return result;
  }
};

TEST(ArmWay, AnIdealArmGoesAsPlannedAndSaysSo) {
  SUCCEEDS(scan);
  const HeadWay way = way_of(*scan, arm, {});
  DOUBLES_EQUAL(scan->full_until_s() - scan->full_from_s(), way.duration_s, 1e-12);
  for (double t = 0; t < way.duration_s; t += 0.1) {
    const SE3 planned = arm.T_base_flange(scan->q_rad_at(scan->full_from_s() + t));
    CHECK((planned.translation() - way.T_base_flange_at(t).translation()).norm() < 0.01);
  }
  DOUBLES_EQUAL(0, apart(way).most_mm, 1e-9);
}

TEST(ArmWay, ACommonArmIsOffWhatItTellsByLessThanATenthOfAMillimetreAndMoreThanNothing) {
  SUCCEEDS(scan);
  const Apart off = apart(way_of(*scan, arm, common_arm_dynamics()));
  CHECK_COMPARE(off.mean_mm, >, 0.003);
  CHECK_COMPARE(off.mean_mm, <, 0.1);
  // Encoders that see all of the give leave nothing untold.
  ArmDynamics seen = common_arm_dynamics();
  seen.unseen_ratio = 0;
  DOUBLES_EQUAL(0, apart(way_of(*scan, arm, seen)).most_mm, 1e-9);
}

}  // namespace biteline::sim
