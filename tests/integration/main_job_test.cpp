// SPDX-License-Identifier: MIT
// The main job from made scenes, by the programs themselves: scan, line, path, the arm following it.
#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "host/line/closed_line.hpp"
#include "host/measure/line_error.hpp"
#include "host/process/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(MainJob) {
  test::TemporaryFolder folder;

  static int run(const char* program, const std::vector<std::string>& arguments) {
    auto child = process::ChildProcess::start({.program = program, .arguments = arguments, .pass_stderr = true});
    SUCCEEDS(child);
    const auto status = child->wait(150s);
    SUCCEEDS(status);
    return *status;
  }

  /// What the product promises for such shoes (issue of the bite line): a twentieth of a millimetre on average.
  static void line_is_right(const fs::path& line, const fs::path& truth) {
    const auto found = line::read_line(line);
    SUCCEEDS(found);
    const auto known = line::read_positions(truth);
    SUCCEEDS(known);
    const measure::LineError error = measure::line_error(*found, *known);
    CHECK_COMPARE(error.mean_mm, <=, 0.05);
    CHECK_COMPARE(error.p95_mm, <=, 0.12);
    CHECK_COMPARE(error.complete, >=, 0.99);
  }

  static nlohmann::json read_json(const fs::path& file) {
    std::ifstream stream(file);
    return nlohmann::json::parse(stream, nullptr, false);
  }
};

TEST(MainJob, RecordedMadeScanGivesTheCellsOwnGroove) {
  const fs::path session = folder.path() / "session", out = folder.path() / "out";
  LONGS_EQUAL(0, run(BITELINE_CELL, {"record", "--shoe", "step", "--seed", "8", "--out", session.string()}));
  LONGS_EQUAL(0, run(BITELINE_TOOL, {"replay", session.string(), "--out", out.string(), "--quiet"}));
  line_is_right(out / "line.csv", session / "truth/groove.csv");
}

TEST(MainJob, RecordedMadeUpperIsRefused) {
  const fs::path session = folder.path() / "session", out = folder.path() / "out";
  LONGS_EQUAL(0, run(BITELINE_CELL, {"record", "--shoe", "bare", "--seed", "8", "--out", session.string()}));
  LONGS_EQUAL(3, run(BITELINE_TOOL, {"replay", session.string(), "--out", out.string(), "--quiet"}));
  CHECK(!fs::exists(out / "line.csv"));
  CHECK(read_json(out / "report.json")["reason"].get<std::string>().starts_with("no crease"));
}

TEST(MainJob, DemoScansPlansAndFollows) {
  const fs::path out = folder.path() / "demo";
  LONGS_EQUAL(0, run(BITELINE_TOOL, {"demo", "--out", out.string(), "--quiet"}));
  CHECK(fs::exists(out / "index.html"));
  fs::path scan;  // the last one counts: a busy machine may have cut an earlier one short
  for (const auto& entry : fs::directory_iterator(out)) {
    if (entry.path().filename().string().starts_with("scan-")) scan = std::max(scan, entry.path());
  }
  line_is_right(scan / "line.csv", out / "cell/truth/groove.csv");
  for (const char* file : {"path/path.csv", "path/path.script", "path/tracking.html", "track.csv"}) CHECK_TEXT(fs::exists(scan / file), file);
  const auto followed = read_json(scan / "followed.json");
  CHECK(followed["completed"].get<bool>());
  // The simulated controller blends corners by at most the path's own tolerance of 0.05 mm; the line's waypoints are chords.
  CHECK_COMPARE(followed["from_path_mm"]["max"].get<double>(), <=, 0.1);
  CHECK_COMPARE(followed["covered"].get<double>(), >=, 0.99);
}

}  // namespace biteline
