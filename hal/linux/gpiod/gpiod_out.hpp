// SPDX-License-Identifier: MIT
#pragma once
/// \file GpioOut on a line of libgpiod.

#include <memory>
#include <utility>

#include "hal/api/gpio_out.hpp"
#include "hal/linux/gpiod/gpiod_line.hpp"

namespace biteline::hal {

/// When the process ends in any way, SIGKILL included, most kernels give the line back to its pull; i.MX's
/// and Raspberry Pi's leave it as it was (boards/README.md, heartbeat).
class GpiodOut final : public GpioOut {
 public:
  [[nodiscard]] static Result<std::unique_ptr<GpiodOut>> open(const GpioLineAddress& address);
  ~GpiodOut() override;

  [[nodiscard]] Result<void> set(bool active) noexcept override;
  [[nodiscard]] Result<bool> read_back() noexcept override;

 private:
  explicit GpiodOut(GpiodLine line) : line_{std::move(line)} {}

  GpiodLine line_;
};

}  // namespace biteline::hal
