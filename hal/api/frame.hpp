// SPDX-License-Identifier: MIT
#pragma once
/// \file One camera frame, borrowed from its backend.

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time/clocks.hpp"

namespace biteline::hal {

enum FrameFlag : std::uint32_t {
  k_frame_damaged = 1U << 0U,           ///< the driver marked it, or packets are missing
  k_frame_gap_before = 1U << 1U,        ///< sequence numbers were skipped just before it
  k_frame_stamp_uncertain = 1U << 2U,   ///< exposure_mid is an estimate (arrival time, no trigger edge)
  k_frame_trigger_mismatch = 1U << 3U,  ///< no trigger edge pairs with it, or two do
  k_frame_laser_off = 1U << 4U,         ///< exposed with the laser off (ambient picture)
  k_frame_second_exposure = 1U << 5U,   ///< the longer exposure of a bracket
};

/// 8-bit grey, row-major.  Valid until given back to the camera that lent it.
struct FrameView {
  std::span<const std::uint8_t> pixels;  ///< stride_bytes * height_px
  int width_px{0};
  int height_px{0};
  int first_row_px{0};  ///< of the configured region that it shows
  std::size_t stride_bytes{0};
  std::uint64_t sequence{0};  ///< the camera's own count; gaps are losses
  SensorClock::time_point exposure_mid;
  std::uint32_t flags{0};  ///< FrameFlag
};

}  // namespace biteline::hal
