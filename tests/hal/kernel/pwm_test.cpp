// SPDX-License-Identifier: MIT
// sysfs PWM on the kernel's own driver (tests/vm gives it a block of registers).
#include <CppUTest/TestHarness.h>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/pwm/sysfs_pwm.hpp"
#include "tests/hal/conformance/pwm_out.hpp"
#include "tests/hal/kernel/skip.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

constexpr const char* k_chip = "/sys/class/pwm/pwmchip0";

TEST_GROUP(PwmKernel){};

TEST(PwmKernel, HardwareTrainConforms) {
  BITELINE_DEVICE_OR_SKIP(k_chip);
  const auto sut = SysfsPwm::open({.chip = "pwmchip0", .channel = 0}).value();
  conformance::check_pwm_out(*sut);
  CHECK(sut->hardware_timed());
}

TEST(PwmKernel, TrainLeftRunningIsStoppedByTheNextOpen) {
  BITELINE_DEVICE_OR_SKIP(k_chip);
  const auto killed =
      SysfsPwm::open({.chip = "pwmchip0", .channel = 1}).value().release();  // as if by SIGKILL
  CHECK(killed->configure({.period = 10ms, .pulse = 1ms}).has_value());
  CHECK(killed->start().has_value());
  CHECK_EQUAL(1, read_integer("/sys/class/pwm/pwmchip0/pwm1/enable").value());
  const auto sut = SysfsPwm::open({.chip = "pwmchip0", .channel = 1}).value();
  CHECK_EQUAL(0, read_integer("/sys/class/pwm/pwmchip0/pwm1/enable").value());
  delete killed;
}

TEST(PwmKernel, ChannelThatTheChipLacksIsRefused) {
  BITELINE_DEVICE_OR_SKIP(k_chip);
  CHECK_FALSE(SysfsPwm::open({.chip = "pwmchip0", .channel = 99}).has_value());
}

}  // namespace
}  // namespace biteline::hal
