// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/pwm/sysfs_pwm.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::PwmOut>> timer(const hal::BoardTrigger& trigger) {
  return hal::SysfsPwm::open({.chip = trigger.chip, .channel = trigger.channel});
}

}  // namespace

extern const Backend k_pwm_backend;
const Backend k_pwm_backend{.name = "pwm", .timer = timer};

}  // namespace biteline::sensor
