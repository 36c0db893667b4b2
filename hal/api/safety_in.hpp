// SPDX-License-Identifier: MIT
#pragma once
/// \file What the outside world allows the laser: interlock, key switch.

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

struct SafetyInputs {
  bool interlock_closed{false};  ///< guard door, remote interlock connector (IEC 60825-1)
  bool key_on{false};            ///< true on heads without a key switch
  bool too_hot{false};           ///< the laser's or the head's limit; false on heads without a sensor for it
  SensorClock::time_point read_at;
};

/// Thread: any.  RT: one or two reads, no allocation.  An Error means unknown, and unknown means open.
class SafetyIn {
 public:
  SafetyIn() = default;
  SafetyIn(const SafetyIn&) = delete;
  SafetyIn& operator=(const SafetyIn&) = delete;
  virtual ~SafetyIn() = default;

  [[nodiscard]] virtual Result<SafetyInputs> read() noexcept = 0;
};

}  // namespace biteline::hal
