// SPDX-License-Identifier: MIT
// What a host may ask of a unit beside a scan: a recording that is to be kept, and what the unit has been
// through.
#include <CppUTest/TestHarness.h>

#include <filesystem>
#include <memory>

#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::test {

namespace fs = std::filesystem;

TEST_GROUP(Asked) {
  TemporaryFolder folder;
  fs::path series = folder.path() / "scan";
  std::unique_ptr<FaultStand> stand;

  void begin_scan() {
    const auto begun = stand->start_scan();
    CHECK_TEXT(!begun, begun.value_or("").c_str());
  }
  void end_scan() {
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
    LONGS_EQUAL(0, stand->account().end->errc);
  }
  void scan() {
    begin_scan();
    end_scan();
  }
  /// The disk may still be at work.
  wire::ControlReply keep_last() {
    for (int i = 0; i < 300; ++i) {
      const wire::ControlReply reply = stand->ask(wire::Command::KeepLast);
      if (reply.errc != static_cast<int>(Errc::WrongState)) return reply;
      std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    return {};
  }
  void refused(wire::Command command, Errc code, const char* words) {
    const wire::ControlReply reply = stand->ask(command);
    LONGS_EQUAL(static_cast<int>(code), reply.errc);
    STRCMP_CONTAINS(words, reply.where.c_str());
  }
};

LONG_GROUP(Asked){};

TIMED_TEST(Asked, RecordingIsKeptWhenAHostAsksAndNoOtherOne) {
  stand = FaultStand::set_up({}, {"--record", series.string(), "--record-asked"});
  if (!stand) return;
  refused(wire::Command::KeepLast, Errc::FileNotFound, "no scan waits there");
  scan();
  wire::ControlReply reply = keep_last();
  LONGS_EQUAL_TEXT(0, reply.errc, reply.where.c_str());
  STRCMP_EQUAL(series.c_str(), reply.where.c_str());
  CHECK(fs::exists(series / "recording.yaml"));
  refused(wire::Command::KeepLast, Errc::FileNotFound, "no scan waits there");
  // While a scan is on: it is the one that ends next, and its laser shines on.
  begin_scan();
  reply = stand->ask(wire::Command::KeepNext);
  LONGS_EQUAL_TEXT(0, reply.errc, reply.where.c_str());
  STRCMP_CONTAINS("the scan that ends next", reply.where.c_str());
  CHECK(stand->cell().laser_on());
  end_scan();
  const fs::path second = series.string() + "-2";
  for (int i = 0; i < 300 && !fs::exists(second); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{50});
  CHECK(fs::exists(second / "recording.yaml"));
  CHECK(!fs::exists(series.string() + ".wanted"));
}

TIMED_TEST(AskedLong, SensorThatRecordsNothingOrEverythingSaysWhy) {
  stand = FaultStand::set_up();
  if (!stand) return;
  refused(wire::Command::KeepLast, Errc::NotSupported, "records nothing");
  refused(wire::Command::KeepNext, Errc::NotSupported, "records nothing");
  CHECK(stand->take_health());
  CHECK(!stand->upkeep());
  stand.reset();
  stand = FaultStand::set_up({}, {"--record", series.string()});
  if (!stand) return;
  refused(wire::Command::KeepNext, Errc::NotSupported, "--record-asked");
}

TIMED_TEST(AskedLong, UnitTellsWhatItHasBeenThroughOverItsRestarts) {
  stand = FaultStand::set_up({}, {"--upkeep", folder.path().string()});
  if (!stand) return;
  CHECK(stand->take_health());
  CHECK(stand->upkeep().has_value());
  LONGS_EQUAL(1, stand->upkeep()->starts);
  LONGS_EQUAL(0, stand->upkeep()->lightings);
  scan();
  // The main thread looks fifty times a second, the health goes out four times.
  CHECK(stand->take_health());
  CHECK(stand->take_health());
  LONGS_EQUAL(1, stand->upkeep()->lightings);
  CHECK(stand->upkeep()->laser_s > 0 && stand->upkeep()->laser_s < stand->upkeep()->run_s);
  CHECK(stand->upkeep()->frames > 0);
  stand->replace_sensor();
  CHECK(stand->take_health());
  LONGS_EQUAL(2, stand->upkeep()->starts);
  LONGS_EQUAL(1, stand->upkeep()->boots);
}

}  // namespace biteline::test
