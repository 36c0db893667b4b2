// SPDX-License-Identifier: MIT
// What the service asks of an arm of another make before a scan is spent.
#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "hal/sim/robot/path_taker.hpp"
#include "host/apps/biteline-host/arm_lock.hpp"
#include "host/robot/kinematics/dh_rows.hpp"
#include "host/robot/link/ur/arm_look.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::service {
namespace {

using namespace std::chrono_literals;

sim::JointVector standing_rad() {
  return (sim::JointVector() << 0.3, -1.8, 1.6, -1.4, -1.57, 0.5).finished();
}

}  // namespace

TEST_GROUP(OtherController) {
  sim::Arm arm{*sim::ArmKinematics::named("ur5e"), standing_rad()};
  std::unique_ptr<sim::PathTaker> taker = *sim::PathTaker::open({}, arm);

  ControllerAddress address() const {
    ControllerAddress controller{.rtde = {}, .script = {}, .dashboard = {}};
    controller.other = *robot::other::ArmLink::open({.port = taker->port(), .connect_patience_s = 20});
    return controller;
  }
  static ControllerLook look(const ControllerAddress& controller, const char* model = "UR5e",
                             const char* serial = "") {
    return look_at_controller(controller, *kinematics::arm_model(model), serial);
  }
};

ORDINARY_TIMED_TEST(OtherController, AnArmThatStandsIsReadyAndSaysWhatItIs) {
  const ControllerAddress controller = address();
  const ControllerLook sut = look(controller, "UR5e", "1");
  STRCMP_EQUAL("", sut.wrong.c_str());
  STRCMP_EQUAL("made UR5e by another name", sut.words->model->c_str());
  STRCMP_EQUAL("1", sut.words->serial->c_str());
  CHECK_FALSE(sut.words->remote.has_value());
  CHECK_EQUAL("127.0.0.1:" + std::to_string(taker->port()), controller.name());
}

/// Each row but its own, and but that of its twin by another name.
ORDINARY_TIMED_TEST(OtherController, AnArmThatIsBuiltOtherwiseIsRefusedByItsPose) {
  const ControllerAddress controller = address();
  for (const std::string& model : kinematics::arm_names()) {
    const ControllerLook sut = look(controller, model.c_str());
    if (model == "UR5e" || model == "UR7e") continue;
    STRCMP_CONTAINS(("degrees from a " + model + "'s with its joints").c_str(), sut.wrong.c_str());
    CHECK(!sut.moves);
  }
}

/// One whose controller reckons with a calibration: by the row alone it is some 2 mm off, by its own it is
/// not.
ORDINARY_TIMED_TEST(OtherController, AnArmWithACalibrationOfItsOwnNeedsIt) {
  const sim::ArmKinematics own = sim::ArmKinematics::named("ur5e")->made(3);
  sim::Arm own_arm{own, standing_rad()};
  taker = *sim::PathTaker::open({}, own_arm);
  const ControllerAddress controller = address();
  STRCMP_CONTAINS("tells a pose", look(controller).wrong.c_str());
  std::array<kinematics::DhRow, kinematics::k_joints> rows;
  std::ranges::transform(own.rows(), rows.begin(), [](const sim::ArmKinematics::DhRow& row) {
    return kinematics::DhRow{
        .theta_rad = row.theta_rad, .a_mm = row.a_mm, .d_mm = row.d_mm, .alpha_rad = row.alpha_rad};
  });
  const auto calibrated = kinematics::with_rows(*kinematics::arm_model("UR5e"), rows, "made");
  SUCCEEDS(calibrated);
  STRCMP_EQUAL("", look_at_controller(controller, *calibrated, "").wrong.c_str());
  taker.reset();
}

ORDINARY_TIMED_TEST(OtherController, WhatIsWrongIsSaidByName) {
  const ControllerAddress controller = address();
  STRCMP_CONTAINS("serial number 1, not 2", look(controller, "UR5e", "2").wrong.c_str());
  taker->set_powered(false);
  const auto patience_ends = hal::monotonic_now() + 20s;
  while (look(controller).wrong.empty() && hal::monotonic_now() < patience_ends) {
  }
  STRCMP_CONTAINS("no power", look(controller).wrong.c_str());
  taker.reset();
  while (controller.other->latest() && hal::monotonic_now() < patience_ends) {
  }
  const ControllerLook away = look(controller);
  STRCMP_CONTAINS(controller.name().c_str(), away.wrong.c_str());
  CHECK(!away.words.has_value());
}

ORDINARY_TIMED_TEST(OtherController, ItsPoseIsSeenAndTaughtBy) {
  const ControllerAddress controller = address();
  const ArmSeen seen = see_arm(controller, *kinematics::arm_model("UR5e"));
  DOUBLES_EQUAL(0, (*seen.q_rad - standing_rad()).norm(), 1e-5);
  const auto look = robot::ur::look_at_arm(*controller.other);
  SUCCEEDS(look);
  TRANSFORMS_EQUAL(arm.at(hal::monotonic_now()).T_base_flange, look->T_base_flange, 1e-3, 1e-5);
  CHECK_FALSE(look->payload.has_value());
}

TEST(OtherController, ItIsHeldByOneServiceAndOneThatIsAwayIsCalledOn) {
  const auto first = connect_arm({.host = "127.0.0.1", .port = taker->port()});
  SUCCEEDS(first);
  FAILS_NAMING(Errc::PeerRefused, "another host is connected",
               connect_arm({.host = "127.0.0.1", .port = taker->port()}));
  const std::uint16_t port = taker->port();
  taker.reset();
  const auto away = connect_arm({.host = "127.0.0.1", .port = port});
  SUCCEEDS(away);
  CHECK_FALSE((*away)->status().connected);
}

}  // namespace biteline::service
