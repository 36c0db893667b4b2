// SPDX-License-Identifier: MIT
// Faults that cost measurements and nothing else: told, counted, and over when they are over (README.md,
// fault table).
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <thread>

#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

using std::chrono::milliseconds;

/// At 250 mm/s 0.02 mm are 80 us.  Of these the stamps of the bus take 10 us each (0.0025 mm), the pose
/// message's own resolution 0.002 mm, the fit's polynomial on a radius of 100 mm within its window of 100 ms
/// less than that.
constexpr double k_time_alone_mm = 0.02;

}  // namespace

TEST_GROUP(DataFaults) {
  std::unique_ptr<FaultStand> stand;

  bool scanning(const PictureCellConfig& config = {}) {
    stand = FaultStand::set_up(config);
    if (!stand) return false;
    // The clock's map is there after its first stretch of 250 ms.
    const auto refused = stand->start_scan(50);
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    return true;
  }
  const wire::Devices& devices() const {
    return stand->account().health.devices;
  }
  /// The fault is over: profiles are good again, the same scan goes on, and at its end every frame is
  /// accounted for.
  void check_recovered() {
    const std::uint64_t usable = stand->account().usable;
    CHECK(stand->take_until([&] { return stand->account().usable >= usable + 30; }));
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
    const ScanAccount& account = stand->account();
    const wire::Counters& counters = account.end->counters;
    LONGS_EQUAL(0, account.end->errc);
    LONGS_EQUAL(0, account.wrong);
    LONGS_EQUAL(0, account.lost);
    LONGS_EQUAL(0, account.disordered);
    LONGS_EQUAL(counters.profiles, account.profiles + counters.profiles_dropped);
    // Whatever the fault was: what passes as good is good.
    std::printf("pose off by %.6f mm at most\n", account.pose_off_max_mm);
    CHECK_COMPARE(account.pose_off_max_mm, <, k_time_alone_mm);
    // Of a frame that is lost behind the last profile nothing is heard but the count.
    const std::uint64_t taken = counters.frames + counters.frames_damaged + counters.frames_lost;
    CHECK_COMPARE(taken, >=, *account.last_frame + 1);
    const std::uint64_t behind = taken - (*account.last_frame + 1);
    LONGS_EQUAL(counters.frames_lost + counters.profiles_dropped, account.frames_missing + behind);
    const wire::TriggerState& trigger = *account.end->devices.trigger;
    LONGS_EQUAL(counters.frames + counters.frames_damaged,
                trigger.frames_paired + trigger.frames_without_edge + trigger.frames_with_two_edges);
    LONGS_EQUAL(account.with(profile::k_profile_trigger_mismatch),
                trigger.frames_without_edge + trigger.frames_with_two_edges);
  }
};

LONG_GROUP(DataFaults){};

TIMED_TEST(DataFaults, NothingWrongNothingTold) {
  if (!scanning()) return;
  CHECK(stand->take_health());
  CHECK(devices().camera_connected);
  CHECK(devices().poses_flow);
  LONGS_EQUAL(2, devices().clocks.size());
  for (const wire::ClockState& clock : devices().clocks) CHECK(clock.known);
  LONGS_EQUAL(
      0, devices().trigger->edges_missed + devices().trigger->edges_doubled + devices().trigger->edges_late);
  check_recovered();
}

TIMED_TEST(DataFaults, LostEdgesAreCountedAndCostTheirFramesAlone) {
  if (!scanning()) return;
  const std::uint64_t without = stand->account().with(profile::k_profile_trigger_mismatch);
  stand->cell().faults.edges_to_lose = 3;
  CHECK(stand->take_until(
      [&] { return stand->account().health.devices.trigger && devices().trigger->edges_missed >= 3; }));
  LONGS_EQUAL(3, devices().trigger->edges_missed);
  LONGS_EQUAL(without, stand->account().with(profile::k_profile_trigger_mismatch));
  check_recovered();
}

TIMED_TEST(DataFaults, DoubledEdgesAreCountedAndTheirFramesAreNotUsed) {
  if (!scanning()) return;
  stand->cell().faults.edges_to_double = 2;
  CHECK(stand->take_until(
      [&] { return stand->account().health.devices.trigger && devices().trigger->edges_doubled >= 2; }));
  LONGS_EQUAL(2, devices().trigger->edges_doubled);
  // A camera that takes the second pulse gives a frame whose exposure no slot of the train began.
  CHECK(stand->account().with(profile::k_profile_trigger_mismatch) <= 2);
  check_recovered();
}

TIMED_TEST(DataFaults, FramesWithoutTheirEchoAreNotUsed) {
  if (!scanning()) return;
  const std::uint64_t without = stand->account().with(profile::k_profile_trigger_mismatch);
  stand->cell().faults.echoes_to_lose = 2;
  CHECK(stand->take_until([&] {
    return stand->account().health.devices.trigger && devices().trigger->frames_without_edge >= without + 2;
  }));
  CHECK(stand->take_until(
      [&] { return stand->account().with(profile::k_profile_trigger_mismatch) >= without + 2; }));
  check_recovered();
}

TIMED_TEST(DataFaults, BusOffFlagsEveryProfileUntilTheBusIsBack) {
  if (!scanning()) return;
  stand->cell().faults.bus_off = true;
  CHECK(stand->take_until([&] { return !devices().poses_flow; }));
  CHECK(stand->take_profiles(10));  // those that were under way
  const std::uint64_t usable = stand->account().usable;
  CHECK(stand->take_profiles(20));
  LONGS_EQUAL(usable, stand->account().usable);
  CHECK(stand->cell().laser_on());  // frames flow: nothing that the laser depends on
  stand->cell().faults.bus_off = false;
  CHECK(stand->take_until([&] { return devices().poses_flow; }));
  LONGS_EQUAL(1, devices().pose_reconnects);
  check_recovered();
}

TIMED_TEST(DataFaults, PoseGapIsCountedAndFlagged) {
  if (!scanning()) return;
  const std::uint64_t lost = stand->account().health.counters.poses_lost;
  stand->cell().faults.poses_silent = true;  // their SYNCs go on
  std::this_thread::sleep_for(milliseconds{250});
  stand->cell().faults.poses_silent = false;
  CHECK(stand->take_until([&] { return stand->account().health.counters.poses_lost > lost; }));
  CHECK(stand->account().usable < stand->account().profiles);
  check_recovered();
}

TIMED_TEST(DataFaults, PosesFromTheFutureAreRejectedAndPoisonNothing) {
  if (!scanning()) return;
  const std::uint64_t rejected = stand->account().health.counters.poses_rejected;
  stand->cell().faults.poses_from_future = 3;
  CHECK(stand->take_until([&] { return stand->account().health.counters.poses_rejected >= rejected + 3; }));
  LONGS_EQUAL(rejected + 3, stand->account().health.counters.poses_rejected);
  check_recovered();
}

TIMED_TEST(DataFaults, StoppedSyncIsToldAndTheClockMapCarriesOn) {
  if (!scanning()) return;
  CHECK(stand->take_health());
  const std::uint64_t unlatched = devices().poses_unlatched;
  stand->cell().faults.sync_stopped = true;
  CHECK(stand->take_until([&] { return devices().poses_unlatched > unlatched + 50; }));
  const std::uint64_t usable = stand->account().usable;
  CHECK(stand->take_profiles(20));
  CHECK(stand->account().usable > usable);
  stand->cell().faults.sync_stopped = false;
  check_recovered();
}

TIMED_TEST(DataFaults, SteppedRobotClockIsToldAndTheMapBeginsAnew) {
  for (const std::int64_t step_s : {-2, 2}) {
    stand.reset();
    if (!scanning()) return;
    CHECK(stand->take_health());
    const std::uint64_t steps = devices().clocks.at(1).steps;
    stand->cell().faults.robot_clock_step_ns = step_s * 1'000'000'000;
    CHECK(stand->take_until([&] { return devices().clocks.at(1).steps > steps; }));
    CHECK(stand->take_until([&] { return devices().poses_flow; }));
    check_recovered();
  }
}

TIMED_TEST(DataFaults, HangingPoseThreadFlagsProfilesAndEndsNothing) {
  if (!scanning()) return;
  {
    const StalledThread stalled{stand->sensor().child().pid(), "bl-pose"};
    CHECK_TEXT(stalled.stalled(), "ptrace is not allowed here");
    CHECK(stand->take_profiles(10));
    const std::uint64_t usable = stand->account().usable;
    CHECK(stand->take_profiles(20));
    LONGS_EQUAL(usable, stand->account().usable);
    CHECK(stand->cell().laser_on());
  }
  check_recovered();
}

TIMED_TEST(DataFaults, LostPacketsCostTheirFramesAndEveryOneIsAccountedFor) {
  // 640 x 120 in packets of 16000 bytes: one frame in fifty lacks one.
  if (!scanning({.lost_packet_ratio = 0.004})) return;
  CHECK(stand->take_until([&] {
    return stand->account().with(profile::k_profile_frame_damaged) + stand->account().frames_missing >= 3;
  }));
  check_recovered();
}

TIMED_TEST(DataFaults, PacketsLostOnTheWayAreSentAgain) {
  if (!scanning({.lossy_line_ratio = 0.01})) return;
  CHECK(stand->take_until([&] { return devices().packets_resent >= 3; }));
  check_recovered();
  std::printf("%llu packets sent again, %llu frames damaged\n",
              static_cast<unsigned long long>(stand->account().end->devices.packets_resent),
              static_cast<unsigned long long>(stand->account().end->counters.frames_damaged));
}

/// The pose of each profile against where the arm was, at 250 mm/s on a circle: what all stamps together
/// cost.
TIMED_TEST(DataFaultsLong, PosesErrByLessThanTwoHundredthsOfAMillimetreFromTimeAlone) {
  if (!scanning({.rate_hz = 97})) return;
  CHECK(stand->take_profiles(300));
  check_recovered();
  std::printf("clock known to %.1f us\n",
              1e-3 * static_cast<double>(stand->account().end->devices.clocks.at(1).uncertainty.count()));
}

}  // namespace biteline::test
