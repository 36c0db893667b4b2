// SPDX-License-Identifier: MIT
#pragma once
/// \file Position of a CANopen encoder (CiA 406, object 6004h) from its process data object.

#include <cstdint>
#include <optional>
#include <span>

#include "common/core/result.hpp"

namespace biteline::canpose {

/// TPDO1 of node n, CiA 301 predefined connection set.
[[nodiscard]] constexpr std::uint32_t tpdo1_id(std::uint8_t node) {
  return 0x180U + node;
}

/// The position value: 4 bytes little endian first in the object; more may follow (speed, alarms) and is left
/// alone.
[[nodiscard]] Result<std::uint32_t> decode_position(std::span<const std::uint8_t> data);

/// Makes one long count of a position that wraps at the encoder's measuring range.
/// Thread: one owner.
class PositionUnwrapper {
 public:
  /// `range_ticks`: object 6002h, the total measuring range; 0: all 32 bits.
  explicit PositionUnwrapper(std::uint32_t range_ticks) : range_ticks_{range_ticks} {}

  /// Ticks since the first call.  A value outside the range, or a step of more than a quarter of it, which no
  /// machine makes between two objects, is refused and counted; the second such value in a row is believed as
  /// a new place.
  std::optional<std::int64_t> feed(std::uint32_t position_ticks);

  [[nodiscard]] std::int64_t position_ticks() const { return total_ticks_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::int64_t range() const {
    return range_ticks_ == 0 ? std::int64_t{1} << 32 : std::int64_t{range_ticks_};
  }

  std::uint32_t range_ticks_;
  std::optional<std::uint32_t> last_ticks_;
  bool last_was_refused_{false};
  std::int64_t total_ticks_{0};
  std::uint64_t refused_{0};
};

}  // namespace biteline::canpose
