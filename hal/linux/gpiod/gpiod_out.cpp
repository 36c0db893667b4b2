// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_out.hpp"

#include <linux/gpio.h>

#include <cerrno>

namespace biteline::hal {

Result<std::unique_ptr<GpiodOut>> GpiodOut::open(const GpioLineAddress& address) {
  BITELINE_ASSIGN(Descriptor request, request_line(address, GpioDirection::Output));
  return std::unique_ptr<GpiodOut>{new GpiodOut{std::move(request), address.line}};
}

GpiodOut::~GpiodOut() {
  // Released lines keep their last level on some chips; the level that is left behind must be the inactive
  // one.
  static_cast<void>(set(false));
}

Result<void> GpiodOut::set(bool active) noexcept {
  gpio_v2_line_values values{.bits = active ? 1U : 0U, .mask = 1};
  if (retrying_ioctl(request_.number(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values) < 0) {
    return device_failure(errno, name_.c_str(), "set level");
  }
  return {};
}

Result<bool> GpiodOut::read_back() noexcept {
  return read_line(request_.number(), name_.c_str());
}

}  // namespace biteline::hal
