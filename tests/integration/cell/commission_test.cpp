// SPDX-License-Identifier: MIT
/// \file From a head of which nothing is known to a line that lies where it belongs: `biteline capture` with
/// the simulated cell's camera, arm and laser, then `biteline calibrate`, then a scan.
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/config/sensor_yaml.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/live/live_cell.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/head_points.hpp"
#include "tests/support/json.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/said.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::sim {

namespace {

using intake::ChildProcess;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace fs = std::filesystem;

LiveSettings settings_of(const TargetShowSettings& targets) {
  LiveSettings settings;
  settings.scene = {.shoe = draw_shoe(ShoeClass::Deep, 4),
                    .head_seed = 33,
                    .holder = Holder::Bracket,
                    .fineness = {.column_mm = 2.0, .coarse_row_mm = 1.0}};
  settings.wires = "biteline-commission-" + std::to_string(getpid());
  settings.targets = targets;
  return settings;
}

/// The standard fixes the camera's port, so one camera at a time lives on an address.
std::unique_ptr<LiveCell> open_cell(const LiveSettings& settings) {
  const auto patience_ends = hal::monotonic_now() + seconds{15};
  do {
    if (auto cell = LiveCell::open(settings)) {
      test::note_ran();
      return std::move(*cell);
    }
    std::this_thread::sleep_for(milliseconds{100});
  } while (hal::monotonic_now() < patience_ends);
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

}  // namespace

TEST_GROUP(Commission) {
  test::TemporaryFolder folder;
  fs::path calib{folder.path() / "calib"}, board{folder.path() / "board.yaml"};
  std::unique_ptr<LiveCell> cell;
  std::vector<std::string> said;

  bool open(const TargetShowSettings& targets) {
    cell = open_cell(settings_of(targets));
    if (!cell) return false;
    folder.write("board.yaml", board_yaml_text({.wires = cell->settings().wires}));
    const auto text_of = [squares = targets.chessboard_squares](const RingGrid& grid) {
      return grid_text(squares > 0 ? grid.as_chessboard(squares) : grid);
    };
    folder.write("target.yaml", text_of(RingGrid{}));
    folder.write("two.yaml", "planes: 2\n" + text_of(plane_grid()));
    return true;
  }

  /// The wizard, with an arm that goes to the next place when a picture was taken.  Its exit status.
  int capture(const std::string& part, const char* target, std::size_t first, int count,
              const std::vector<std::string>& more = {}, int most_refusals = 1000) {
    cell->show_target(first);
    std::vector<std::string> words{"capture",      part,
                                   calib.string(), "--auto",
                                   "--board",      board.string(),
                                   "--target",     (folder.path() / target).string(),
                                   "--pictures",   std::to_string(count),
                                   "--rt",         "ignore"};
    words.insert(words.end(), more.begin(), more.end());
    auto tool = ChildProcess::start({.program = BITELINE_TOOL, .arguments = words});
    SUCCEEDS(tool);
    std::size_t place = first;
    for (;;) {
      const auto line = tool->next_line(seconds{60});
      if (!line) break;
      said.push_back(*line);
      const bool taken = line->starts_with("kept") || line->starts_with("not kept");
      if (line->starts_with("not kept") && --most_refusals == 0) return tool->stop();
      if (taken && place + 1 < cell->targets()->count()) cell->show_target(++place);
    }
    const auto status = tool->wait(seconds{60});
    SUCCEEDS(status);
    if (*status != 0) said.push_back(tool->last_words());
    return *status;
  }
  std::string all_said() const {
    std::string text;
    for (const std::string& line : said) text += line + "\n";
    return text;
  }

  static test::Said run(const char* program, const std::vector<std::string>& words) {
    return test::said_by(program, words, seconds{180});
  }

  /// A shoe's line by the sensor program with `sensor_file` and a settings file, and the service; its mean
  /// error. A scan that a busy machine ended is tried again.
  double scanned_line_error_mm(const fs::path& sensor_file, const geometry::SensorModel& head) {
    const auto& region = head.region;
    char text[300];
    std::snprintf(text, sizeof text,
                  "camera: {exposure_us: %.3f, rate_hz: 30}\nregion: {left_px: %d, top_px: %d, width_px: %d, "
                  "height_px: %d}\n...\n",
                  1e-3 * static_cast<double>(head.exposure->count()), region.offset_u_px, region.offset_v_px,
                  region.width_px, region.height_px);
    const std::string set = folder.write("set.yaml", text);
    // The sensor runs without real-time rights here: what else the machine does makes its frames late.
    constexpr int k_attempts = 10;
    std::string told;
    for (int attempt = 0; attempt < k_attempts; ++attempt) {
      const fs::path place = folder.path() / ("place-" + std::to_string(attempt)), out = place / "service";
      auto serving =
          ChildProcess::start({.program = BITELINE_CELL,
                               .arguments = {"serve", "--head", "33", "--speed-mm-s", "60", "--rate-hz", "30",
                                             "--out", place, "--exit-with-parent"}});
      SUCCEEDS(serving);
      if (const auto ready = serving->next_line(seconds{60}); !ready) {
        told = to_line(ready.error());
        std::this_thread::sleep_for(seconds{2});
        continue;
      }
      auto sensor =
          intake::SensorProcess::start(*intake::find_sensor_program(),
                                       {"--source", "board:" + (place / "board.yaml").string(), "--sensor",
                                        sensor_file.string(), "--settings", set, "--rt", "ignore"},
                                       seconds{30});
      SUCCEEDS(sensor);
      const test::Said scan =
          run(BITELINE_HOST, {"--sensor", sensor->endpoint().text(), "--out", out.string(), "--once"});
      told = scan.out + scan.last_error;
      const fs::path line = out / "scan-0001/line.csv";
      if (scan.status != 0 || !fs::exists(line)) continue;
      const test::Said judged = run(BITELINE_TOOL, {"evaluate", "--json", "--line", line.string(), "--truth",
                                                    (place / "truth/groove.csv").string()});
      LONGS_EQUAL_TEXT(0, judged.status, judged.last_error.c_str());
      return test::read_json(judged.out).at("mean").get<double>();
    }
    FAIL(told.c_str());
    return 0;
  }
};

LONG_GROUP(Commission){};

TIMED_TEST(Commission, AnUncalibratedHeadIsCalibratedFromLivePictures) {
  const TargetShowSettings targets{.camera_places = 10, .laser_places = 6, .hand_eye_places = 10};
  if (!open(targets)) return;
  LONGS_EQUAL_TEXT(0, capture("camera", "target.yaml", 0, 10), all_said().c_str());
  LONGS_EQUAL_TEXT(0, capture("laser", "two.yaml", 10, 6), all_said().c_str());
  LONGS_EQUAL_TEXT(0, capture("hand-eye", "target.yaml", 16, 10), all_said().c_str());
  STRCMP_CONTAINS("wanted next:", all_said().c_str());
  CHECK_FALSE(cell->level(Line::LaserEnable));
  // Lit for the laser's six pictures, and again only where one was taken again.
  CHECK(cell->lightings() >= 6);
  const geometry::SensorModel truth = cell->scene().head.model;
  cell.reset();

  const fs::path out = folder.path() / "result";
  const test::Said calibrated = run(BITELINE_TOOL, {"calibrate", calib.string(), "--out", out.string()});
  LONGS_EQUAL_TEXT(0, calibrated.status, calibrated.last_error.c_str());
  const auto found = config::read_sensor_yaml(out / "sensor.yaml");
  SUCCEEDS(found);
  STRCMP_CONTAINS("calibration: ", calibrated.out.c_str());
  CHECK(calibrated.out.find("calibration: bad") == std::string::npos);
  // As good as the accuracy of a line, over the working region.
  CHECK_COMPARE(test::farthest_mm(truth, *found), <, 0.1);
  // The bar of the whole: what was commissioned finds a line.
  CHECK_COMPARE(scanned_line_error_mm(out / "sensor.yaml", truth), <, 0.1);
}

TIMED_TEST(CommissionLong, ChessboardsAreTakenByTheSameWizard) {
  if (!open({.camera_places = 5, .laser_places = 3, .hand_eye_places = 0, .chessboard_squares = 2})) return;
  LONGS_EQUAL_TEXT(0, capture("camera", "target.yaml", 0, 5), all_said().c_str());
  STRCMP_CONTAINS("camera pictures: 5, good is 8", all_said().c_str());
  LONGS_EQUAL_TEXT(0, capture("laser", "two.yaml", 5, 3), all_said().c_str());
  STRCMP_CONTAINS("laser: fair", all_said().c_str());
  CHECK(all_said().find("corners are not seen") == std::string::npos);
  CHECK_FALSE(cell->level(Line::LaserEnable));
}

TIMED_TEST(CommissionLong, WhatIsNoPictureIsNotKept) {
  if (!open({.camera_places = 3, .laser_places = 1, .hand_eye_places = 0})) return;
  // A thirtieth of the lamp's exposure: dark.
  capture("camera", "target.yaml", 0, 1, {"--exposure-us", "600"}, 2);
  STRCMP_CONTAINS("not kept: ", all_said().c_str());
  CHECK_FALSE(fs::exists(calib / "camera/00.png"));
}

TIMED_TEST(Commission, TheCellsProgramShowsTargetsPlaceByPlace) {
  const fs::path out = folder.path() / "cell";
  auto serving = ChildProcess::start(
      {.program = BITELINE_CELL, .arguments = {"serve", "--targets", "--out", out, "--exit-with-parent"}});
  SUCCEEDS(serving);
  SUCCEEDS(serving->next_line(seconds{60}));
  auto tool = ChildProcess::start(
      {.program = BITELINE_TOOL,
       .arguments = {"capture", "camera", calib, "--auto", "--board", out / "board.yaml", "--target",
                     out / "target.yaml", "--pictures", "3", "--rt", "ignore"}});
  SUCCEEDS(tool);
  while (const auto line = tool->next_line(seconds{60})) {
    said.push_back(*line);
    if (line->starts_with("kept") || line->starts_with("not kept")) ::kill(serving->pid(), SIGUSR1);
  }
  const auto status = tool->wait(seconds{60});
  SUCCEEDS(status);
  LONGS_EQUAL_TEXT(0, *status, (all_said() + tool->last_words()).c_str());
  // A picture of a place that is as one before is not kept: the head went on.
  for (const char* picture : {"00.png", "01.png", "02.png"}) CHECK(fs::exists(calib / "camera" / picture));
}

TIMED_TEST(Commission, AnOpenDoorMeansNoLaserPicture) {
  if (!open({.camera_places = 0, .laser_places = 2, .hand_eye_places = 0})) return;
  cell->drive(Line::Interlock, false);
  CHECK(capture("laser", "two.yaml", 0, 1) != 0);
  STRCMP_CONTAINS("the interlock is open", all_said().c_str());
  LONGS_EQUAL(0, cell->counts().exposures_lit);
  CHECK_FALSE(fs::exists(calib / "laser/00_laser.png"));
}

TIMED_TEST(CommissionLong, AScanIsKeptAsASessionWhoseReplayFindsTheLine) {
  constexpr int k_attempts = 4;
  std::string told;
  for (int attempt = 0; attempt < k_attempts; ++attempt) {
    const fs::path place = folder.path() / ("place-" + std::to_string(attempt)), session = place / "scan";
    auto serving = ChildProcess::start({.program = BITELINE_CELL,
                                        .arguments = {"serve", "--speed-mm-s", "60", "--rate-hz", "30",
                                                      "--out", place, "--exit-with-parent"}});
    SUCCEEDS(serving);
    const auto ready = serving->next_line(seconds{60});
    if (!ready) {
      told = to_line(ready.error());
      std::this_thread::sleep_for(seconds{2});
      continue;
    }
    const auto files = test::read_json(*ready);
    const std::vector<std::string> words{"capture",
                                         "scan",
                                         session.string(),
                                         "--board",
                                         files.at("board").get<std::string>(),
                                         "--sensor",
                                         files.at("sensor").get<std::string>(),
                                         "--rt",
                                         "ignore"};
    const test::Said taken = run(BITELINE_TOOL, words);
    told = taken.out + taken.last_error;
    // A busy machine may end a scan: that is told, and nothing else is.
    if (taken.status != 0) {
      CHECK_TEXT(taken.out.find("scan: bad") != std::string::npos ||
                     taken.last_error.find("scan did not begin") != std::string::npos,
                 told.c_str());
      continue;
    }
    STRCMP_CONTAINS(" profiles without stripe", taken.out.c_str());
    STRCMP_CONTAINS("biteline replay", taken.out.c_str());
    const test::Said again = run(BITELINE_TOOL, words);
    CHECK(again.status != 0);
    STRCMP_CONTAINS("name another folder", again.last_error.c_str());
    const fs::path out = place / "line";
    const test::Said line = run(BITELINE_TOOL, {"replay", session.string(), "--out", out.string()});
    LONGS_EQUAL_TEXT(0, line.status, line.last_error.c_str());
    const test::Said judged = run(BITELINE_TOOL, {"evaluate", "--json", "--line", (out / "line.csv").string(),
                                                  "--truth", (place / "truth/groove.csv").string()});
    LONGS_EQUAL_TEXT(0, judged.status, judged.last_error.c_str());
    CHECK_COMPARE(test::read_json(judged.out).at("mean").get<double>(), <, 0.1);
    return;
  }
  FAIL(told.c_str());
}

TIMED_TEST(Commission, AScanBehindAnOpenDoorIsBadAndSaysWhy) {
  if (!open({.camera_places = 1, .laser_places = 0, .hand_eye_places = 0})) return;
  cell->drive(Line::Interlock, false);
  folder.write("sensor.yaml", config::sensor_yaml_text(cell->scene().head.model, ""));
  const test::Said taken =
      run(BITELINE_TOOL, {"capture", "scan", (folder.path() / "scan").string(), "--board", board.string(),
                          "--sensor", (folder.path() / "sensor.yaml").string(), "--rt", "ignore"});
  LONGS_EQUAL_TEXT(3, taken.status, taken.last_error.c_str());
  STRCMP_CONTAINS("scan: bad", taken.out.c_str());
  STRCMP_CONTAINS("the interlock is open", taken.out.c_str());
  LONGS_EQUAL(0, cell->counts().exposures_lit);
}

}  // namespace biteline::sim
