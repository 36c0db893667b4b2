// SPDX-License-Identifier: MIT
#pragma once
/// \file A quadrature counter: a conveyor or a turntable under the shoe.

#include <cstdint>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct EncoderReading {
  std::int64_t position_ticks{0};  ///< since open(), does not wrap
  SensorClock::time_point stamp;   ///< when it was latched
  std::uint64_t errors{0};  ///< illegal transitions so far: the position is off by as many ticks at most
};

/// Counting from open() to the end of the object.  Thread: any.  RT: one read, no allocation.
class EncoderIn {
 public:
  EncoderIn() = default;
  EncoderIn(const EncoderIn&) = delete;
  EncoderIn& operator=(const EncoderIn&) = delete;
  virtual ~EncoderIn() = default;

  [[nodiscard]] virtual Result<EncoderReading> read() noexcept = 0;
};

}  // namespace biteline::hal
