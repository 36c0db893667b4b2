// SPDX-License-Identifier: MIT
// Settings that a host sends: taken as a whole or not at all, while a scan is on and between scans.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>

#include "common/settings/settings.hpp"
#include "host/intake/child_process.hpp"
#include "tests/integration/faults/fault_stand.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::test {

using settings::Key;

TEST_GROUP(SentSettings) {
  std::unique_ptr<FaultStand> stand;

  static std::string file(const std::string& body) {
    return body + "\n...\n";
  }
  /// What the sensor says that it runs with, once it has said it anew.
  settings::SettingsSet in_use() {
    CHECK(stand->take_health());
    const auto set = settings::parse_settings(stand->settings().text, "in use");
    SUCCEEDS(set);
    return *set;
  }
  void refused(const std::string& body, const char* words) {
    CHECK(stand->take_health());
    const std::string before = stand->settings().text;
    STRCMP_CONTAINS(words, stand->send_settings(file(body)).c_str());
    CHECK(stand->take_health());
    STRCMP_EQUAL(before.c_str(), stand->settings().text.c_str());
  }
  void taken(const std::string& body) {
    STRCMP_EQUAL("", stand->send_settings(file(body)).c_str());
  }
  void end_scan() {
    stand->command(wire::Command::StopScan);
    CHECK(stand->take_end());
    LONGS_EQUAL(0, stand->account().end->errc);
    LONGS_EQUAL(0, stand->account().end->counters.frames_damaged);
  }
};

LONG_GROUP(SentSettings){};

TIMED_TEST(SentSettings, RunningScanTakesExposureAndPeaksAtOnceAndRefusesTheRestByName) {
  stand = FaultStand::set_up();
  if (!stand) return;
  const auto begun = stand->start_scan();
  CHECK_TEXT(!begun, begun.value_or("").c_str());
  const double before_us = *in_use().number(Key::ExposureUs);
  const double less_us = 0.5 * before_us;
  taken("camera: {exposure_us: " + std::to_string(less_us) +
        "}\npeaks: {threshold_grey: 20, choice: strongest}");
  const settings::SettingsSet now = in_use();
  CHECK(std::abs(*now.number(Key::ExposureUs) - less_us) < 20);
  LONGS_EQUAL(20, static_cast<int>(*now.number(Key::PeakThreshold)));
  STRCMP_EQUAL("strongest", now.word(Key::PeakChoice)->c_str());
  LONGS_EQUAL(1, stand->settings().changes);
  LONGS_EQUAL(0, stand->account().with(profile::k_profile_stripe_lost));
  // No stripe is so bright: the next profiles have no points.
  taken("peaks: {threshold_grey: 254}");
  CHECK(stand->take_profiles(20));
  CHECK(stand->account().with(profile::k_profile_stripe_lost) > 0);
  taken("note: as it was");
  refused("region: {left_px: 0, top_px: 0, width_px: 640, height_px: 64}",
          "while a scan is on; stop the scan first");
  refused("camera: {rate_hz: 50, exposure_us: 100}", "camera.rate_hz");
  refused("camera: {exposure_us: 100, auto_exposure: true}", "camera.auto_exposure");
  refused("camera: {exposure_us: 9000000}", "camera.exposure_us");
  refused("peaks: {threshold_grey: 300}", "peaks.threshold_grey");
  refused("camera: {exposure_us: 100", "settings");
  CHECK(stand->cell().laser_on());
  end_scan();
}

TIMED_TEST(SentSettingsLong, NextScanHasWhatWasSentBetweenScansAndNothingOfWhatWasRefused) {
  stand = FaultStand::set_up();
  if (!stand) return;
  refused("camera: {gain: 1e4}", "camera.gain");
  refused("camera: {rate_hz: 15}", "camera.rate_hz: 20 Hz or more");
  refused("camera: {rate_hz: 50}\nregion: {left_px: 0, top_px: 0, width_px: 2000, height_px: 64}",
          "region.width_px");
  refused("region: {left_px: 0, top_px: 0, width_px: 9999, height_px: 64}", "region.width_px: at most ");
  refused("camera: {rate_hz: 50, second_exposure_us: 1}", "second exposure");
  LONGS_EQUAL(100, static_cast<int>(*stand->hello().model.rate_hz));
  taken("camera: {rate_hz: 50}");
  const auto begun = stand->start_scan();
  CHECK_TEXT(!begun, begun.value_or("").c_str());
  LONGS_EQUAL(50, static_cast<int>(*stand->hello().model.rate_hz));
  LONGS_EQUAL(50, static_cast<int>(*in_use().number(Key::RateHz)));
  end_scan();
}

TIMED_TEST(SentSettingsLong, TestPatternIsDarkKnownAndNobodysShoe) {
  const TemporaryFolder folder;
  const std::string series = (folder.path() / "scan").string();
  stand = FaultStand::set_up({}, {"--record", series});
  if (!stand) return;
  taken("camera: {test_pattern: true}");
  CHECK(in_use().on(Key::TestPattern).value_or(false));
  stand->command(wire::Command::StartScan);
  CHECK(stand->take_profiles(100));
  CHECK(!stand->cell().laser_on());
  CHECK(stand->hello().test_pattern);
  CHECK(stand->account().with(profile::k_profile_frame_damaged) >= 100);
  LONGS_EQUAL(0, stand->account().with(profile::k_profile_stripe_lost));
  refused("camera: {test_pattern: false}", "camera.test_pattern: it stays on while a scan is on");
  // Longer than a scan waits for its light.
  CHECK(stand->take_profiles(600));
  CHECK(!stand->cell().laser_on());
  end_scan();
  CHECK(!std::filesystem::exists(series));
  taken("note: as it was");
  CHECK(!in_use().at(Key::TestPattern));
  const auto begun = stand->start_scan();
  CHECK_TEXT(!begun, begun.value_or("").c_str());
  CHECK(!stand->hello().test_pattern);
  refused("camera: {test_pattern: true}", "a recording is on");
  end_scan();
  CHECK(std::filesystem::exists(series));
  LONGS_EQUAL(0, stand->account().with(profile::k_profile_frame_damaged));
}

TIMED_TEST(SentSettings, ToolSendsAFileAndFetchesWhatIsInUse) {
  stand = FaultStand::set_up();
  if (!stand) return;
  const TemporaryFolder folder;
  const auto tool = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "settings");
    arguments.insert(arguments.end(), {"--at", stand->sensor().endpoint().text()});
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    std::string said;
    while (const auto line = child->next_line(std::chrono::seconds{30})) said += *line + "\n";
    const auto status = child->wait(std::chrono::seconds{30});
    SUCCEEDS(status);
    return std::to_string(*status) + ": " + said + child->last_words();
  };
  const std::string set = folder.write("set.yaml", file("peaks: {choice: last}")).string();
  STRCMP_CONTAINS("0: ", tool({"send", set}).c_str());
  STRCMP_CONTAINS("choice: last", tool({"fetch"}).c_str());
  const std::string wrong = folder.write("wrong.yaml", file("camera: {gain: 1e4}")).string();
  const std::string refusal = tool({"send", wrong});
  STRCMP_CONTAINS("4: ", refusal.c_str());
  STRCMP_CONTAINS("camera.gain", refusal.c_str());
  STRCMP_CONTAINS("choice: last", tool({"fetch"}).c_str());
}

}  // namespace biteline::test
