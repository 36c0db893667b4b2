// SPDX-License-Identifier: MIT
#include "host/robot/path/give.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>

#include "hal/sim/robot/joint_dynamics.hpp"
#include "host/robot/kinematics/chain.hpp"
#include "host/robot/path/plan.hpp"
#include "host/robot/path/tip_bound.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;

const Joints k_posture_rad = (Joints() << 0.3, -1.2, 1.6, -1.9, -1.5, 0.2).finished();

/// Joint 1 swings, with the tip 1 mm on for each place, 100 mm/s.
struct Swing {
  double rad{0.02}, per_s{0};

  [[nodiscard]] Joints at(double time_s) const {
    Joints q_rad = k_posture_rad;
    q_rad[0] += rad * (1 - std::cos(per_s * time_s));
    return q_rad;
  }
  [[nodiscard]] std::vector<GivePlace> places(int count) const {
    std::vector<GivePlace> places;
    for (int i = 0; i < count; ++i) {
      const double time_s = 0.01 * i;
      // What is worked goes straight up, across which joint 1 turns the tool.
      places.push_back({.q_rad = at(time_s),
                        .work_base = {600, 0, 1.0 * i},
                        .arc_mm = 1.0 * i,
                        .speed_mm_s = 100,
                        .time_s = time_s});
    }
    return places;
  }
};

PlanOutcome spray_plan(std::optional<double> give_mm) {
  PlanRequest asked{.line = test::made_line(),
                    .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "spray.yaml"),
                    .arm = *kinematics::arm_model("UR10e"),
                    .table_z_mm = 40,
                    .shoe = {},
                    .cloud = {}};
  asked.process.motion.give_mm = give_mm;
  return plan(asked);
}

}  // namespace

TEST_GROUP(Give) {
  kinematics::ArmModel arm = *kinematics::arm_model("UR10e");
};

TEST(Give, OfSlowMotionIsTheAccelerationOverTheOwnFrequencySquared) {
  const Swing slow{.per_s = 2 * 3.14159265 * 0.5};
  const std::vector<GivePlace> places = slow.places(400);
  const std::vector<double> give_mm = give_along_mm(arm, places);
  const double w2 = std::pow(2 * 3.14159265 * arm.give.natural_hz[0], 2);
  const double most_rad_s2 = slow.rad * slow.per_s * slow.per_s;
  // Joint 1 turns about z: what stands 600 mm away goes across by that much.
  DOUBLES_EQUAL(600 * most_rad_s2 / w2, give_mm[200], 0.05 * 600 * most_rad_s2 / w2);
  const std::vector<GiveRate> rates = give_rates(arm, places);
  DOUBLES_EQUAL(600 * most_rad_s2 / w2, rates[200].per_speed2.norm() * 100 * 100,
                0.03 * 600 * most_rad_s2 / w2);
}

TEST(Give, IsThatOfTheSimulatedElasticArmAlsoWhereItRings) {
  for (const double hz : {1.0, 3.0, 6.0}) {
    const Swing swing{.per_s = 2 * 3.14159265 * hz};
    const std::vector<GivePlace> places = swing.places(400);
    const double ours_mm = std::ranges::max(give_along_mm(arm, places));
    sim::JointDynamics made{{.elastic_hz = arm.give.natural_hz.minCoeff()}, swing.at(0)};
    double made_mm = 0;
    for (int k = 0; k < 4000; ++k) {
      const Joints q_rad = swing.at(1e-3 * k);
      made.step(q_rad);
      const Vec3 work{600, 0, 0.1 * k};
      const Joints give_rad = made.q_link_rad() - q_rad;
      Vec3 off = kinematics::jacobian(arm, q_rad, work).topRows<3>() * give_rad;
      made_mm = std::max(made_mm, off.head<2>().norm());
    }
    DOUBLES_EQUAL(made_mm, ours_mm, 0.05 * made_mm);
  }
}

TEST(Give, NothingGivesOnAnArmThatStandsStill) {
  std::vector<GivePlace> places = Swing{.rad = 0}.places(20);
  DOUBLES_EQUAL(0, std::ranges::max(give_along_mm(arm, places)), 1e-12);
}

TEST(Give, AProcessThatAsksForLessIsSlowerAndSmoother) {
  const PlanOutcome free = spray_plan(std::nullopt), asked = spray_plan(0.2), strict = spray_plan(0.1);
  CHECK_TEXT(free.path && asked.path && strict.path,
             (free.reason() + asked.reason() + strict.reason()).c_str());
  const double before_mm = free.path->path().give_mm;
  CHECK(before_mm > 0.5);
  // The way in's last swing may stand a little above it.
  CHECK(asked.path->path().give_mm <= 0.25);
  CHECK(strict.path->path().give_mm <= 0.13);
  CHECK(asked.path->duration_s() > free.path->duration_s());
  CHECK(strict.path->duration_s() > asked.path->duration_s());
  CHECK(asked.path->duration_s() < free.path->duration_s() + 3);
  // Moves of their own accelerations, none beyond the process's.
  for (const Waypoint& w : asked.path->path().waypoints) {
    CHECK(w.acceleration_mm_s2.has_value());
    CHECK(*w.acceleration_mm_s2 > 0 && *w.acceleration_mm_s2 <= 1000);
  }
  CHECK(!free.path->path().waypoints.back().acceleration_mm_s2);
}

TEST(Give, SlowsNoToolBelowItsLeastSpeed) {
  const PlanOutcome outcome = spray_plan(0.001);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  CHECK(outcome.path->path().give_mm > 0.001);
}

}  // namespace biteline::path
