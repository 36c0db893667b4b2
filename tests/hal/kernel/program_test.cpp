// SPDX-License-Identifier: MIT
// biteline-sensor itself on the devices of boards/qemu-virt, for a host on the network: a recorded session's
// pictures through V4L2, an arm on the pose bus, trigger and laser on their lines.  The host's half:
// tests/vm/scan_from_outside_test.cpp.
#include <CppUTest/TestHarness.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "tests/hal/kernel/gpio_sim.hpp"
#include "tests/hal/kernel/skip.hpp"
#include "tests/hal/kernel/vivid.hpp"
#include "tests/hal/kernel/world.hpp"

namespace biteline {
namespace {

using namespace std::chrono_literals;
using test::GpioSim;

std::string from_environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : std::string{"$"} + name;
}

std::vector<image::GreyImage> pictures_of(const session::Session& session) {
  std::vector<image::GreyImage> pictures;
  for (const session::FrameEntry& frame : session.frames)
    pictures.push_back(image::read_png(frame.file).value());
  return pictures;
}

pid_t start(std::vector<std::string> arguments) {
  std::vector<char*> raw;
  for (std::string& argument : arguments) raw.push_back(argument.data());
  raw.push_back(nullptr);
  pid_t pid = 0;
  CHECK_EQUAL(0, posix_spawn(&pid, raw[0], nullptr, nullptr, raw.data(), environ));
  return pid;
}

int wait_for(pid_t pid) {
  int raw = 0;
  waitpid(pid, &raw, 0);
  return WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
}

/// Nothing: it runs.
std::optional<int> status_of(pid_t pid) {
  int raw = 0;
  if (waitpid(pid, &raw, WNOHANG) != pid) return std::nullopt;
  return WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
}

TEST_GROUP(KernelProgram){};

TEST(KernelProgram, ServesAScanToAHostOutside) {
  const std::string folder = from_environment("BITELINE_SESSION");
  BITELINE_DEVICE_OR_SKIP(folder);
  BITELINE_DEVICE_OR_SKIP(from_environment("BITELINE_SENSOR"));
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const session::Session session = session::read_session(folder).value();
  const std::vector<image::GreyImage> pictures = pictures_of(session);
  const GpioSim gpio;
  const test::VividNodes nodes = test::find_vivid().value();
  test::loop_vivid(nodes, pictures[0].width_px, pictures[0].height_px);
  test::TriggerWire trigger{gpio};
  const auto paint = [&](std::uint32_t number, std::span<std::uint8_t> pixels) {
    const std::vector<std::uint8_t>& picture = pictures[number % pictures.size()].pixels;
    std::copy(picture.begin(), picture.end(), pixels.begin());
  };
  const test::PictureFeeder feeder{nodes, pictures[0].width_px, pictures[0].height_px, paint,
                                   [&] { trigger.on_frame(); }};
  const test::MovingArm arm;

  // Everything that the board names answers; only the plain kernel is not what a unit should have.
  const pid_t check = start({from_environment("BITELINE_SENSOR"), "--check", "--source",
                             "board:" + from_environment("BITELINE_BOARD")});
  const bool realtime = hal::read_integer("/sys/kernel/realtime").value_or(0) == 1;
  CHECK_EQUAL(static_cast<int>(realtime ? ExitStatus::Done : ExitStatus::Connection), wait_for(check));

  const pid_t sensor =
      start({from_environment("BITELINE_SENSOR"), "--source", "board:" + from_environment("BITELINE_BOARD"),
             "--sensor", folder + "/cam0/sensor.yaml", "--listen", "tcp://0.0.0.0:5555", "--keys",
             from_environment("BITELINE_KEYS"), "--rt=required"});
  // The door is closed for good; a request of the line sets its bias, so it is pulled again and again.
  bool lit = false;
  auto dark_since = std::chrono::steady_clock::now();
  std::optional<int> status;
  while (!status) {
    gpio.pull(GpioSim::k_interlock, true);
    std::this_thread::sleep_for(50ms);
    const auto now = std::chrono::steady_clock::now();
    if (gpio.value(GpioSim::k_laser_enable)) {
      lit = true;
      dark_since = now;
    }
    // The host has ended the scan, and got all of it meanwhile.
    if (lit && now - dark_since > 5s) ::kill(sensor, SIGTERM);
    status = status_of(sensor);
  }
  std::printf("program: the laser %s, %llu trigger pulses\n", lit ? "shone" : "stayed dark",
              static_cast<unsigned long long>(trigger.pulses()));
  CHECK_EQUAL(0, *status);
  CHECK(lit);
  CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
  CHECK_EQUAL(0, hal::read_integer("/sys/class/pwm/pwmchip0/pwm0/enable").value());
}

}  // namespace
}  // namespace biteline
