// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/udp_poses/udp_pose_source.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::PoseSource>> poses(const hal::BoardPoses& board, const hal::Clock&) {
  using Language = hal::UdpPoseSource::Language;
  const bool egm = board.kind == hal::BoardPoses::Kind::Egm;
  return hal::UdpPoseSource::open({.language = egm ? Language::Egm : Language::Rsi,
                                   .controller = board.address,
                                   .port = board.port,
                                   .answers = board.answers});
}

}  // namespace

extern const Backend k_udp_poses_backend;
const Backend k_udp_poses_backend{.name = "udp_poses", .poses = poses};

}  // namespace biteline::sensor
