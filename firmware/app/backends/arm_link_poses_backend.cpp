// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/arm_link_poses/arm_link_pose_source.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::PoseSource>> told_states(const hal::BoardPoses& board, const hal::Clock&) {
  return hal::ArmLinkPoseSource::open({.controller = {.address = board.address, .port = board.port}});
}

}  // namespace

extern const Backend k_arm_link_poses_backend;
const Backend k_arm_link_poses_backend{.name = "arm_link_poses", .poses = told_states};

}  // namespace biteline::sensor
