// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "firmware/runtime/thread_table.hpp"
#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/linux/ptp/phc.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::LineCamera>> camera(const hal::Board& board, bool realtime) {
  hal::AravisCamera::Config config;
  config.address = board.camera.address;
  config.packet_bytes = board.camera.packet_bytes;
  config.packet_socket = board.camera.packet_socket;
  config.receive_priority = realtime ? runtime::threads::k_receive.priority : 0;
  if (!board.ptp.empty()) {
    BITELINE_ASSIGN(hal::Phc clock, hal::Phc::open(board.ptp));
    BITELINE_TRY(clock.measure());
    config.ptp_clock = std::make_shared<hal::Phc>(std::move(clock));
  }
  return hal::AravisCamera::open(config);
}

}  // namespace

extern const Backend k_aravis_backend;
const Backend k_aravis_backend{.name = "aravis", .camera = camera};

}  // namespace biteline::sensor
