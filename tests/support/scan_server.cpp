// SPDX-License-Identifier: MIT
#include "tests/support/scan_server.hpp"

#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <optional>
#include <span>

namespace biteline::test {

SensorClock::time_point now_of_sensor() {
  return SensorClock::time_point{std::chrono::steady_clock::now().time_since_epoch()};
}

Result<void> serve_scans(const ScanServer& server) {
  BITELINE_ASSIGN(const auto socket, stream::StreamSocket::open({}));
  std::uint64_t scans = 0;
  std::vector<profile::Profile> profiles;
  std::optional<std::size_t> next;
  const auto start = [&](stream::StreamServer& stream) -> Result<void> {
    const auto now_ms = now_of_sensor().time_since_epoch() / std::chrono::milliseconds{1};
    std::printf("start %llu %lld\n", static_cast<unsigned long long>(++scans),
                static_cast<long long>(now_ms));
    std::fflush(stdout);
    if (!server.refuses.empty()) return fail(Errc::DeviceNotFound, "%s", server.refuses.c_str());
    profiles = server.make(scans);
    stream.begin_scan(scans, server.identity.name, profiles.size());
    next = 0;
    return {};
  };
  stream::StreamServer stream{{},
                              server.identity,
                              *socket,
                              [&](wire::Command command) -> Result<void> {
                                if (command == wire::Command::StartScan) return start(stream);
                                return {};
                              },
                              [] { return wire::Health{}; }};
  std::printf("%s\n", socket->address().c_str());
  std::fflush(stdout);
  for (;;) {
    socket->receive(server.between_profiles,
                    [&](const stream::PeerId& peer, std::span<const std::uint8_t> packet) {
                      stream.on_packet(peer, packet, now_of_sensor());
                    });
    if (next && *next < profiles.size()) {
      const profile::Profile& profile = profiles[(*next)++];
      stream.add_profile(profile.header, profile.points);
    } else if (next) {
      wire::EndOfScan end;
      end.counters.frames = end.counters.profiles = profiles.size();
      end.counters.profiles_dropped = server.profiles_dropped;
      stream.add_end(end);
      next.reset();
    }
    stream.tick(now_of_sensor());
  }
}

int run_scan_server(const char* program, const std::function<Result<ScanServer>()>& make) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const Result<ScanServer> server = make();
  const Result<void> served =
      server ? serve_scans(*server) : Result<void>{tl::unexpected<Error>(server.error())};
  std::fprintf(stderr, "%s: %s\n", program, to_line(served.error()).c_str());
  return 4;
}

}  // namespace biteline::test
