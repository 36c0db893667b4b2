// SPDX-License-Identifier: MIT
#pragma once
/// \file What runs over the simulated wires: levels of lines, the trigger's settings, frames of the pose bus.
///
/// Both ends are builds of the same source on one machine: a message is its bytes.

#include <cstdint>
#include <type_traits>

#include "hal/api/can_bus.hpp"

namespace biteline::sim {

/// The wires between sensor, laser, camera, robot and door.
enum class Line : std::uint32_t {
  LaserEnable,  ///< sensor -> laser; inactive when nobody drives it
  StrobeEcho,   ///< camera -> sensor: exposure is on
  ScanActive,   ///< robot -> sensor: the arm is on its way round the shoe
  Interlock,    ///< door -> sensor and laser: closed
  Key,          ///< key switch -> sensor and laser: on
  TooHot,       ///< the head's thermal contact -> sensor
  Heartbeat,    ///< sensor -> monostable before the laser
  Count,
};

[[nodiscard]] constexpr std::uint32_t bit_of(Line line) {
  return 1U << static_cast<std::uint32_t>(line);
}

struct BusMessage {
  enum class Kind : std::uint32_t {
    Subscribe,  ///< client: `lines` (bits) and `wants_can` from now on
    Drive,      ///< client: `line` is `active` until it says otherwise or goes
    Query,      ///< client: the level of `line`, please
    Level,      ///< cell: answer to Drive and Query
    Edge,       ///< cell: `line` changed at `stamp`
    Trigger,    ///< client: pulse train of `period` and `pulse`; period 0 stops it
    Can,        ///< either: one frame
  };
  Kind kind{Kind::Query};
  Line line{Line::LaserEnable};
  std::uint32_t lines{0};
  bool active{false};
  bool wants_can{false};
  std::uint64_t sequence{0};  ///< of the line's edges
  std::int64_t stamp_ns{0};   ///< this machine's monotonic clock
  std::int64_t period_ns{0};
  std::int64_t pulse_ns{0};
  hal::CanFrame can{};
};
static_assert(std::is_trivially_copyable_v<BusMessage>);

}  // namespace biteline::sim
