// SPDX-License-Identifier: MIT
/// \file The sensor program scans a made shoe with the poses of made ABB and KUKA controllers and of one that
/// speaks the generic protocol: its points must stay on the shoe.
#include <CppUTest/TestHarness.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "common/profile/profile.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/live/live_cell.hpp"
#include "hal/sim/robot/egm_stream.hpp"
#include "hal/sim/robot/rsi_exchange.hpp"
#include "hal/sim/robot/state_teller.hpp"
#include "hal/sim/shoe/surface_distance.hpp"
#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::sim {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Outcome {
  std::vector<profile::Profile> profiles;
  wire::EndOfScan end;
  bool ended{false};

  [[nodiscard]] bool complete() const { return ended && end.errc == 0 && profiles.size() > 50; }
};

using OnPose = std::function<void(SensorClock::time_point, const SE3&)>;

/// A port that no program has just now.
std::uint16_t free_udp_port() {
  const hal::Descriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in here{};
  here.sin_family = AF_INET;
  socklen_t size = sizeof here;
  CHECK(::bind(socket.number(), reinterpret_cast<const sockaddr*>(&here), size) == 0);
  CHECK(::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&here), &size) == 0);
  return ntohs(here.sin_port);
}

/// The standard fixes the camera's port, so one camera at a time lives on an address.
std::unique_ptr<LiveCell> open_cell(const LiveSettings& settings) {
  const auto patience_ends = hal::monotonic_now() + seconds{15};
  do {
    if (auto cell = LiveCell::open(settings)) {
      test::note_ran();
      return std::move(*cell);
    }
    std::this_thread::sleep_for(milliseconds{100});  // until another test gives the port back
  } while (hal::monotonic_now() < patience_ends);
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

/// The simulated cell's board, its poses by that language at that port.
std::string board_text(const std::string& wires, const char* poses, std::uint16_t port) {
  std::string text = board_yaml_text({.wires = wires});
  const std::size_t begin = text.find("\nposes:\n"), end = text.find("\nwatchdog:");
  CHECK(begin < end && end != std::string::npos);
  return text.replace(
      begin, end - begin,
      "\nposes: {kind: " + std::string{poses} + ", address: 127.0.0.1, port: " + std::to_string(port) + "}");
}

}  // namespace

TEST_GROUP(OtherArms) {
  test::TemporaryFolder folder;
  std::unique_ptr<LiveCell> cell;

  Result<intake::SensorProcess> start_sensor() const {
    const auto start = [&](const char* rights) {
      return intake::SensorProcess::start(
          *intake::find_sensor_program(),
          {"--source", "board:" + (folder.path() / "board.yaml").string(), "--sensor",
           (folder.path() / "sensor.yaml").string(), "--rt", rights},
          seconds{30});
    };
    auto sensor = start("required");
    return sensor ? std::move(sensor) : start("ignore");
  }

  void open(const char* kind, std::uint16_t port, OnPose on_pose) {
    cell.reset();
    LiveSettings settings;
    settings.scene = {.shoe = draw_shoe(ShoeClass::Deep, 4),
                      .scan_speed_mm_s = 150,
                      .rate_hz = 25,
                      .fineness = {.column_mm = 1.0, .coarse_row_mm = 0.5}};
    settings.wires = "biteline-other-arms-test-" + std::to_string(getpid());
    settings.robot.rate_hz = 125;
    settings.robot.clock_offset = seconds{-7};
    // As long as the map of the controller's clock needs, and as much again.
    settings.scan_after_laser = milliseconds{500};
    settings.on_pose = std::move(on_pose);
    cell = open_cell(settings);
    if (!cell) return;
    std::ofstream{folder.path() / "sensor.yaml"}
        << config::sensor_yaml_text(cell->scene().head.model, "made head");
    std::ofstream{folder.path() / "board.yaml"} << board_text(settings.wires, kind, port);
  }

  /// One scan by the sensor program, from the host's word to the arm's end.
  Outcome scan() const {
    Outcome outcome;
    auto sensor = start_sensor();
    SUCCEEDS(sensor);
    intake::SensorLinkConfig config;
    config.sensor = sensor->endpoint();
    auto link = intake::SensorLink::open(config);
    SUCCEEDS(link);
    bool asked = false;
    const auto patience_ends = hal::monotonic_now() + seconds{20};
    while (!outcome.ended && hal::monotonic_now() < patience_ends) {
      auto event = (*link)->next(milliseconds{20});
      SUCCEEDS(event);
      if (!*event) continue;
      if (std::holds_alternative<intake::Hello>(**event) && !std::exchange(asked, true))
        (*link)->command({.id = 1, .command = wire::Command::StartScan});
      if (auto* profile = std::get_if<intake::ProfileEvent>(&**event))
        outcome.profiles.push_back(std::move(profile->profile));
      if (auto* end = std::get_if<wire::EndOfScan>(&**event)) {
        outcome.end = std::move(*end);
        outcome.ended = true;
      }
    }
    return outcome;
  }

  /// RMS distance of the surface's points from the made shoe's wall.
  double rms_mm(const Outcome& outcome) const {
    const SurfaceDistance distance{cell->scene().shoe};
    double sum = 0;
    std::size_t count = 0;
    for (const profile::Profile& profile : outcome.profiles) {
      if (profile.header.flags & profile::k_profile_not_usable) continue;
      const SE3 T_shoe_cam = cell->scene().T_base_shoe.inverse(Eigen::Isometry) *
                             profile.header.T_base_flange * cell->scene().head.model.T_flange_cam;
      for (std::size_t i = 0; i < profile.points.size(); i += 7) {
        const profile::ProfilePoint& point = profile.points[i];
        if (point.flags & (profile::k_point_not_surface | profile::k_point_discontinuous)) continue;
        const Vec3 at = T_shoe_cam * point.point_cam.cast<double>();
        if (at.z() < 1 || at.z() > cell->scene().settings.shoe.upper.top_z_mm - 2) continue;
        sum += std::min(0.25, std::pow(distance.signed_distance_mm(at), 2));
        ++count;
      }
    }
    CHECK(count > 1000);
    return std::sqrt(sum / static_cast<double>(count));
  }

  /// As of a scan by the bus, whose poses a SYNC latches: 0.2 ms of a network's delay are 0.03 mm at most.
  static constexpr double k_on_surface_mm = 0.04;

  void points_lie_on_the_shoe(const Outcome& outcome) const {
    CHECK_TEXT(outcome.ended, "the scan did not end");
    CHECK_EQUAL_TEXT(0, outcome.end.errc, outcome.end.where.c_str());
    const auto usable = std::ranges::count_if(outcome.profiles, [](const profile::Profile& profile) {
      return (profile.header.flags & profile::k_profile_not_usable) == 0;
    });
    const double off_mm = rms_mm(outcome);
    std::printf("%zu profiles, %td usable, %.4f mm\n", outcome.profiles.size(), usable, off_mm);
    CHECK_COMPARE(usable, >, static_cast<std::ptrdiff_t>(outcome.profiles.size() * 9 / 10));
    CHECK_COMPARE(off_mm, <, k_on_surface_mm);
  }

  /// A scan that a busy machine ended (the laser's guard wants frames) is tried again.
  static constexpr int k_attempts = 8;
};

TIMED_TEST(OtherArms, AScanByEgmLiesOnTheShoe) {
  Outcome outcome;
  for (int attempt = 0; attempt < k_attempts && !outcome.complete(); ++attempt) {
    const std::uint16_t port = free_udp_port();
    auto controller = std::make_shared<EgmStream>(
        EgmStream::open({.port = port, .clock_offset = seconds{100'000}}).value());
    open("egm", port, [controller](SensorClock::time_point instant, const SE3& T_base_flange) {
      controller->send(instant, T_base_flange, true);
    });
    if (!cell) return;
    outcome = scan();
  }
  points_lie_on_the_shoe(outcome);
}

TIMED_TEST(OtherArms, AScanByRsiLiesOnTheShoe) {
  Outcome outcome;
  for (int attempt = 0; attempt < k_attempts && !outcome.complete(); ++attempt) {
    const std::uint16_t port = free_udp_port();
    // The sensor opens its devices for each scan: whoever wants answers before would end by himself.
    auto controller = std::make_shared<RsiExchange>(
        RsiExchange::open({.port = port, .clock_offset = seconds{100'000}, .only_sends = true}).value());
    open("rsi, answers: false", port,
         [controller](SensorClock::time_point instant, const SE3& T_base_flange) {
           controller->step(instant, T_base_flange);
         });
    if (!cell) return;
    outcome = scan();
  }
  points_lie_on_the_shoe(outcome);
}

TIMED_TEST(OtherArms, AScanByTheGenericProtocolLiesOnTheShoe) {
  Outcome outcome;
  SE3 T_flange_tcp = SE3::Identity();
  T_flange_tcp.translation() = Vec3{0, 40, 180};
  for (int attempt = 0; attempt < k_attempts && !outcome.complete(); ++attempt) {
    auto controller = std::make_shared<StateTeller>(StateTeller::open(0).value());
    open("arm_link", controller->port(),
         [controller, T_flange_tcp](SensorClock::time_point instant, const SE3& T_base_flange) {
           const Nanoseconds stamp = instant.time_since_epoch() + seconds{100'000};
           controller->tell({.stamp_us = static_cast<std::uint64_t>(stamp.count() / 1000),
                             .T_base_tcp = T_base_flange * T_flange_tcp,
                             .T_flange_tcp = T_flange_tcp,
                             .powered = true,
                             .safe = true});
         });
    if (!cell) return;
    outcome = scan();
  }
  points_lie_on_the_shoe(outcome);
}

}  // namespace biteline::sim
