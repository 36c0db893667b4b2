// SPDX-License-Identifier: MIT
#pragma once
/// \file One GPIO line by libgpiod 1.6: found on its chip, asked for, set and read.

#include <cstdint>
#include <memory>
#include <string>

#include "common/core/result.hpp"
#include "hal/api/gpio_line.hpp"

struct gpiod_chip;
struct gpiod_line;

namespace biteline::hal {

struct CloseGpiodChip {
  void operator()(gpiod_chip* chip) const noexcept;
};

/// A line of a chip, not asked for yet.
struct FoundLine {
  std::unique_ptr<gpiod_chip, CloseGpiodChip> chip;
  gpiod_line* line{nullptr};  ///< the chip's

  [[nodiscard]] std::string device() const;  ///< "/dev/gpiochip0"
  [[nodiscard]] std::uint32_t offset() const;
};

/// Errc::DeviceNotFound: no such chip or line.
[[nodiscard]] Result<FoundLine> find_line(const GpioLineAddress& address);

/// A line that is ours until the end of this object, then the driver's affair.
class GpiodLine {
 public:
  /// Outputs start inactive.  Errc::DeviceNotFound: no such chip or line; Errc::DeviceError with EBUSY:
  /// another process holds it.
  [[nodiscard]] static Result<GpiodLine> request_output(const GpioLineAddress& address);
  [[nodiscard]] static Result<GpiodLine> request_input(const GpioLineAddress& address);

  /// true: active.  No heap, no lock: one ioctl each.
  [[nodiscard]] Result<void> set(bool active) noexcept;
  [[nodiscard]] Result<bool> read() const noexcept;

 private:
  GpiodLine(FoundLine found, const std::string& name) : found_{std::move(found)}, name_{name} {}
  [[nodiscard]] static Result<GpiodLine> request(const GpioLineAddress& address, bool output);

  FoundLine found_;
  std::string name_;
};

}  // namespace biteline::hal
