// SPDX-License-Identifier: MIT
#include "hal/linux/arm_link_poses/arm_link_pose_source.hpp"

#include <CppUTest/TestHarness.h>

#include <vector>

#include "hal/sim/robot/state_teller.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

SE3 tool() {
  SE3 T = SE3::Identity();
  T.translation() = Vec3{10, -20, 150};
  T.linear() = geometry::exp_so3({0.3, 0.2, -0.1});
  return T;
}

SE3 flange_at_x(double x_mm) {
  SE3 T = SE3::Identity();
  T.translation().x() = x_mm;
  T.linear() = geometry::exp_so3({-1.1, 0.4, 2.0});
  return T;
}

arm_link::State state_at(double x_mm, Nanoseconds stamp) {
  return {.stamp_us = static_cast<std::uint64_t>(stamp.count() / 1000),
          .T_base_tcp = flange_at_x(x_mm) * tool(),
          .T_flange_tcp = tool(),
          .phase = arm_link::Phase::Running,
          .powered = true,
          .safe = true};
}

/// A controller on loopback that is told what to say, byte by byte.
struct RawController {
  sim::TcpListener listener = *sim::listen_on_loopback(0);
  hal::Descriptor caller{};

  void take_caller(ArmLinkPoseSource& sut) {
    while (!caller.is_open()) {
      static_cast<void>(sut.next_pose(1ms));
      caller = sim::accept_from(listener);
    }
  }
  void say(const arm_link::Message& message) const {
    std::vector<std::uint8_t> bytes{message.begin(), message.end()};
    CHECK(sim::write_available(caller, bytes));
  }
};

std::unique_ptr<ArmLinkPoseSource> started(std::uint16_t port) {
  auto sut = ArmLinkPoseSource::open({.controller = {.address = "127.0.0.1", .port = port},
                                      .retry_after = 1ms,
                                      .lost_after = 20ms,
                                      .reconnect_after = 200ms})
                 .value();
  SUCCEEDS(sut->start());
  return sut;
}

/// The next pose, however slow the machine is.
RobotPose next(ArmLinkPoseSource& sut) {
  const auto patience_ends = monotonic_now() + 20s;
  Result<RobotPose> pose = sut.next_pose(5ms);
  while (!pose && monotonic_now() < patience_ends) pose = sut.next_pose(5ms);
  SUCCEEDS(pose);
  return *pose;
}

void wait_for_fault(ArmLinkPoseSource& sut, const char* words) {
  const auto patience_ends = monotonic_now() + 20s;
  while (!(sut.fault() && sut.fault()->where.view().find(words) != std::string_view::npos) &&
         monotonic_now() < patience_ends)
    static_cast<void>(sut.next_pose(1ms));
  CHECK_TEXT(sut.fault().has_value(), words);
  STRCMP_CONTAINS(words, to_line(*sut.fault()).c_str());
}

}  // namespace

TEST_GROUP(ArmLinkPoseSource){};

TEST(ArmLinkPoseSource, FollowsItsStateTable) {
  FAILS_NAMING(Errc::BadValue, "robot.local is no IPv4 address",
               ArmLinkPoseSource::open({.controller = {.address = "robot.local", .port = 1}}));
  const RawController silent;
  const auto sut = ArmLinkPoseSource::open({.controller = {"127.0.0.1", silent.listener.port}}).value();
  CHECK(sut->next_pose(0ns).error().code == Errc::WrongState);
  SUCCEEDS(sut->start());
  CHECK(sut->start().error().code == Errc::WrongState);
  FAILS_NAMING(Errc::Timeout, "no state of the controller", sut->next_pose(1ms));
  CHECK(sut->health().state == PoseState::Connecting);
  SUCCEEDS(sut->stop());
  CHECK(sut->health().state == PoseState::Idle);
  SUCCEEDS(sut->start());
}

/// The tip is told; the flange is what the head hangs on.
TEST(ArmLinkPoseSource, GivesTheFlangeOfEachStateOnceAndSaysNothing) {
  RawController robot;
  const auto sut = started(robot.listener.port);
  robot.take_caller(*sut);
  for (int i = 0; i < 50; ++i)
    robot.say(arm_link::encode(static_cast<std::uint32_t>(i) + 1, state_at(i, 7000s + 4ms * i)));
  for (int i = 0; i < 50; ++i) {
    const RobotPose pose = next(*sut);
    TRANSFORMS_EQUAL(flange_at_x(i), pose.T_base_flange, 1e-3, 1e-6);
    CHECK(pose.stamp.time_since_epoch() == 7000s + 4ms * i);
    CHECK_EQUAL(static_cast<std::uint64_t>(i) + 1, pose.sequence);
    CHECK_EQUAL(std::uint32_t{k_pose_program_running}, pose.status);
  }
  CHECK_EQUAL(50U, sut->health().poses);
  CHECK_EQUAL(0U, sut->health().poses_rejected);
  std::vector<std::uint8_t> said;
  CHECK(sim::read_available(robot.caller, said));
  CHECK(said.empty());
}

TEST(ArmLinkPoseSource, WhatIsNoStateEndsTheConnectionAndIsTold) {
  RawController robot;
  const auto sut = started(robot.listener.port);
  const auto say = [&](const arm_link::Message& message, const char* words) {
    robot.caller.close();
    robot.take_caller(*sut);
    robot.say(message);
    wait_for_fault(*sut, words);
  };
  say(arm_link::encode(1, arm_link::Refusal{.of = 0, .reason = arm_link::Reason::Busy}), "another host");
  say(arm_link::encode(1, arm_link::Robot{}), "kind 65: states with a time expected");
  say(arm_link::Message{}, "no message of it");
  arm_link::State late = state_at(0, 1s);
  late.stamp_us = ~std::uint64_t{0};
  say(arm_link::encode(1, late), "states with a time expected");
  CHECK(sut->health().poses_rejected >= 4);
  CHECK(sut->health().state == PoseState::Connecting);
  robot.caller.close();
  robot.take_caller(*sut);
  robot.say(arm_link::encode(1, state_at(3, 1s)));
  static_cast<void>(next(*sut));
  CHECK_FALSE(sut->fault().has_value());
}

/// A controller that was started anew: its clock from the beginning, another connection.
TEST(ArmLinkPoseSource, AControllerThatStartedAnewIsBelieved) {
  RawController robot;
  const auto sut = started(robot.listener.port);
  robot.take_caller(*sut);
  for (std::uint32_t i = 1; i <= 3; ++i) robot.say(arm_link::encode(i, state_at(i, 9000s + 4ms * i)));
  for (int i = 0; i < 3; ++i) static_cast<void>(next(*sut));
  robot.caller.close();
  robot.take_caller(*sut);
  robot.say(arm_link::encode(1, state_at(7, 3s)));
  const RobotPose pose = next(*sut);
  DOUBLES_EQUAL(7, pose.T_base_flange.translation().x(), 1e-3);
  CHECK_EQUAL(4U, pose.sequence);
  CHECK_EQUAL(1U, sut->health().reconnects);
  CHECK_EQUAL(0U, sut->health().poses_lost);
}

TEST(ArmLinkPoseSource, AControllerThatFallsSilentIsLostAndThenCalledAgain) {
  RawController robot;
  const auto sut = started(robot.listener.port);
  robot.take_caller(*sut);
  robot.say(arm_link::encode(1, state_at(0, 5s)));
  static_cast<void>(next(*sut));
  // The same instant for ever is silence, too.
  std::uint32_t number = 1;
  while (sut->health().state == PoseState::Streaming) {
    robot.say(arm_link::encode(++number, state_at(0, 5s)));
    static_cast<void>(sut->next_pose(1ms));
  }
  CHECK(sut->health().state == PoseState::Lost);
  wait_for_fault(*sut, "tells no state");
}

}  // namespace biteline::hal
