// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_line.hpp"

#include <dirent.h>
#include <gpiod.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

using Chip = std::unique_ptr<gpiod_chip, CloseGpiodChip>;

Result<Chip> find_chip(const std::string& chip) {
  if (chip.starts_with('/')) {
    Chip opened{gpiod_chip_open(chip.c_str())};
    if (!opened) return device_failure(errno, chip.c_str(), "open as GPIO chip");
    return opened;
  }
  // Not gpiod_chip_open_lookup(): that gives up at the first chip which it may not open.
  const std::unique_ptr<DIR, int (*)(DIR*)> folder{::opendir("/dev"), &::closedir};
  while (folder) {
    const dirent* entry = ::readdir(folder.get());
    if (entry == nullptr) break;
    if (std::strncmp(entry->d_name, "gpiochip", 8) != 0) continue;
    Chip candidate{gpiod_chip_open_by_name(entry->d_name)};
    if (candidate && (chip == gpiod_chip_label(candidate.get()) || chip == gpiod_chip_name(candidate.get())))
      return candidate;
  }
  return fail(Errc::DeviceNotFound, "GPIO chip %.100s", chip.c_str());
}

int flags_of(const GpioLineAddress& address) {
  int flags = address.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  switch (address.bias) {
    case GpioLineAddress::Bias::AsIs:
      break;
    case GpioLineAddress::Bias::PullUp:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
      break;
    case GpioLineAddress::Bias::PullDown:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
      break;
    case GpioLineAddress::Bias::Disabled:
      flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
      break;
  }
  return flags;
}

}  // namespace

void CloseGpiodChip::operator()(gpiod_chip* chip) const noexcept {
  gpiod_chip_close(chip);  // gives its lines back, too
}

std::string FoundLine::device() const {
  return std::string{"/dev/"} + gpiod_chip_name(chip.get());
}

std::uint32_t FoundLine::offset() const {
  return gpiod_line_offset(line);
}

Result<FoundLine> find_line(const GpioLineAddress& address) {
  FoundLine found;
  BITELINE_ASSIGN(found.chip, find_chip(address.chip));
  std::uint32_t offset = 0;
  const char* const last = address.line.data() + address.line.size();
  const auto [end, fault] = std::from_chars(address.line.data(), last, offset);
  const bool is_number = fault == std::errc{} && end == last;
  if (!is_number) {
    found.line = gpiod_chip_find_line(found.chip.get(), address.line.c_str());
  } else if (offset < gpiod_chip_num_lines(found.chip.get())) {
    found.line = gpiod_chip_get_line(found.chip.get(), offset);
  }
  if (found.line == nullptr) {
    return fail(Errc::DeviceNotFound, "GPIO line %.60s of %.60s", address.line.c_str(), address.chip.c_str());
  }
  return found;
}

Result<GpiodLine> GpiodLine::request(const GpioLineAddress& address, bool output) {
  BITELINE_ASSIGN(FoundLine found, find_line(address));
  const int flags = flags_of(address);
  const int failed = output ? gpiod_line_request_output_flags(found.line, "biteline", flags, 0)
                            : gpiod_line_request_input_flags(found.line, "biteline", flags);
  if (failed != 0) {
    return device_failure(errno, address.line.c_str(),
                          errno == EBUSY ? "held by another process" : "request line");
  }
  return GpiodLine{std::move(found), address.line};
}

Result<GpiodLine> GpiodLine::request_output(const GpioLineAddress& address) {
  return request(address, true);
}

Result<GpiodLine> GpiodLine::request_input(const GpioLineAddress& address) {
  return request(address, false);
}

Result<void> GpiodLine::set(bool active) noexcept {
  int failed = 0;
  do {
    failed = gpiod_line_set_value(found_.line, active ? 1 : 0);
  } while (failed != 0 && errno == EINTR);
  if (failed != 0) return device_failure(errno, name_.c_str(), "set level");
  return {};
}

Result<bool> GpiodLine::read() const noexcept {
  int level = 0;
  do {
    level = gpiod_line_get_value(found_.line);
  } while (level < 0 && errno == EINTR);
  if (level < 0) return device_failure(errno, name_.c_str(), "read level");
  return level != 0;
}

}  // namespace biteline::hal
