// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_safety_in.hpp"

namespace biteline::hal {

Result<std::unique_ptr<GpiodSafetyIn>> GpiodSafetyIn::open(const Config& config) {
  BITELINE_ASSIGN(Descriptor interlock, request_line(config.interlock, GpioDirection::Input));
  Descriptor key;
  if (config.key) {
    BITELINE_ASSIGN(key, request_line(*config.key, GpioDirection::Input));
  }
  return std::unique_ptr<GpiodSafetyIn>{new GpiodSafetyIn{std::move(interlock), std::move(key)}};
}

Result<SafetyInputs> GpiodSafetyIn::read() noexcept {
  SafetyInputs inputs{.interlock_closed = false, .key_on = true, .read_at = monotonic_now()};
  BITELINE_ASSIGN(inputs.interlock_closed, read_line(interlock_.number(), "interlock"));
  if (key_.is_open()) {
    BITELINE_ASSIGN(inputs.key_on, read_line(key_.number(), "key"));
  }
  return inputs;
}

}  // namespace biteline::hal
