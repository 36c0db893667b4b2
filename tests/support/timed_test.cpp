// SPDX-License-Identifier: MIT
#include "tests/support/timed_test.hpp"

#include <cstdio>

#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

/// Runs on a late machine before it is given up.
constexpr int k_runs = 4;

const WakeupProbe* g_probe = nullptr;

}  // namespace

void TimedTestShell::runOneTest(TestPlugin* plugin, TestResult& result) {
  double worst_ms = 0;
  bool urgent = true;
  for (int run = 1; run <= k_runs; ++run) {
    const WakeupProbe probe{rank_};
    g_probe = &probe;
    late_failure_.reset();
    UtestShell::runOneTest(plugin, result);
    g_probe = nullptr;
    if (!late_failure_) return note_ran();
    worst_ms = probe.worst_ms();
    urgent = probe.urgent();
    std::fprintf(stderr, "%s on a late machine (%.1f ms of 100): %s\n", getFormattedName().asCharString(),
                 worst_ms, late_failure_->c_str());
  }
  char reason[200];
  std::snprintf(
      reason, sizeof reason, "%s: this machine holds its %s threads up for %.1f ms of 100, %.0f allowed",
      getFormattedName().asCharString(), urgent ? "most urgent" : "ordinary", worst_ms, k_machine_late_ms);
  note_skipped(reason);
}

void TimedTestShell::failWith(const TestFailure& failure) {
  failWith(failure, NormalTestTerminator());
}

void TimedTestShell::failWith(const TestFailure& failure, const TestTerminator& terminator) {
  if (probe().worst_ms() <= k_machine_late_ms) return UtestShell::failWith(failure, terminator);
  late_failure_ = failure.getMessage().asCharString();
  terminator.exitCurrentTest();
}

const WakeupProbe& TimedTestShell::probe() {
  return *g_probe;
}

double reaction_ms(WakeupProbe::Clock::time_point from, WakeupProbe::Clock::time_point until) {
  return std::chrono::duration<double, std::milli>(until - from).count() -
         TimedTestShell::probe().stalled_ms(from, until);
}

}  // namespace biteline::test
