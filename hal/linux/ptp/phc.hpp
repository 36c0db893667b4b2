// SPDX-License-Identifier: MIT
#pragma once
/// \file A PTP hardware clock against the sensor's clock.
///
/// The network card's clock follows the grandmaster (ptp4l); cameras and controllers that follow it too stamp
/// in its time.  What the sensor needs is the clock's offset from CLOCK_MONOTONIC, and how sure that is.

#include <memory>
#include <string>

#include "hal/api/clock_health.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

/// Thread: one owner.
class Phc final : public ReferenceClock {
 public:
  [[nodiscard]] static Result<Phc> open(const std::string& path);

  /// Reads the hardware clock between two readings of CLOCK_MONOTONIC, several times, and keeps the tightest;
  /// half the time that one took is its uncertainty. Not PTP_SYS_OFFSET: its system stamps are
  /// CLOCK_REALTIME, which may step.
  [[nodiscard]] Result<Reading> measure() const override;

 private:
  Phc(Descriptor device, std::string path) : device_{std::move(device)}, path_{std::move(path)} {}

  Descriptor device_;
  std::string path_;
};

}  // namespace biteline::hal
