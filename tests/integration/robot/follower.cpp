// SPDX-License-Identifier: MIT
// Follows a path as the service does, in a process of its own that a test may kill, freeze or starve.
// follower RTDE SCRIPT DASHBOARD; SIGUSR1: its memory comes to an end.
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/arm_claim.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "tests/integration/robot/short_path.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"

namespace biteline::robot {
namespace {

std::atomic<bool> g_starve{false};

/// The next thing that is allocated, by whichever thread, ends the process.
void starve_when_told(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    if (!g_starve) continue;
    const rlimit nothing{.rlim_cur = 1 << 20, .rlim_max = 1 << 20};
    static_cast<void>(setrlimit(RLIMIT_AS, &nothing));
    std::vector<std::unique_ptr<char[]>> all;
    while (true) all.push_back(std::make_unique<char[]>(64 << 20));
  }
}

int run(std::uint16_t rtde, std::uint16_t script, std::uint16_t dashboard) {
  const path::CheckedPath& path = test::short_path();
  const auto claim = ur::ArmClaim::take({.rtde_port = rtde, .patience_s = 20});
  if (!claim || (*claim)->state() != ur::ArmClaim::State::Held) return EXIT_FAILURE;
  const auto link = ur::UrLink::open({.rtde_port = rtde,
                                      .script_port = script,
                                      .dashboard_port = dashboard,
                                      .connect_patience_s = 20,
                                      .claim = claim->get()});
  if (!link) return EXIT_FAILURE;
  const auto from = wait_until_still(**link, {});
  if (!from) return EXIT_FAILURE;
  FollowReport report;
  const Result<void> done = follow(**link, test::permitted(path, from->q_rad), {}, report);
  std::printf("%s\n", done ? "done" : to_line(done.error()).c_str());
  return done ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace biteline::robot

int main(int count, char** words) {
  if (count != 4) return EXIT_FAILURE;
  std::signal(SIGUSR1, [](int) { biteline::robot::g_starve = true; });
  const std::jthread starving{biteline::robot::starve_when_told};
  const auto port = [&](int i) { return static_cast<std::uint16_t>(std::strtoul(words[i], nullptr, 10)); };
  return biteline::robot::run(port(1), port(2), port(3));
}
