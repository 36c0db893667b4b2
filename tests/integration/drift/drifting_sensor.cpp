// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a shoe on its table, by an elastic arm with a
// check lap.  After so many sound ones its head has slipped on the flange by 0.1 mm, and nobody told it.
//
//     biteline-drifting-sensor SOUND
#include <sys/prctl.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string_view>

#include "firmware/stream/stream_socket.hpp"
#include "tests/support/drift_scan.hpp"

namespace {

using namespace biteline;
using Looks = std::vector<test::DriftCell::Look>;

/// As close as a camera's columns, so that a path along the line is smooth.
constexpr int k_fan_rays = 1500;

SensorClock::time_point now() {
  return SensorClock::time_point{std::chrono::steady_clock::now().time_since_epoch()};
}

/// What a scan sends, one after the other.
std::vector<profile::Profile> profiles_of(const test::DriftScan& scan, const geometry::SensorModel& head) {
  std::vector<profile::Profile> profiles;
  const SensorClock::time_point begin = now();
  std::size_t point = 0;
  for (const drift::PosedProfile& posed : scan.poses) {
    profile::Profile made;
    made.header.sequence = made.header.frame_sequence = posed.profile;
    made.header.exposure_mid = begin + Nanoseconds{static_cast<std::int64_t>(1e9 * posed.pose.time_s)};
    made.header.T_base_flange = posed.pose.T_base_flange;
    const SE3 T_cam_base = (posed.pose.T_base_flange * head.T_flange_cam).inverse(Eigen::Isometry);
    for (std::uint16_t column = 0; point < scan.profile.size() && scan.profile[point] == posed.profile;
         ++point, ++column) {
      profile::ProfilePoint seen;
      seen.point_cam = (T_cam_base * scan.points_base[point].cast<double>()).cast<float>();
      seen.sigma_mm = 0.01F;
      seen.column = column;
      seen.peak_count = 1;
      made.points.push_back(seen);
    }
    profiles.push_back(std::move(made));
  }
  return profiles;
}

Result<void> serve(std::uint64_t sound) {
  BITELINE_ASSIGN(const test::DriftCell cell, test::DriftCell::make({.fan_rays = k_fan_rays}));
  constexpr int k_mounting_y = 7;
  const Looks straight = cell.looks({}), slipped = cell.looks({.drifted = drift::Vector::Unit(k_mounting_y)});
  BITELINE_ASSIGN(const auto socket, stream::StreamSocket::open({}));
  std::uint64_t scans = 0;
  std::vector<profile::Profile> profiles;
  std::optional<std::size_t> next;
  wire::SensorHello identity;
  identity.name = "drifting";
  identity.simulated = true;
  identity.model = cell.calibrated();
  stream::StreamServer server{
      {},
      identity,
      *socket,
      [&](wire::Command command) -> Result<void> {
        if (command != wire::Command::StartScan) return {};
        ++scans;
        profiles =
            profiles_of(cell.scan(scans > sound ? slipped : straight, {.seed = scans}), identity.model);
        std::printf("start %llu\n", static_cast<unsigned long long>(scans));
        std::fflush(stdout);
        server.begin_scan(scans, "drifting", profiles.size());
        next = 0;
        return {};
      },
      [] { return wire::Health{}; }};
  std::printf("%s\n", socket->address().c_str());
  std::fflush(stdout);
  for (;;) {
    socket->receive(std::chrono::milliseconds{1},
                    [&](const stream::PeerId& peer, std::span<const std::uint8_t> packet) {
                      server.on_packet(peer, packet, now());
                    });
    if (next && *next < profiles.size()) {
      const profile::Profile& profile = profiles[(*next)++];
      server.add_profile(profile.header, profile.points);
    } else if (next) {
      wire::EndOfScan end;
      end.counters.frames = end.counters.profiles = profiles.size();
      server.add_end(end);
      next.reset();
    }
    server.tick(now());
  }
}

}  // namespace

int main(int argc, char** argv) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  std::uint64_t sound = 0;
  const std::string_view text{argc == 2 ? argv[1] : ""};
  if (std::from_chars(text.begin(), text.end(), sound).ec != std::errc{}) {
    std::fprintf(stderr, "usage: biteline-drifting-sensor SOUND\n");
    return 2;
  }
  const biteline::Result<void> served = serve(sound);
  std::fprintf(stderr, "biteline-drifting-sensor: %s\n", biteline::to_line(served.error()).c_str());
  return 4;
}
