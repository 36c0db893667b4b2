// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/rtde/rtde_pose_source.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::PoseSource>> poses(const hal::BoardPoses& board, const hal::Clock&) {
  hal::RtdePoseSource::Config config;
  config.controller = {.address = board.address, .port = board.port};
  config.samples.rate_hz = board.rate_hz;
  return hal::RtdePoseSource::open(config);
}

}  // namespace

extern const Backend k_rtde_backend;
const Backend k_rtde_backend{.name = "rtde", .poses = poses};

}  // namespace biteline::sensor
