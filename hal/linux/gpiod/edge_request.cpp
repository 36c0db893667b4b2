// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/edge_request.hpp"

#include <fcntl.h>
#include <linux/gpio.h>

#include <cerrno>
#include <cstdio>

#include "hal/linux/gpiod/gpiod_line.hpp"

namespace biteline::hal {
namespace {

std::uint64_t flags_of(const GpioLineAddress& address) {
  std::uint64_t flags =
      GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
  if (address.active_low) flags |= GPIO_V2_LINE_FLAG_ACTIVE_LOW;
  switch (address.bias) {
    case GpioLineAddress::Bias::AsIs:
      break;
    case GpioLineAddress::Bias::PullUp:
      flags |= GPIO_V2_LINE_FLAG_BIAS_PULL_UP;
      break;
    case GpioLineAddress::Bias::PullDown:
      flags |= GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN;
      break;
    case GpioLineAddress::Bias::Disabled:
      flags |= GPIO_V2_LINE_FLAG_BIAS_DISABLED;
      break;
  }
  return flags;
}

}  // namespace

Result<Descriptor> request_edges(const GpioLineAddress& address) {
  BITELINE_ASSIGN(const FoundLine found, find_line(address));
  BITELINE_ASSIGN(const Descriptor chip, open_device(found.device().c_str(), O_RDWR));
  gpio_v2_line_request request{};
  request.offsets[0] = found.offset();
  request.num_lines = 1;
  request.event_buffer_size = k_gpio_event_queue;
  request.config.flags = flags_of(address);
  std::snprintf(request.consumer, sizeof request.consumer, "biteline");
  if (retrying_ioctl(chip.number(), GPIO_V2_GET_LINE_IOCTL, &request) < 0) {
    return device_failure(errno, address.line.c_str(),
                          errno == EBUSY ? "held by another process" : "request edges");
  }
  return Descriptor{request.fd};
}

Result<bool> read_level(int request, const char* name) noexcept {
  gpio_v2_line_values values{.bits = 0, .mask = 1};
  if (retrying_ioctl(request, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) < 0) {
    return device_failure(errno, name, "read level");
  }
  return (values.bits & 1U) != 0;
}

}  // namespace biteline::hal
