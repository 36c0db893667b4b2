// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/line_request.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/gpio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>

namespace biteline::hal {
namespace {

struct Chip {
  Descriptor device;
  std::uint32_t lines{0};
};

Result<Chip> open_chip(const std::string& path, gpiochip_info& info) {
  BITELINE_ASSIGN(Descriptor device, open_device(path.c_str(), O_RDWR));
  if (retrying_ioctl(device.number(), GPIO_GET_CHIPINFO_IOCTL, &info) < 0) {
    return device_failure(errno, path.c_str(), "is no GPIO chip");
  }
  return Chip{.device = std::move(device), .lines = info.lines};
}

Result<Chip> find_chip(const std::string& chip) {
  gpiochip_info info{};
  if (chip.starts_with('/')) return open_chip(chip, info);
  const std::unique_ptr<DIR, int (*)(DIR*)> folder{::opendir("/dev"), &::closedir};
  while (folder) {
    const dirent* entry = ::readdir(folder.get());
    if (entry == nullptr) break;
    if (std::strncmp(entry->d_name, "gpiochip", 8) != 0) continue;
    Result<Chip> candidate = open_chip(std::string{"/dev/"} + entry->d_name, info);
    if (candidate && (chip == info.label || chip == info.name)) return candidate;
  }
  return fail(Errc::DeviceNotFound, "GPIO chip %.100s", chip.c_str());
}

Result<std::uint32_t> find_line(const Chip& chip, const GpioLineAddress& address) {
  std::uint32_t offset = 0;
  const char* const last = address.line.data() + address.line.size();
  const auto [end, fault] = std::from_chars(address.line.data(), last, offset);
  if (fault == std::errc{} && end == last) {
    if (offset < chip.lines) return offset;
  } else {
    for (offset = 0; offset < chip.lines; ++offset) {
      gpio_v2_line_info info{};
      info.offset = offset;
      if (retrying_ioctl(chip.device.number(), GPIO_V2_GET_LINEINFO_IOCTL, &info) < 0) continue;
      if (address.line == info.name) return offset;
    }
  }
  return fail(Errc::DeviceNotFound, "GPIO line %.60s of %.60s", address.line.c_str(), address.chip.c_str());
}

std::uint64_t flags_of(const GpioLineAddress& address, GpioDirection direction) {
  std::uint64_t flags = 0;
  switch (direction) {
    case GpioDirection::Output:
      flags = GPIO_V2_LINE_FLAG_OUTPUT;
      break;
    case GpioDirection::Input:
      flags = GPIO_V2_LINE_FLAG_INPUT;
      break;
    case GpioDirection::InputEdges:  // stamps on CLOCK_MONOTONIC, the default clock of the interface
      flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
      break;
  }
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

Result<Descriptor> request_line(const GpioLineAddress& address, GpioDirection direction) {
  BITELINE_ASSIGN(const Chip chip, find_chip(address.chip));
  BITELINE_ASSIGN(const std::uint32_t offset, find_line(chip, address));
  gpio_v2_line_request request{};
  request.offsets[0] = offset;
  request.num_lines = 1;
  request.event_buffer_size = direction == GpioDirection::InputEdges ? k_gpio_event_queue : 0;
  request.config.flags = flags_of(address, direction);
  std::snprintf(request.consumer, sizeof request.consumer, "biteline");
  if (retrying_ioctl(chip.device.number(), GPIO_V2_GET_LINE_IOCTL, &request) < 0) {
    return device_failure(errno, address.line.c_str(),
                          errno == EBUSY ? "held by another process" : "request line");
  }
  return Descriptor{request.fd};
}

Result<bool> read_line(int request, const char* name) noexcept {
  gpio_v2_line_values values{.bits = 0, .mask = 1};
  if (retrying_ioctl(request, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) < 0) {
    return device_failure(errno, name, "read level");
  }
  return (values.bits & 1U) != 0;
}

}  // namespace biteline::hal
