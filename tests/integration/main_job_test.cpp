// SPDX-License-Identifier: MIT
// The main job from made scenes, by the programs themselves: scan, line, path, the arm following it.
#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "host/bite_line/evaluation/line_error.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(MainJob) {
  test::TemporaryFolder folder;

  static int run(const char* program, const std::vector<std::string>& arguments) {
    auto child =
        intake::ChildProcess::start({.program = program, .arguments = arguments, .pass_stderr = true});
    SUCCEEDS(child);
    const auto status = child->wait(1500s);
    SUCCEEDS(status);
    return *status;
  }

  struct Bars {
    double mean_mm, p95_mm;
  };
  /// What the product promises for such shoes (issue of the bite line): a twentieth of a millimetre on
  /// average.
  static constexpr Bars k_groove_bars{.mean_mm = 0.05, .p95_mm = 0.12};
  /// The same by an arm that sways: 0.05 mm at 250 mm/s and 0.1 mm at 500, so 0.08 mm at the demo's 400.
  static constexpr Bars k_swaying_bars{.mean_mm = 0.08, .p95_mm = 0.2};
  /// The same for an upper whose last differs from the sample's by 0.15 mm.
  static constexpr Bars k_transfer_bars{.mean_mm = 0.15, .p95_mm = 0.35};

  static void line_is_right(const fs::path& line, const fs::path& truth, const Bars& bars = k_groove_bars) {
    const auto found = cloud::read_line(line);
    SUCCEEDS(found);
    const auto known = cloud::read_positions(truth);
    SUCCEEDS(known);
    const evaluation::LineError error = evaluation::line_error(*found, *known);
    CHECK_COMPARE(error.mean_mm, <=, bars.mean_mm);
    CHECK_COMPARE(error.p95_mm, <=, bars.p95_mm);
    CHECK_COMPARE(error.complete, >=, 0.99);
  }

  /// The last one counts: a busy machine may have cut an earlier one short.
  static fs::path last_scan(const fs::path& folder) {
    fs::path scan;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().filename().string().starts_with("scan-")) scan = std::max(scan, entry.path());
    }
    return scan;
  }

  static nlohmann::json read_json(const fs::path& file) {
    std::ifstream stream(file);
    return test::read_json(stream);
  }

  /// Each shoe is scanned, its line is right, and the arm follows it.
  void demo_scans_and_follows(int uppers) {
    const fs::path out = folder.path() / "demo";
    LONGS_EQUAL(0, run(BITELINE_TOOL,
                       {"demo", "--out", out.string(), "--uppers", std::to_string(uppers), "--quiet"}));
    CHECK(fs::exists(out / "index.html"));
    LONGS_EQUAL(1 + uppers, read_json(out / "report.json")["shoes"].size());
    std::vector<std::string> shoes{"sample"};
    for (int upper = 1; upper <= uppers; ++upper) shoes.push_back("upper-" + std::to_string(upper));
    for (const std::string& shoe : shoes) {
      const fs::path scan = last_scan(out / shoe);
      const Bars bars = shoe == "sample" ? k_swaying_bars : k_transfer_bars;
      line_is_right(scan / "line.csv", out / shoe / "cell/truth/groove.csv", bars);
      for (const char* file :
           {"index.html", "path/path.csv", "path/path.script", "path/tracking.html", "track.csv"}) {
        CHECK_TEXT(fs::exists(scan / file), (scan / file).c_str());
      }
      const auto followed = read_json(scan / "followed.json");
      CHECK(followed["completed"].get<bool>());
      // An arm with joints of 8 Hz gives by a / (2 pi 8)^2, 0.4 mm per m/s^2; where the wrist turns the tool
      // quickest its tip is accelerated by less than 1.5 m/s^2.
      CHECK_COMPARE(followed["from_path_mm"]["max"].get<double>(), <=, 0.6);
      CHECK_COMPARE(followed["from_path_mm"]["p95"].get<double>(), <=,
                    followed["from_path_mm"]["max"].get<double>());
      CHECK_COMPARE(followed["covered"].get<double>(), >=, 0.99);
    }
  }
};

LONG_GROUP(MainJob){};

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

TIMED_TEST(MainJob, DemoScansASampleAndTheUpperAfterItPlansAndFollows) {
  demo_scans_and_follows(1);
}

TIMED_TEST(MainJobLong, DemoScansASampleAndTheUppersAfterItPlansAndFollows) {
  demo_scans_and_follows(2);
}

}  // namespace biteline
