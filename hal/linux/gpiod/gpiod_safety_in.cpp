// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_safety_in.hpp"

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

Result<std::unique_ptr<GpiodSafetyIn>> GpiodSafetyIn::open(const Config& config) {
  BITELINE_ASSIGN(GpiodLine interlock, GpiodLine::request_input(config.interlock));
  std::optional<GpiodLine> key;
  if (config.key) {
    BITELINE_ASSIGN(key, GpiodLine::request_input(*config.key));
  }
  return std::unique_ptr<GpiodSafetyIn>{new GpiodSafetyIn{std::move(interlock), std::move(key)}};
}

Result<SafetyInputs> GpiodSafetyIn::read() noexcept {
  SafetyInputs inputs{.interlock_closed = false, .key_on = true, .read_at = monotonic_now()};
  BITELINE_ASSIGN(inputs.interlock_closed, interlock_.read());
  if (key_) {
    BITELINE_ASSIGN(inputs.key_on, key_->read());
  }
  return inputs;
}

}  // namespace biteline::hal
