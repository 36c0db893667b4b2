// SPDX-License-Identifier: MIT
// GPIO backends on gpio-sim, and on the PL061 of the emulated board.
#include <CppUTest/TestHarness.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "hal/linux/gpiod/gpiod_edge_in.hpp"
#include "hal/linux/gpiod/gpiod_out.hpp"
#include "hal/linux/gpiod/gpiod_safety_in.hpp"
#include "hal/linux/pwm/software_pwm.hpp"
#include "hal/timing/edge_grid.hpp"
#include "tests/hal/conformance/lines.hpp"
#include "tests/hal/conformance/pwm_out.hpp"
#include "tests/hal/kernel/gpio_sim.hpp"
#include "tests/hal/kernel/skip.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
using test::GpioSim;

GpioLineAddress line(int number, bool active_low = false) {
  return {.chip = GpioSim::k_label, .line = std::to_string(number), .active_low = active_low};
}

TEST_GROUP(GpioKernel){};

TEST(GpioKernel, OutputConforms) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  conformance::check_gpio_out(GpiodOut::open(line(0)).value(), [&] { return sim.value(0); });
}

TEST(GpioKernel, ActiveLowOutputConforms) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  sim.pull(1, true);  // the pull that keeps an active-low output inactive
  conformance::check_gpio_out(GpiodOut::open(line(1, true)).value(), [&] { return !sim.value(1); });
}

TEST(GpioKernel, EdgesConform) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto sut = GpiodEdgeIn::open(line(3)).value();
  conformance::check_edge_in(*sut, [&](bool level) { sim.pull(3, level); });
}

TEST(GpioKernel, ActiveLowEdgesConform) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  sim.pull(3, true);
  const auto sut = GpiodEdgeIn::open(line(3, true)).value();
  conformance::check_edge_in(*sut, [&](bool active) { sim.pull(3, !active); });
}

TEST(GpioKernel, LineIsFoundByItsName) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto sut = GpiodOut::open({.chip = GpioSim::k_label, .line = "laser-enable"}).value();
  CHECK(sut->set(true).has_value());
  CHECK(sim.value(2));
}

TEST(GpioKernel, WrongAddressAndBusyLineAreSaid) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  CHECK(GpiodOut::open({.chip = "no-such-chip", .line = "0"}).error().code == Errc::DeviceNotFound);
  CHECK(GpiodOut::open({.chip = GpioSim::k_label, .line = "no-such-line"}).error().code ==
        Errc::DeviceNotFound);
  CHECK(GpiodOut::open(line(GpioSim::k_lines)).error().code == Errc::DeviceNotFound);
  const auto holder = GpiodOut::open(line(0)).value();
  CHECK_EQUAL(EBUSY, GpiodOut::open(line(0)).error().sys_errno);
}

TEST(GpioKernel, EdgesThatTheQueueCouldNotHoldAreCounted) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto sut = GpiodEdgeIn::open(line(3)).value();
  for (std::uint32_t i = 0; i < k_gpio_event_queue + 300; ++i) {
    sim.pull(3, i % 2 == 0);
    std::this_thread::sleep_for(100us);  // time for the kernel's thread, which merges edges that come faster
  }
  std::uint64_t last_sequence = 0;
  while (const Result<Edge> edge = sut->next_edge(10ms)) last_sequence = edge->sequence;
  CHECK(sut->health().edges_lost > 0);
  CHECK_EQUAL(last_sequence, sut->health().edges + sut->health().edges_lost);
}

TEST(GpioKernel, EdgesThatTheKernelMergedAreCounted) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto sut = GpiodEdgeIn::open(line(3)).value();
  for (int i = 0; i < 400; ++i) sim.pull(3, i % 2 == 0);
  std::optional<bool> last_rising;
  std::uint64_t last_sequence = 0;
  while (const Result<Edge> edge = sut->next_edge(10ms)) {
    // The same way twice is a number left out: what is numbered without a gap alternates.
    if (last_rising && edge->sequence == last_sequence + 1) CHECK(edge->rising != *last_rising);
    last_rising = edge->rising;
    last_sequence = edge->sequence;
  }
  CHECK_EQUAL(last_sequence, sut->health().edges + sut->health().edges_lost);
}

TEST(GpioKernel, KilledProcessLeavesTheLaserDark) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto enable = GpiodOut::open(line(0));
    if (enable) static_cast<void>((*enable)->set(true));
    while (true) ::pause();
  }
  for (int i = 0; i < 2000 && !sim.value(0); ++i) std::this_thread::sleep_for(1ms);
  CHECK(sim.value(0));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK_FALSE(sim.value(0));  // the kernel gave the line back to its pull before wait() returned
}

TEST(GpioKernel, CutInterlockReadsOpen) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto sut = GpiodSafetyIn::open({.interlock = line(4), .key = line(5)}).value();
  sim.pull(4, true);
  sim.pull(5, true);
  CHECK(sut->read()->interlock_closed);
  CHECK(sut->read()->key_on);
  sim.pull(4, false);
  CHECK_FALSE(sut->read()->interlock_closed);
  sim.pull(5, false);
  CHECK_FALSE(sut->read()->key_on);
}

TEST(GpioKernel, LineOfAChipThatWentAwayIsLost) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  const auto output = GpiodOut::open(line(0)).value();
  const auto safety = GpiodSafetyIn::open({.interlock = line(4), .key = {}}).value();
  sim.unplug();
  CHECK(output->set(true).error().code == Errc::DeviceLost);
  CHECK(safety->read().error().code == Errc::DeviceLost);
}

TEST(GpioKernel, SoftwareTrainConformsAndItsEdgesAreAllThere) {
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim sim;
  SoftwarePwm sut{GpiodOut::open(line(0)).value(), {.priority = 40, .require_real_time = false}};
  conformance::check_pwm_out(sut);
  CHECK_FALSE(sut.hardware_timed());

  CHECK(sut.configure({.period = 10ms, .pulse = 1ms}).has_value());
  CHECK(sut.start().has_value());
  while (sut.pulse_health().pulses + sut.pulse_health().slots_skipped < 20) std::this_thread::sleep_for(1ms);
  CHECK(sut.stop().has_value());
  CHECK_EQUAL(0, sut.line_faults());
  CHECK_FALSE(sim.value(0));
}

TEST(GpioKernel, BoardsOwnControllerTakesAnOutput) {
  // The PL061 of qemu's virt board, line 3 is its power key.
  BITELINE_DEVICE_OR_SKIP("/sys/bus/amba/devices/9030000.pl061");
  const auto sut = GpiodOut::open({.chip = "9030000.pl061", .line = "5"}).value();
  CHECK(sut->set(true).has_value());
  CHECK(sut->read_back().value());
  CHECK(sut->set(false).has_value());
  CHECK_FALSE(sut->read_back().value());
}

}  // namespace
}  // namespace biteline::hal
