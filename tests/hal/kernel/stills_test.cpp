// SPDX-License-Identifier: MIT
// `biteline-sensor --stills` on the devices of boards/qemu-virt, for a wizard outside: made pictures of
// targets through V4L2, an arm that rests, the laser on its line.  The wizard's half:
// tests/vm/commission_from_outside_test.cpp.
//
// A folder of the outside is mounted where it has it itself: `places.csv` has the arm's places, NN_lamp.png
// and NN_laser.png what the camera sees there, `place` the number of the present one; -1: it is over.
#include <CppUTest/TestHarness.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
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
using hal::Descriptor;
using test::GpioSim;

constexpr int k_port = 5555;
constexpr int k_over = -1;
/// Four pictures wait in the driver, one is being painted.
constexpr std::uint64_t k_frames_behind = 6;

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : std::string{"$"} + name;
}

/// What the camera sees: one picture, until another is shown.
class Screen {
 public:
  Screen(const test::VividNodes& nodes, image::GreyImage first, std::function<void()> on_frame)
      : picture_{std::move(first)},
        feeder_{nodes, picture_.width_px, picture_.height_px,
                [this](std::uint32_t, std::span<std::uint8_t> pixels) {
                  const std::lock_guard lock{mutex_};
                  std::copy(picture_.pixels.begin(), picture_.pixels.end(), pixels.begin());
                },
                [this, on_frame] {
                  ++shown_;
                  on_frame();
                }} {}

  /// Returns once no frame of the camera can show anything else.
  void show(image::GreyImage picture) {
    {
      const std::lock_guard lock{mutex_};
      picture_ = std::move(picture);
    }
    const std::uint64_t from = shown_;
    for (int turn = 0; shown_ < from + k_frames_behind; ++turn) {
      CHECK_TEXT(turn < 10'000, "the video driver shows no pictures");
      std::this_thread::sleep_for(2ms);
    }
  }

 private:
  std::mutex mutex_;
  image::GreyImage picture_;  ///< guarded by mutex_
  std::atomic<std::uint64_t> shown_{0};
  test::PictureFeeder feeder_;
};

/// Looks at the laser's line all the time, before every other thread.
class LaserEye {
 public:
  explicit LaserEye(const GpioSim& gpio) : gpio_{gpio} {}
  ~LaserEye() {
    stop_ = true;
    thread_.join();
  }
  void allow(bool light) { allowed_ = light; }
  [[nodiscard]] int lightings() const { return lightings_; }
  [[nodiscard]] int forbidden() const { return forbidden_; }

 private:
  void look() {
    const sched_param priority{.sched_priority = 90};
    (void)::sched_setscheduler(0, SCHED_FIFO, &priority);
    for (bool before = false; !stop_; std::this_thread::sleep_for(1ms)) {
      const bool lit = gpio_.value(GpioSim::k_laser_enable);
      if (lit && !before) ++lightings_;
      if (lit && !allowed_) ++forbidden_;
      before = lit;
    }
  }

  const GpioSim& gpio_;
  std::atomic<bool> stop_{false}, allowed_{false};
  std::atomic<int> lightings_{0}, forbidden_{0};
  std::thread thread_{[this] { look(); }};
};

Descriptor listener() {
  Descriptor socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(k_port);
  CHECK_EQUAL(0, ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address));
  CHECK_EQUAL(0, ::listen(socket.number(), 1));
  return socket;
}

/// One run of the program, for one connection: it answers there itself, its orders come through us.
struct Served {
  Descriptor connection, orders;
  std::string pending;
  pid_t pid{0};
};

std::unique_ptr<Served> serve(Descriptor connection) {
  int ends[2];
  CHECK_EQUAL(0, ::pipe2(ends, O_CLOEXEC));
  const Descriptor read_end{ends[0]};
  auto served = std::make_unique<Served>();
  served->orders = Descriptor{ends[1]};
  served->connection = std::move(connection);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, read_end.number(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, served->connection.number(), STDOUT_FILENO);
  std::vector<std::string> words{variable("BITELINE_SENSOR"), "--stills", "--source",
                                 "board:" + variable("BITELINE_BOARD"), "--rt=required"};
  std::vector<char*> raw;
  for (std::string& word : words) raw.push_back(word.data());
  raw.push_back(nullptr);
  CHECK_EQUAL(0, posix_spawn(&served->pid, raw[0], &actions, nullptr, raw.data(), environ));
  posix_spawn_file_actions_destroy(&actions);
  return served;
}

bool readable(const Descriptor& descriptor, int timeout_ms) {
  pollfd waiting{.fd = descriptor.number(), .events = POLLIN, .revents = 0};
  return ::poll(&waiting, 1, timeout_ms) > 0;
}

TEST_GROUP(KernelStills) {
  std::filesystem::path folder{variable("BITELINE_SHARE")};
  int place{0};

  image::GreyImage picture(bool lit) const {
    char name[40];
    std::snprintf(name, sizeof name, "%02d_%s.png", place, lit ? "laser" : "lamp");
    auto read = image::read_png(folder / name);
    CHECK_TEXT(read.has_value(), name);
    return std::move(*read);
  }
  int lit_places() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator{folder})
      count += entry.path().string().ends_with("_laser.png") ? 1 : 0;
    return count;
  }
  int place_told() const {
    int number = place;
    std::ifstream{folder / "place"} >> number;
    return number;
  }
};

TEST(KernelStills, PicturesOnDemandForAWizardOutside) {
  BITELINE_DEVICE_OR_SKIP(folder);
  BITELINE_DEVICE_OR_SKIP(variable("BITELINE_SENSOR"));
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  (void)std::signal(SIGPIPE, SIG_IGN);
  const auto places = session::read_pose_table(folder / "places.csv").value();
  const GpioSim gpio;
  const test::VividNodes nodes = test::find_vivid().value();
  image::GreyImage first = picture(false);
  test::loop_vivid(nodes, first.width_px, first.height_px);
  test::TriggerWire trigger{gpio};
  Screen screen{nodes, std::move(first), [&] { trigger.on_frame(); }};
  test::RestingArm arm{places[0].T_base_flange};
  LaserEye eye{gpio};
  const Descriptor door = listener();
  std::printf("stills: ready\n");
  std::fflush(stdout);

  std::unique_ptr<Served> served;
  int dark = 0, lit = 0, ended = 0;
  const auto obey = [&](const std::string& order) {
    const bool light = order.starts_with("take laser");
    eye.allow(light);
    if (order.starts_with("take")) {
      screen.show(picture(light));
      ++(light ? lit : dark);
    }
    const std::string line = order + "\n";
    CHECK_EQUAL(static_cast<ssize_t>(line.size()),
                ::write(served->orders.number(), line.data(), line.size()));
  };
  for (;;) {
    // A request of the line sets its bias, so the closed door is pulled again and again.
    gpio.pull(GpioSim::k_interlock, true);
    if (const int told = place_told(); told != place) {
      if (told == k_over) break;
      place = told;
      arm.put(places[static_cast<std::size_t>(place)].T_base_flange);
    }
    if (!served) {
      if (readable(door, 50))
        served = serve(Descriptor{::accept4(door.number(), nullptr, nullptr, SOCK_CLOEXEC)});
      continue;
    }
    if (!readable(served->connection, 20)) continue;
    char chunk[1024];
    const ssize_t count = ::read(served->connection.number(), chunk, sizeof chunk);
    if (count > 0) {
      served->pending.append(chunk, static_cast<std::size_t>(count));
      for (std::size_t end; (end = served->pending.find('\n')) != std::string::npos;) {
        const std::string order = served->pending.substr(0, end);
        served->pending.erase(0, end + 1);
        obey(order);
      }
      continue;
    }
    eye.allow(false);
    served->orders = Descriptor{};
    int raw = 0;
    CHECK_EQUAL(served->pid, waitpid(served->pid, &raw, 0));
    CHECK_EQUAL(0, raw);
    served.reset();
    ++ended;
  }
  std::printf(
      "program: %d runs, %d pictures in the dark, %d with the laser, which was lit %d times; %llu trigger "
      "pulses\n",
      ended, dark, lit, eye.lightings(), static_cast<unsigned long long>(trigger.pulses()));
  CHECK_FALSE(served);
  CHECK(dark > 0 && trigger.pulses() > 0);
  // Once for each place that has a picture with it, and again only where one was ordered again.
  CHECK(eye.lightings() >= lit_places() && eye.lightings() <= lit);
  CHECK_EQUAL(0, eye.forbidden());
  CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
  CHECK_EQUAL(0, hal::read_integer("/sys/class/pwm/pwmchip0/pwm0/enable").value());
}

}  // namespace
}  // namespace biteline
