// SPDX-License-Identifier: MIT
#pragma once
/// \file PwmOut on a hardware timer through /sys/class/pwm.
///
/// The train runs on when the process is killed: whatever it drives must be gated by an enable line that
/// falls back to its pull (GpiodOut), see boards/README.md.

#include <memory>
#include <string>

#include "hal/api/pwm_out.hpp"

namespace biteline::hal {

class SysfsPwm final : public PwmOut {
 public:
  struct Config {
    std::string chip;  ///< "pwmchip0", or its device's name ("fe20c000.pwm"), which is stable
    int channel{0};
    std::string root{"/sys/class/pwm"};  ///< elsewhere in tests
  };
  /// Exports the channel if it is not, and stops a train that a killed process left running.
  [[nodiscard]] static Result<std::unique_ptr<SysfsPwm>> open(const Config& config);
  ~SysfsPwm() override;

  /// Sysfs tells what was asked and not what the divider made: a driver that cannot come near says so itself
  /// (BadValue).
  [[nodiscard]] Result<PwmSettings> configure(const PwmSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<void> stop() noexcept override;
  [[nodiscard]] bool running() const noexcept override { return running_; }

 private:
  explicit SysfsPwm(std::string folder) : folder_{std::move(folder)} {}
  Result<void> write(const char* attribute, std::int64_t value) const;
  [[nodiscard]] Result<std::int64_t> read(const char* attribute) const;

  std::string folder_;
  bool configured_{false};
  bool running_{false};
};

}  // namespace biteline::hal
