// SPDX-License-Identifier: MIT
#include "tests/support/wakeup_probe.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>

namespace biteline::test {
namespace {

constexpr std::chrono::milliseconds k_period{2};
/// Above all threads of the sensor (70 at most) and of the test's cell (90).
constexpr int k_priority = 98;

std::int64_t to_ns(WakeupProbe::Clock::time_point instant) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(instant.time_since_epoch()).count();
}

double to_ms(std::int64_t ns) {
  return 1e-6 * static_cast<double>(ns);
}

}  // namespace

WakeupProbe::WakeupProbe(Rank rank) : urgent_{rank == Rank::Urgent} {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
    if (!CPU_ISSET(static_cast<std::size_t>(processor), &allowed)) continue;
    lanes_.push_back(std::make_unique<Lane>());
    Lane& lane = *lanes_.back();
    threads_.emplace_back(
        [this, &lane, processor](const std::stop_token& stop) { run(lane, processor, stop); });
  }
}

void WakeupProbe::run(Lane& lane, int processor, const std::stop_token& stop) {
  pthread_setname_np(pthread_self(), "wakeup-probe");
  cpu_set_t own;
  CPU_ZERO(&own);
  CPU_SET(static_cast<std::size_t>(processor), &own);
  pthread_setaffinity_np(pthread_self(), sizeof own, &own);
  const sched_param wanted{.sched_priority = k_priority};
  if (urgent_ && pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) != 0) urgent_ = false;
  while (!stop.stop_requested()) {
    const Clock::time_point due = Clock::now() + k_period;
    lane.due_ns = to_ns(due);
    std::this_thread::sleep_until(due);
    const Clock::time_point woken = Clock::now();
    lane.due_ns = 0;
    const std::size_t count = lane.count;
    if (woken - due < k_noted || count == k_most_delays) continue;
    lane.delays[count] = {.due_ns = to_ns(due), .woken_ns = to_ns(woken)};
    lane.count = count + 1;
  }
}

std::vector<WakeupProbe::Delay> WakeupProbe::stalls() const {
  std::vector<Delay> delays;
  const std::int64_t now_ns = to_ns(Clock::now());
  for (const auto& lane : lanes_) {
    const auto count = static_cast<std::ptrdiff_t>(lane->count.load());
    delays.insert(delays.end(), lane->delays.begin(), lane->delays.begin() + count);
    const std::int64_t due_ns = lane->due_ns;
    if (due_ns != 0 && due_ns < now_ns) delays.push_back({.due_ns = due_ns, .woken_ns = now_ns});
  }
  std::sort(delays.begin(), delays.end(), [](const Delay& a, const Delay& b) { return a.due_ns < b.due_ns; });
  std::vector<Delay> apart;
  for (const Delay& delay : delays) {
    if (apart.empty() || delay.due_ns > apart.back().woken_ns) {
      apart.push_back(delay);
    } else {
      apart.back().woken_ns = std::max(apart.back().woken_ns, delay.woken_ns);
    }
  }
  return apart;
}

double WakeupProbe::worst_ms(std::chrono::milliseconds window) const {
  const std::int64_t window_ns = std::chrono::nanoseconds{window}.count();
  const std::vector<Delay> all = stalls();
  // The worst window ends with a stall.
  std::int64_t worst_ns = 0, inside_ns = 0;
  std::size_t first = 0;
  for (const Delay& last : all) {
    inside_ns += last.woken_ns - last.due_ns;
    for (; all[first].woken_ns < last.woken_ns - window_ns; ++first)
      inside_ns -= all[first].woken_ns - all[first].due_ns;
    worst_ns = std::max(worst_ns, inside_ns);
  }
  return to_ms(worst_ns);
}

double WakeupProbe::stalled_ms(Clock::time_point from, Clock::time_point until) const {
  std::int64_t stalled_ns = 0;
  for (const Delay& stall : stalls()) {
    stalled_ns += std::max<std::int64_t>(
        0, std::min(stall.woken_ns, to_ns(until)) - std::max(stall.due_ns, to_ns(from)));
  }
  return to_ms(stalled_ns);
}

}  // namespace biteline::test
