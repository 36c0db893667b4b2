// SPDX-License-Identifier: MIT
#pragma once
/// \file What may be done to the wires, the camera and the pose bus of a running cell.

#include <atomic>
#include <cstdint>

namespace biteline::sim {

/// Of tests and soak runs; a cell begins without any.  Thread: any.
struct CellFaults {
  std::atomic<int> edges_to_lose{0};       ///< the train skips so many pulses: neither frame nor echo
  std::atomic<int> edges_to_double{0};     ///< a second pulse 0.8 ms after the first
  std::atomic<int> echoes_to_lose{0};      ///< the frame comes, its echo does not
  std::atomic<bool> camera_silent{false};  ///< triggers do not reach the camera
  std::atomic<bool> bus_off{false};        ///< nothing gets through on the pose bus
  std::atomic<bool> sync_stopped{false};
  std::atomic<bool> poses_silent{false};
  std::atomic<std::int64_t> robot_clock_step_ns{0};
  std::atomic<int> poses_from_future{0};  ///< so many SYNCs stamped an hour ahead
};

/// Uses one of `fault` up, where there is one.
[[nodiscard]] inline bool due(std::atomic<int>& fault) {
  return fault > 0 && fault.fetch_sub(1) > 0;
}

}  // namespace biteline::sim
