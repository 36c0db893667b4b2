// SPDX-License-Identifier: MIT
#pragma once
/// \file What every PoseSource must do, its peer at work or not.

#include <CppUTest/TestHarness.h>

#include <functional>

#include "hal/api/pose_source.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

/// `let_peer_work` is called before each wait: what stands for the controller sends its next pose.
inline void check_pose_source(hal::PoseSource& sut, const std::function<void()>& let_peer_work) {
  CHECK(sut.next_pose(0ns).error().code == Errc::WrongState);
  CHECK(sut.stop().has_value());
  CHECK(sut.health().state == hal::PoseState::Idle);
  CHECK(sut.start().has_value());
  CHECK(sut.start().error().code == Errc::WrongState);

  std::optional<hal::RobotPose> last;
  int poses = 0;
  constexpr int k_poses = 50;
  for (int i = 0; i < 100 * k_poses && poses < k_poses; ++i) {
    let_peer_work();
    const Result<hal::RobotPose> pose = sut.next_pose(5ms);
    if (!pose) {
      CHECK(pose.error().code == Errc::Timeout);
      continue;
    }
    ++poses;
    const Mat3 R = pose->T_base_flange.linear();
    DOUBLES_EQUAL(0.0, (R * R.transpose() - Mat3::Identity()).norm(), 1e-9);
    if (last) {
      CHECK(pose->stamp > last->stamp);
      CHECK(pose->sequence > last->sequence);
      CHECK(pose->received >= last->received);
    }
    last = *pose;
  }
  CHECK_EQUAL(k_poses, poses);
  const hal::PoseHealth health = sut.health();
  CHECK(health.poses >= k_poses);
  CHECK(health.state == hal::PoseState::Streaming || health.state == hal::PoseState::Finished);
  CHECK(sut.stop().has_value());
  CHECK(sut.next_pose(0ns).error().code == Errc::WrongState);
}

}  // namespace biteline::conformance
