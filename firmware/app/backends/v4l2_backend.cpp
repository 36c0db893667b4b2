// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/v4l2/v4l2_camera.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::LineCamera>> camera(const hal::Board& board, bool) {
  return hal::V4l2Camera::open({.device = board.camera.device,
                                .control_device = board.camera.control_device,
                                .gain = board.camera.gain,
                                .readout = board.camera.readout,
                                .hardware_trigger = board.camera.hardware_trigger});
}

}  // namespace

extern const Backend k_v4l2_backend;
const Backend k_v4l2_backend{.name = "v4l2", .camera = camera};

}  // namespace biteline::sensor
