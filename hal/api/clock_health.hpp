// SPDX-License-Identifier: MIT
#pragma once
/// \file How another device's clock lies on the sensor's, as far as it is known.

#include <cstdint>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct ClockHealth {
  bool known{false};
  Nanoseconds offset{0};       ///< sensor clock minus the other
  Nanoseconds uncertainty{0};  ///< of the offset; a constant delay that nobody can see from here is not in it
  double drift_ppm{0};
  std::uint64_t steps{0};  ///< times that the other clock jumped
};

/// A clock that others are disciplined to and that can be read here, such as a network card's.
/// Thread: one owner.
class ReferenceClock {
 public:
  ReferenceClock() = default;
  virtual ~ReferenceClock() = default;

  struct Reading {
    Nanoseconds offset{0};       ///< the clock minus the sensor's
    Nanoseconds uncertainty{0};  ///< the truth lies within
    SensorClock::time_point at;
  };
  [[nodiscard]] virtual Result<Reading> measure() const = 0;

 protected:
  ReferenceClock(ReferenceClock&&) = default;
  ReferenceClock& operator=(ReferenceClock&&) = default;
};

}  // namespace biteline::hal
