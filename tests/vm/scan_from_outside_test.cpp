// SPDX-License-Identifier: MIT
// A host outside the virtual machine: profiles of the sensor program in it, made of a recorded session's
// pictures through real kernel interfaces, come over the network with keys, and are those of the same session
// replayed, bit for bit.
//
// What the kernel allows: its video driver runs by itself, so the camera's trigger cannot start an exposure;
// the PWM is switched on by the sensor, and each frame of the driver then makes the edge that it is paired
// with.
#include <CppUTest/TestHarness.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/session_run.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/key_set.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/vm/emulated_machine.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int k_width_px = 640;
constexpr int k_height_px = 480;
constexpr int k_pictures = 31;  // a prime: different ones, then again from the first
constexpr std::uint64_t k_frames = 1000;
/// The machine boots and scans in software emulation, beside whatever else this one does.
constexpr seconds k_boot_patience = test::EmulatedMachine::k_boot_patience;
constexpr seconds k_scan_patience{240};

/// Each picture's stripe stands half a pixel lower than the one before.
image::GreyImage paint(int number) {
  image::GreyImage picture{.width_px = k_width_px, .height_px = k_height_px, .pixels = {}};
  picture.pixels.assign(static_cast<std::size_t>(k_width_px) * k_height_px, 10);
  for (int u = 0; u < k_width_px; ++u) {
    const double centre_px = 180 + 0.5 * number + 30 * std::sin(u * 0.01);
    for (int v = static_cast<int>(centre_px) - 7; v <= static_cast<int>(centre_px) + 8; ++v) {
      const double distance = (v - centre_px) / 2.0;
      picture.pixels[static_cast<std::size_t>(v * k_width_px + u)] =
          static_cast<std::uint8_t>(10 + std::lround(180 * std::exp(-0.5 * distance * distance)));
    }
  }
  return picture;
}

geometry::SensorModel made_head() {
  geometry::SensorModel head;
  head.camera = {.fu_px = 900, .fv_px = 900, .cu_px = 320, .cv_px = 240};
  head.laser_plane = {.normal_cam = Vec3{0, std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2},
                      .distance_mm = 150};
  head.region = {.width_px = k_width_px, .height_px = k_height_px};
  head.rate_hz = 60;
  head.exposure = milliseconds{1};
  return head;
}

void write_session(const fs::path& folder) {
  constexpr Nanoseconds k_first = seconds{10}, k_period = milliseconds{16}, k_lead = milliseconds{200};
  fs::create_directories(folder / "cam0" / "data");
  fs::create_directories(folder / "pose0");
  std::ofstream{folder / "cam0" / "sensor.yaml"} << config::sensor_yaml_text(made_head(), "made for a test");
  std::vector<session::FrameEntry> frames;
  for (int number = 0; number < k_pictures; ++number) {
    const Nanoseconds stamp = k_first + number * k_period;
    const fs::path file = folder / "cam0" / "data" / (std::to_string(stamp.count()) + ".png");
    SUCCEEDS(image::write_png(file, paint(number)));
    frames.push_back({.exposure_mid = SensorClock::time_point{stamp}, .file = file});
  }
  std::vector<session::StampedPose> poses;
  for (Nanoseconds t = k_first - k_lead; t <= k_first + k_pictures * k_period + k_lead;
       t += milliseconds{8}) {
    SE3 T = SE3::Identity();
    T.translation().x() = 0.25e-6 * static_cast<double>(t.count());  // 250 mm/s
    poses.push_back({.stamp = RobotClock::time_point{t}, .T_base_flange = T});
  }
  SUCCEEDS(session::write_frame_table(folder / "cam0" / "data.csv", frames));
  SUCCEEDS(session::write_pose_table(folder / "pose0" / "data.csv", poses));
}

/// All of a profile that no clock enters: sigma_mm also holds the pose's scatter.
std::vector<std::uint32_t> clockless_bits(const std::vector<profile::ProfilePoint>& points) {
  std::vector<std::uint32_t> bits;
  bits.reserve(9 * points.size());
  for (const profile::ProfilePoint& p : points) {
    for (const float value : {p.point_cam.x(), p.point_cam.y(), p.point_cam.z(), p.row_px, p.sigma_row_px,
                              p.amplitude, p.width_px}) {
      bits.push_back(std::bit_cast<std::uint32_t>(value));
    }
    bits.push_back(p.column | std::uint32_t{p.peak_count} << 16U);
    bits.push_back(p.flags);
  }
  return bits;
}

}  // namespace

TEST_GROUP(ScanFromOutside) {
  test::TemporaryFolder folder;
  test::EmulatedMachine machine;
  std::unique_ptr<intake::SensorLink> link;
  std::vector<profile::Profile> profiles;
  std::uint64_t lost{0};
  std::optional<wire::EndOfScan> end;
  std::optional<wire::ControlReply> reply;
  bool known{false};

  fs::path session() const {
    return folder.path() / "session";
  }
  fs::path keys() const {
    return folder.path() / "keys";
  }

  /// Takes in what comes until `done`; false: it never did, or the machine ended.
  template <class Done>
  bool take_until(seconds patience, Done done) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!done()) {
      if (std::chrono::steady_clock::now() > deadline || !machine.runs()) return false;
      auto event = link->next(milliseconds{50});
      if (!event) {
        std::printf("%s\n", to_line(event.error()).c_str());
        return false;
      }
      if (*event) take(std::move(**event));
    }
    return true;
  }
  void take(intake::LinkEvent event) {
    if (auto* profile = std::get_if<intake::ProfileEvent>(&event))
      profiles.push_back(std::move(profile->profile));
    if (const auto* loss = std::get_if<intake::LossEvent>(&event)) lost += loss->messages;
    if (const auto* over = std::get_if<wire::EndOfScan>(&event)) end = *over;
    if (const auto* answer = std::get_if<wire::ControlReply>(&event)) reply = *answer;
    known = known || std::holds_alternative<intake::Hello>(event);
  }
  /// The same firmware on the same session, outside the machine under user emulation.
  std::vector<std::vector<std::uint32_t>> replayed() {
    intake::SessionRunOptions options;
    options.session = session();
    options.program = folder.write(
        "sensor.sh", "#!/bin/sh\nexec " + test::environment("BITELINE_ARM64_EMULATOR") + " '" +
                         test::environment("BITELINE_ARM64_BUILD") + "/bin/biteline-sensor' \"$@\"\n");
    fs::permissions(*options.program, fs::perms::owner_all);
    std::vector<std::vector<std::uint32_t>> found;
    options.on_profile = [&](const profile::Profile& profile, auto&&...) {
      found.push_back(clockless_bits(profile.points));
    };
    SUCCEEDS(intake::run_sensor_on_session(options));
    return found;
  }
};

// The machine is emulated, by ordinary threads: its sensor stops when these do not get their time.
ORDINARY_TIMED_TEST(ScanFromOutside, ThousandProfilesAreThoseOfTheReplayAndEveryCountIsRight) {
  if (test::nothing_to_boot()) return;
  write_session(session());
  SUCCEEDS(test::make_key_set(keys()));
  machine.boot({.guest = "BITELINE_BOARD=/test/board.yaml BITELINE_SESSION=/test/session "
                         "BITELINE_KEYS=/test/keys BITELINE_SENSOR=/test/biteline-sensor "
                         "/test/kernel_program_test",
                .program = "tests/kernel_program_test",
                .files = {session(), keys()}});
  // The forwarded port answers before anybody listens inside: the sensor's own line says when.
  const bool up = machine.says("\"endpoint\"");
  if (!up && machine.cannot_run_here()) return;
  test::note_ran();
  CHECK_TEXT(up, "the sensor in the machine does not come up");

  intake::SensorLinkConfig config;
  config.sensor = {.host = "127.0.0.1", .port = static_cast<std::uint16_t>(machine.port())};
  auto host_keys = wire::read_host_keys(keys());
  SUCCEEDS(host_keys);
  config.keys = *host_keys;
  config.silence_limit = k_boot_patience;
  auto opened = intake::SensorLink::open(config);
  SUCCEEDS(opened);
  link = std::move(*opened);
  CHECK_TEXT(take_until(k_boot_patience, [&] { return known; }), "the sensor in the machine never answered");
  link->command({.id = 1, .command = wire::Command::StartScan});
  CHECK(take_until(k_boot_patience, [&] { return reply.has_value(); }));
  STRCMP_EQUAL("", reply->where.c_str());
  CHECK(take_until(k_scan_patience, [&] { return profiles.size() >= k_frames || end.has_value(); }));
  link->command({.id = 2, .command = wire::Command::StopScan});
  CHECK(take_until(k_boot_patience, [&] { return end.has_value(); }));
  STRCMP_EQUAL("", end->where.c_str());

  const wire::Counters& counters = end->counters;
  const wire::TriggerState& trigger = end->devices.trigger.value();
  std::uint64_t holes = 0, wrong = 0;
  const std::vector<std::vector<std::uint32_t>> expected = replayed();
  LONGS_EQUAL(k_pictures, expected.size());
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    if (i > 0) holes += profiles[i].header.frame_sequence - profiles[i - 1].header.frame_sequence - 1;
    const std::vector<std::uint32_t> bits = clockless_bits(profiles[i].points);
    wrong += std::find(expected.begin(), expected.end(), bits) == expected.end() ? 1 : 0;
  }
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "%llu profiles over the network, %llu of other bits; %llu frames, %llu lost by the driver, %llu "
      "profiles dropped; "
      "%llu edges, %llu frames with theirs, %llu without; %llu poses\n",
      number(profiles.size()), number(wrong), number(counters.frames), number(counters.frames_lost),
      number(counters.profiles_dropped), number(trigger.edges), number(trigger.frames_paired),
      number(trigger.frames_without_edge), number(counters.poses));
  LONGS_EQUAL(0, wrong);
  LONGS_EQUAL(0, lost);
  CHECK(profiles.size() >= k_frames);
  LONGS_EQUAL(counters.profiles, profiles.size() + counters.profiles_dropped);
  LONGS_EQUAL(counters.frames + counters.frames_damaged, counters.profiles);
  // What was lost or dropped before the first profile that came and after the last leaves no hole between
  // profiles.
  CHECK(holes <= counters.frames_lost + counters.profiles_dropped);
  LONGS_EQUAL(counters.frames + counters.frames_damaged,
              trigger.frames_paired + trigger.frames_without_edge + trigger.frames_with_two_edges);
  CHECK(trigger.frames_paired > 0);  // how many is a matter of how much processor an emulated machine gets
  CHECK(counters.poses > 0);
  CHECK(end->devices.realtime);
  link.reset();
  machine.tell_the_rest(seconds{60});
  machine.ends_well(k_scan_patience);
}

}  // namespace biteline
