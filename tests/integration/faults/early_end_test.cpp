// SPDX-License-Identifier: MIT
// A robot whose scan line falls has come to its scan's end, or has stopped for the same reason as the laser:
// the sensor must tell the one from the other, whoever of them is first.
#include <CppUTest/TestHarness.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {

TEST_GROUP(EarlyEnd) {
  std::unique_ptr<FaultStand> stand;

  /// The arm is on its way.
  bool scanning() {
    stand = FaultStand::set_up();
    if (!stand) return false;
    const auto refused = stand->start_scan();
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    stand->cell().set_scan_active(true);
    CHECK(stand->take_profiles(20));
    return true;
  }
  void check_end(int errc, const char* words) {
    CHECK(stand->take_end());
    STRCMP_CONTAINS(words, stand->account().end->where.c_str());
    LONGS_EQUAL(errc, stand->account().end->errc);
  }
};

TIMED_TEST(EarlyEnd, RobotsOwnEndIsTheScansEnd) {
  if (!scanning()) return;
  stand->cell().set_scan_active(false);
  check_end(0, "");
}

/// The frame thread darkens the laser, the arm stops for want of light, and the thread that could say why
/// stands still all the while.
TIMED_TEST(EarlyEnd, ArmThatStopsInTheDarkBeforeTheSafetyThreadSaysSoIsNoEnd) {
  if (!scanning()) return;
  stand->cell().faults.robot_needs_light = true;
  const StalledThread stalled{stand->sensor().child().pid(), "bl-safety"};
  CHECK_TEXT(stalled.stalled(), "ptrace is not allowed here");
  check_end(static_cast<int>(Errc::Overrun), "the safety thread hung");
}

/// The door's switch stops the arm at once; the sensor's guard reads it 10 ms later.
TIMED_TEST(EarlyEnd, ArmThatStopsForAnOpenDoorIsNoEnd) {
  if (!scanning()) return;
  stand->cell().set_door(false);
  stand->cell().set_scan_active(false);
  check_end(static_cast<int>(Errc::InterlockOpen), "the interlock is open");
}

/// The arm goes on while the whole program stands still, and is through before it looks again.
TIMED_TEST(EarlyEnd, EndOfAnArmThatNobodyWatchedIsNoEnd) {
  if (!scanning()) return;
  const int pid = stand->sensor().child().pid();
  ::kill(pid, SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds{500});
  stand->cell().set_scan_active(false);
  ::kill(pid, SIGCONT);
  CHECK(stand->take_end());
  std::printf("%s\n", stand->account().end->where.c_str());
  CHECK(stand->account().end->errc != 0);
}

}  // namespace biteline::test
