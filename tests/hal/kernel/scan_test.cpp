// SPDX-License-Identifier: MIT
// A whole scan with the devices of boards/qemu-virt: made stripe pictures through V4L2, poses through CAN,
// the laser's line and interlock and the camera's trigger through PWM and GPIO, profiles out; compared bit
// for bit with the pictures processed directly.
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <cfenv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "firmware/app/scanner.hpp"
#include "firmware/app/source.hpp"
#include "tests/hal/kernel/gpio_sim.hpp"
#include "tests/hal/kernel/skip.hpp"
#include "tests/hal/kernel/vivid.hpp"
#include "tests/hal/kernel/world.hpp"
#include "tests/support/same_bits.hpp"

namespace biteline {
namespace {

using namespace std::chrono_literals;
using test::GpioSim;

constexpr int k_width_px = 640;
constexpr int k_height_px = 480;
constexpr std::uint32_t k_pictures = 97;  // different ones, then again from the first
constexpr std::uint64_t k_frames = 1000;
constexpr double k_time_alone_mm = 0.02;

/// Each picture's stripe stands half a pixel lower than the one before, so its middle tells which it is.
double stripe_row_px(std::uint32_t picture, int u_px) {
  return 180 + 0.5 * (picture % k_pictures) + 30 * std::sin(u_px * 0.01);
}

using Picture = std::vector<std::uint8_t>;

Picture painted(std::uint32_t number) {
  Picture pixels(static_cast<std::size_t>(k_width_px) * k_height_px, 10);
  for (int u = 0; u < k_width_px; ++u) {
    const double centre_px = stripe_row_px(number, u);
    for (int v = static_cast<int>(centre_px) - 7; v <= static_cast<int>(centre_px) + 8; ++v) {
      const double distance = (v - centre_px) / 2.0;
      pixels[static_cast<std::size_t>(v * k_width_px + u)] =
          static_cast<std::uint8_t>(10 + std::lround(180 * std::exp(-0.5 * distance * distance)));
    }
  }
  return pixels;
}

/// Painted before the scan: a device has its pictures at once.
std::vector<Picture> all_pictures() {
  std::vector<Picture> pictures;
  for (std::uint32_t number = 0; number < k_pictures; ++number) pictures.push_back(painted(number));
  return pictures;
}

geometry::SensorModel made_head() {
  geometry::SensorModel head;
  head.camera = {.fu_px = 900, .fv_px = 900, .cu_px = 320, .cv_px = 240};
  head.laser_plane = {.normal_cam = Vec3{0, std::sqrt(0.5), std::sqrt(0.5)}, .distance_mm = 150};
  head.region = {
      .offset_v_px = 136, .width_px = k_width_px, .height_px = 144};  // all that the stripe reaches
  head.rate_hz = 60;
  head.exposure = 1ms;
  return head;
}

using Profiles = std::vector<std::vector<profile::ProfilePoint>>;

/// What each picture gives without any device.
Profiles expected_profiles(const pipeline::ProfilePipeline::Config& config, const geometry::SensorModel& head,
                           const std::vector<Picture>& pictures) {
  pipeline::ProfilePipeline pipeline = pipeline::ProfilePipeline::create(config, head).value();
  auto buffer = std::make_unique<profile::ProfileBuffer>();
  Profiles profiles;
  for (std::uint32_t picture = 0; picture < k_pictures; ++picture) {
    hal::FrameView frame;
    frame.pixels =
        std::span{pictures[picture]}.subspan(static_cast<std::size_t>(head.region.offset_v_px) * k_width_px);
    frame.width_px = k_width_px;
    frame.height_px = head.region.height_px;
    frame.stride_bytes = k_width_px;
    frame.sequence = picture;
    CHECK(pipeline.rt_process(frame, *buffer));
    profiles.emplace_back(buffer->view().begin(), buffer->view().end());
  }
  return profiles;
}

/// All that no clock enters; sigma_mm also holds the pose's scatter.
/// Until the laser's line is low; told, not judged: an emulated machine's times are no times.
Nanoseconds open_door(const GpioSim& gpio) {
  const SensorClock::time_point opened = hal::monotonic_now();
  gpio.pull(GpioSim::k_interlock, false);
  for (int i = 0; i < 2000 && gpio.value(GpioSim::k_laser_enable); ++i) std::this_thread::sleep_for(1ms);
  CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
  return hal::monotonic_now() - opened;
}

TEST_GROUP(KernelScan){};

TEST(KernelScan, ThousandFramesEveryOneAccountedFor) {
  const char* const board = std::getenv("BITELINE_BOARD");
  BITELINE_DEVICE_OR_SKIP(board != nullptr ? board : "$BITELINE_BOARD");
  BITELINE_DEVICE_OR_SKIP(test::k_gpio_sim_config);
  const GpioSim gpio;
  const test::VividNodes nodes = test::find_vivid().value();
  test::loop_vivid(nodes, k_width_px, k_height_px);
  test::TriggerWire trigger{gpio};
  const std::vector<Picture> pictures = all_pictures();
  const auto show = [&](std::uint32_t number, std::span<std::uint8_t> pixels) {
    std::memcpy(pixels.data(), pictures[number % k_pictures].data(), pixels.size());
  };
  const test::PictureFeeder feeder{nodes, k_width_px, k_height_px, show, [&] { trigger.on_frame(); }};
  test::MovingArm arm;

  const std::filesystem::path sensor_file =
      std::filesystem::temp_directory_path() / "biteline-scan-sensor.yaml";
  std::ofstream{sensor_file} << config::sensor_yaml_text(made_head(), "made");
  const auto kind =
      sensor::choose_source(
          {.source = std::string{"board:"} + board, .sensor_file = sensor_file, .capture = {}, .set = {}})
          .value();
  CHECK(kind->simulated);
  const sensor::Scanner::Config config{
      .pipeline = {}, .model = kind->model, .realtime = runtime::RealtimeDemand::Required};
  const Profiles expected = expected_profiles(config.pipeline, kind->model, pictures);

  CHECK(runtime::prepare_process(config.realtime).has_value());
  const hal::MonotonicClock clock;
  std::optional<sensor::LaserDevices> devices = kind->open_laser().value();
  runtime::LaserWatch laser{std::move(devices->laser), std::move(devices->safety), clock, devices->guard};
  for (std::unique_ptr<hal::Watchdog>& watchdog : devices->watchdogs) laser.feed(std::move(watchdog));
  CHECK(laser.start(config.realtime).has_value());
  CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
  gpio.pull(GpioSim::k_interlock, true);  // after the line was asked for: its bias is the board's, down

  const auto scanner = sensor::Scanner::create(kind->open().value(), config, clock, &laser).value();
  CHECK(scanner->start().has_value());
  laser.ask_for_light(true);

  std::uint64_t taken = 0, wrong = 0, unusable = 0, gaps = 0, heartbeats = 0;
  bool heart_level = false;
  bool door_opened = false;
  Nanoseconds dark_after{0};
  double worst_x_mm = 0;
  std::optional<std::uint64_t> last_frame, last_sequence;
  while (taken < k_frames) {
    laser.note_stream(clock.now());
    const bool heart_was = std::exchange(heart_level, gpio.value(GpioSim::k_heartbeat));
    heartbeats += heart_level != heart_was;
    const profile::ProfileBuffer* const profile = scanner->take();
    if (profile == nullptr) {
      if (scanner->finished()) FAIL("the scan ended early");
      std::this_thread::sleep_for(2ms);
      continue;
    }
    ++taken;
    const profile::ProfileHeader& header = profile->header;
    if (last_frame) gaps += header.frame_sequence - *last_frame - 1;
    if (last_sequence) CHECK(header.sequence > *last_sequence);
    last_frame = header.frame_sequence;
    last_sequence = header.sequence;

    const profile::ProfilePoint& middle = profile->points[profile->count / 2];
    const double row_px = stripe_row_px(0, middle.column);
    const auto picture = static_cast<std::size_t>(std::lround(2 * (middle.row_px - row_px)));
    const bool known = profile->count > 0 && picture < k_pictures;
    wrong += !known || !std::equal(expected[picture].begin(), expected[picture].end(),
                                   profile->view().begin(), profile->view().end(), test::same_bits);
    if ((header.flags & (profile::k_profile_not_usable | profile::k_profile_pose_extrapolated)) != 0) {
      ++unusable;
    } else {
      worst_x_mm = std::max(worst_x_mm,
                            std::abs(header.T_base_flange.translation().x() - arm.x_mm(header.exposure_mid)));
    }
    scanner->give_back();
    if (door_opened) {
      CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
    } else if (taken > k_frames / 2 && gpio.value(GpioSim::k_laser_enable)) {
      dark_after = open_door(gpio);
      door_opened = true;
    }
  }

  // On while all was well, off for good after the door, although it was closed again.
  if (!door_opened) FAIL(runtime::text(laser.status().reason));
  gpio.pull(GpioSim::k_interlock, true);
  std::this_thread::sleep_for(100ms);
  CHECK_FALSE(gpio.value(GpioSim::k_laser_enable));
  CHECK(laser.status().reason == runtime::LaserOff::InterlockOpen);

  scanner->stop();
  const profile::ScanCounts counts = scanner->counts();
  const hal::TriggerHealth edges = scanner->source().camera->health().trigger;
  std::printf(
      "scan: %llu profiles, %llu of other bits, %llu without a good pose, %llu frames lost, %llu dropped, "
      "pose off by %.3f mm, dark %.1f ms after the door\n",
      static_cast<unsigned long long>(taken), static_cast<unsigned long long>(wrong),
      static_cast<unsigned long long>(unusable), static_cast<unsigned long long>(counts.frames_lost),
      static_cast<unsigned long long>(counts.profiles_dropped), worst_x_mm,
      std::chrono::duration<double, std::milli>(dark_after).count());
  CHECK(heartbeats > 0);
  std::printf(
      "trigger: %llu frames with their edge, %llu without, %llu with two; %llu edges, %llu missed, %llu "
      "doubled, %llu late\n",
      static_cast<unsigned long long>(edges.frames_paired),
      static_cast<unsigned long long>(edges.frames_without_edge),
      static_cast<unsigned long long>(edges.frames_with_two_edges),
      static_cast<unsigned long long>(edges.edges), static_cast<unsigned long long>(edges.edges_missed),
      static_cast<unsigned long long>(edges.edges_doubled),
      static_cast<unsigned long long>(edges.edges_late));
  // Each frame has one verdict; how many find their edge is a matter of how much processor an emulated
  // machine gets.
  CHECK_EQUAL(counts.frames, edges.frames_paired + edges.frames_without_edge + edges.frames_with_two_edges);
  CHECK(edges.frames_paired > 0);
  // A pulse has two interrupts.  The kernel's thread tells a rising from a falling one by the level that it
  // reads: where it runs a period late, the end of one pulse is told as the begin of the next.
  CHECK(edges.edges + edges.edges_doubled <= 2 * trigger.pulses());
  CHECK_EQUAL(0, wrong);
  CHECK_EQUAL(0, counts.frames_damaged);
  // Every number between the first profile taken and the last is a frame lost by the driver or a profile
  // dropped by us; both counters also hold what came before the first and after the last.
  CHECK(gaps <= counts.frames_lost + counts.profiles_dropped);
  CHECK(unusable <
        k_frames);  // a stalled arm is flagged, profile by profile, which is right; all of them is no scan
  CHECK(worst_x_mm < k_time_alone_mm);
  std::feclearexcept(FE_ALL_EXCEPT);  // the stripes' tails underflow by design
  std::filesystem::remove(sensor_file);
}

}  // namespace
}  // namespace biteline
