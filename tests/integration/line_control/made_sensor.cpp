// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a flat plate.  Tells its address, then each
// start.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <optional>

#include "firmware/stream/stream_socket.hpp"

namespace {

using namespace biteline;

constexpr std::uint64_t k_profiles = 40;
constexpr int k_points = 60;

profile::Profile plate(std::uint64_t sequence, SensorClock::time_point now) {
  profile::Profile profile;
  profile.header.sequence = profile.header.frame_sequence = sequence;
  profile.header.exposure_mid = now;
  profile.header.T_base_flange =
      geometry::make_se3(Eigen::Quaterniond::Identity(), {0, static_cast<double>(sequence), 0});
  for (int i = 0; i < k_points; ++i) {
    profile::ProfilePoint point;
    point.point_cam = {static_cast<float>(i), 0, 300};
    point.sigma_mm = 0.02F;
    point.column = static_cast<std::uint16_t>(i);
    point.peak_count = 1;
    profile.points.push_back(point);
  }
  return profile;
}

SensorClock::time_point now() {
  return SensorClock::time_point{std::chrono::steady_clock::now().time_since_epoch()};
}

Result<void> serve() {
  BITELINE_ASSIGN(const auto socket, stream::StreamSocket::open({}));
  std::uint64_t scans = 0;
  std::optional<std::uint64_t> next;
  wire::SensorHello identity;
  identity.name = "plate";
  identity.simulated = true;
  identity.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_points, .height_px = 1};
  stream::StreamServer server{{},
                              identity,
                              *socket,
                              [&](wire::Command command) -> Result<void> {
                                if (command != wire::Command::StartScan) return {};
                                std::printf("start %llu\n", static_cast<unsigned long long>(++scans));
                                std::fflush(stdout);
                                server.begin_scan(scans, "plate", k_profiles);
                                next = 0;
                                return {};
                              },
                              [] { return wire::Health{}; }};
  std::printf("%s\n", socket->address().c_str());
  std::fflush(stdout);
  for (;;) {
    socket->receive(std::chrono::milliseconds{10},
                    [&](const stream::PeerId& peer, std::span<const std::uint8_t> packet) {
                      server.on_packet(peer, packet, now());
                    });
    if (next && *next < k_profiles) {
      const profile::Profile profile = plate((*next)++, now());
      server.add_profile(profile.header, profile.points);
    } else if (next) {
      wire::EndOfScan end;
      end.counters.frames = end.counters.profiles = k_profiles;
      server.add_end(end);
      next.reset();
    }
    server.tick(now());
  }
}

}  // namespace

int main() {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const biteline::Result<void> served = serve();
  std::fprintf(stderr, "biteline-made-sensor: %s\n", biteline::to_line(served.error()).c_str());
  return 4;
}
