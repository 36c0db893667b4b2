// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_out.hpp"

#include <utility>

namespace biteline::hal {

Result<std::unique_ptr<GpiodOut>> GpiodOut::open(const GpioLineAddress& address) {
  BITELINE_ASSIGN(GpiodLine line, GpiodLine::request_output(address));
  return std::unique_ptr<GpiodOut>{new GpiodOut{std::move(line)}};
}

GpiodOut::~GpiodOut() {
  // Released lines keep their last level on some chips; the level that is left behind must be the inactive
  // one.
  static_cast<void>(set(false));
}

Result<void> GpiodOut::set(bool active) noexcept {
  return line_.set(active);
}

Result<bool> GpiodOut::read_back() noexcept {
  return line_.read();
}

}  // namespace biteline::hal
