// SPDX-License-Identifier: MIT
// Faults that must turn the laser off, made to the real program before the cell (README.md, fault table).
#include <CppUTest/TestHarness.h>
#include <csignal>

#include <cstdio>
#include <thread>

#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

/// Of the sensor; time in which the machine itself stood still is not counted.
constexpr double k_limit_ms = 100;

SensorClock::time_point now() {
  return hal::monotonic_now();
}

void check_ended(const FaultStand& stand, Errc code, const char* words) {
  CHECK(stand.account().end.has_value());
  STRCMP_CONTAINS(words, stand.account().end->where.c_str());
  LONGS_EQUAL(static_cast<int>(code), stand.account().end->errc);
}

}  // namespace

TEST_GROUP(LaserFaults) {
  std::unique_ptr<FaultStand> stand;

  bool set_up() {
    stand = FaultStand::set_up();
    return stand != nullptr;
  }
  /// Scans, has the fault made, measures the darkness, has it repaired; after that a scan must run again.
  void check_dark(const char* row, const std::function<void()>& fault, const std::function<void()>& after) {
    const auto refused = stand->start_scan();
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    CHECK(stand->cell().laser_on());
    check_dark_after(row, fault);
    after();
    LONGS_EQUAL(0, stand->account().wrong);
    const auto refused_again = stand->start_scan();
    CHECK_TEXT(!refused_again, refused_again.value_or("").c_str());
  }
  void check_dark_after(const char* row, const std::function<void()>& fault) {
    const SensorClock::time_point begin = now();
    fault();
    const std::optional<double> dark_ms = stand->dark_after_ms(begin);
    CHECK_TEXT(dark_ms.has_value(), "the laser shines on");
    std::printf("%s: dark after %.1f ms, the machine's own delays not counted\n", row, *dark_ms);
    CHECK(*dark_ms <= k_limit_ms);
  }
  void check_stalled(const char* row, const char* thread, const char* words) {
    if (!set_up()) return;
    std::optional<StalledThread> stalled;
    check_dark(
        row, [&] { stalled.emplace(stand->sensor().child().pid(), thread); },
        [&] {
          CHECK_TEXT(stalled->stalled(), "ptrace is not allowed here");
          stalled.reset();
          CHECK(stand->take_end());
          check_ended(*stand, Errc::Overrun, words);
        });
  }
};

TIMED_TEST(LaserFaults, KilledSensorLetsGoOfTheLaser) {
  if (!set_up()) return;
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  check_dark_after("sensor killed", [&] { ::kill(stand->sensor().child().pid(), SIGKILL); });
}

// The camera streams to the dead one, and is controlled by it, until the heartbeat is missed.
TIMED_TEST(LaserFaults, KilledSensorsSuccessorWaitsForTheCameraAndThenScans) {
  if (!set_up()) return;
  // Asks at once; and after the heartbeat's time, with nobody else about who would have noticed.
  for (const auto pause : {std::chrono::seconds{0}, std::chrono::seconds{4}}) {
    const auto refused = stand->start_scan();
    CHECK_TEXT(!refused, refused.value_or("").c_str());
    stand->replace_sensor();
    std::this_thread::sleep_for(pause);
    CHECK(stand->take_until([&] {
      const auto again = stand->start_scan();
      if (again) STRCMP_CONTAINS("another program controls it", again->c_str());
      return !again;
    }));
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
    LONGS_EQUAL(0, stand->account().wrong);
  }
}

TIMED_TEST(LaserFaults, HangingFrameThreadIsFoundByTheSafetyThread) {
  check_stalled("frame thread stalled", "bl-acq", "the frame processing hangs");
}

TIMED_TEST(LaserFaults, HangingSafetyThreadIsFoundByTheFrameThread) {
  check_stalled("safety thread stalled", "bl-safety", "the safety thread hung");
}

TIMED_TEST(LaserFaults, HangingStreamThreadIsFoundByTheSafetyThread) {
  check_stalled("stream thread stalled", "bl-stream", "the stream thread hangs");
}

TIMED_TEST(LaserFaults, HotHeadEndsTheScanAndACooledOneAllowsTheNext) {
  if (!set_up()) return;
  check_dark(
      "head too hot", [&] { stand->cell().set_too_hot(true); },
      [&] {
        CHECK(stand->take_end());
        check_ended(*stand, Errc::DeviceError, "the head is too hot");
        stand->cell().set_too_hot(false);
      });
}

TIMED_TEST(LaserFaults, OpenDoorEndsTheScanAndAClosedOneAllowsTheNext) {
  if (!set_up()) return;
  check_dark(
      "door opened", [&] { stand->cell().set_door(false); },
      [&] {
        CHECK(stand->take_end());
        check_ended(*stand, Errc::InterlockOpen, "the interlock is open");
        stand->cell().set_door(true);
      });
}

TIMED_TEST(LaserFaults, SilentCameraEndsTheScan) {
  if (!set_up()) return;
  check_dark(
      "camera silent", [&] { stand->cell().faults.camera_silent = true; },
      [&] {
        CHECK(stand->take_end());
        check_ended(*stand, Errc::Timeout, "the camera gives no frames");
        stand->cell().faults.camera_silent = false;
      });
}

TIMED_TEST(LaserFaults, UnpluggedCameraIsFoundAgainByTheNextScan) {
  if (!set_up()) return;
  check_dark(
      "camera unplugged", [&] { stand->cell().unplug_camera(); },
      [&] {
        CHECK(stand->take_end());
        CHECK(stand->account().end->errc != 0);
        // While it is away a scan is refused, and says what is missing.
        const auto refused = stand->start_scan();
        CHECK(refused.has_value());
        STRCMP_CONTAINS("camera", refused->c_str());
        stand->cell().plug_camera();
        // A camera that went away without a word is let go of after some seconds; until then scans are
        // refused.
        CHECK(stand->take_until([&] { return !stand->start_scan(); }));
        stand->command(wire::Command::StopScan);
        CHECK(stand->take_end());
      });
}

TIMED_TEST(LaserFaults, HostThatAsksForDarknessGetsIt) {
  if (!set_up()) return;
  check_dark(
      "host asked",
      [&] {
        stand->command(wire::Command::LaserOff);
        stand->take_until([&] { return !stand->cell().laser_on(); });
      },
      [&] {
        CHECK(stand->take_end());
        check_ended(*stand, Errc::PeerRefused, "a host asked for it");
      });
}

TIMED_TEST(LaserFaults, LaserDoesNotShineOnForAbsentHostsAndNothingOfTheScanIsLost) {
  if (!set_up()) return;
  const auto refused = stand->start_scan();
  CHECK_TEXT(!refused, refused.value_or("").c_str());
  stand->leave();
  CHECK_TEXT(stand->dark_after_ms(now()).has_value(), "the laser shines on");
  stand->come_back();
  CHECK(stand->take_end());
  check_ended(*stand, Errc::ConnectionLost, "no host");
  LONGS_EQUAL(0, stand->account().lost);
  LONGS_EQUAL(0, stand->account().wrong);
  const wire::Counters& counters = stand->account().end->counters;
  LONGS_EQUAL(counters.profiles - counters.profiles_dropped, stand->account().profiles);
  CHECK(!stand->start_scan());
}

}  // namespace biteline::test
