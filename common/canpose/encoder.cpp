// SPDX-License-Identifier: MIT
#include "common/canpose/encoder.hpp"

#include <cstdlib>

namespace biteline::canpose {

Result<std::uint32_t> decode_position(std::span<const std::uint8_t> data) {
  if (data.size() < 4)
    return fail(Errc::ProtocolError, "CiA 406 position: %zu bytes, 4 expected", data.size());
  return static_cast<std::uint32_t>(data[0]) | static_cast<std::uint32_t>(data[1]) << 8U |
         static_cast<std::uint32_t>(data[2]) << 16U | static_cast<std::uint32_t>(data[3]) << 24U;
}

std::optional<std::int64_t> PositionUnwrapper::feed(std::uint32_t position_ticks) {
  if (position_ticks >= range()) {
    ++refused_;
    return std::nullopt;
  }
  if (!last_ticks_) {
    last_ticks_ = position_ticks;
    return total_ticks_;
  }
  std::int64_t step = std::int64_t{position_ticks} - std::int64_t{*last_ticks_};
  if (step > range() / 2) step -= range();
  if (step < -range() / 2) step += range();
  if (std::abs(step) > range() / 4 && !last_was_refused_) {
    ++refused_;
    last_was_refused_ = true;
    return std::nullopt;
  }
  last_was_refused_ = false;
  last_ticks_ = position_ticks;
  total_ticks_ += step;
  return total_ticks_;
}

}  // namespace biteline::canpose
