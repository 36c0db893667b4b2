// SPDX-License-Identifier: MIT
// Whole frames of the sensor at the rate of the product, through GigE Vision, trigger, pose bus and network,
// all real.
#include <CppUTest/TestHarness.h>

#include <cstdio>

#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {

TEST_GROUP(FullRateLong){};

TIMED_TEST(FullRateLong, ThousandWholeFramesNoneLostNoneUnaccountedFor) {
  constexpr std::uint64_t k_frames = 1000;
  const auto stand = FaultStand::set_up({.width_px = 1626, .height_px = 1236, .rate_hz = 100});
  if (!stand) return;
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  CHECK(stand->take_until([&] { return stand->account().profiles >= k_frames || stand->account().end; }));
  if (!stand->account().end) stand->command(wire::Command::StopScan);
  CHECK(stand->take_end());
  const ScanAccount& account = stand->account();
  const wire::Counters& counters = account.end->counters;
  const wire::TriggerState& trigger = *account.end->devices.trigger;
  std::printf(
      "%llu frames, %llu lost, %llu damaged, %llu dropped, %llu without their edge, %llu edges without "
      "their frame%s%s\n",
      static_cast<unsigned long long>(counters.frames), static_cast<unsigned long long>(counters.frames_lost),
      static_cast<unsigned long long>(counters.frames_damaged),
      static_cast<unsigned long long>(counters.profiles_dropped),
      static_cast<unsigned long long>(trigger.frames_without_edge),
      static_cast<unsigned long long>(trigger.edges_without_frame), account.end->errc != 0 ? ": " : "",
      account.end->where.c_str());
  LONGS_EQUAL(0, account.wrong);
  LONGS_EQUAL(0, account.disordered);
  LONGS_EQUAL(0, account.lost);
  LONGS_EQUAL(counters.profiles, account.profiles + counters.profiles_dropped);
  LONGS_EQUAL(counters.frames + counters.frames_damaged, counters.profiles);
  LONGS_EQUAL(*account.last_frame + 1, counters.frames + counters.frames_damaged + counters.frames_lost);
  LONGS_EQUAL(counters.profiles,
              trigger.frames_paired + trigger.frames_without_edge + trigger.frames_with_two_edges);
  CHECK(trigger.edges_without_frame <= stand->cell().triggers_missed());
  const std::uint64_t missing = counters.frames_lost + counters.frames_damaged + counters.profiles_dropped +
                                trigger.frames_without_edge + (account.end->errc != 0 ? 1 : 0);
  LONGS_EQUAL(0, missing);
}

}  // namespace biteline::test
