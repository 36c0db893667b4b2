// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/made_times.hpp"

#include <CppUTest/TestHarness.h>

#include <sstream>

#include "tests/support/temporary_folder.hpp"

namespace biteline::demo {

TEST_GROUP(MadeTimes) {
  test::TemporaryFolder folder;

  /// Rows each 10 ms over so many seconds, as a cell writes them.
  struct Part {
    double real_s;
    int program, scans;
    double time_ratio;
    double pause_s{0};  ///< before it: the arm stands, no rows
  };
  static std::string track(const std::vector<Part>& parts) {
    std::string text = "#timestamp [ns],p_x [mm],...\n";
    long long now_ms = 7000;
    for (const Part& part : parts) {
      now_ms += std::lround(1000 * part.pause_s);
      for (int i = 0; i < std::lround(100 * part.real_s); ++i, now_ms += 10) {
        char row[200];
        std::snprintf(row, sizeof row, "%lld000000,1.5,2.5,-3.5,1,0,0,0,%d,%d,%d,%.4g\n", now_ms,
                      part.program, part.program, part.scans, part.time_ratio);
        text += row;
      }
    }
    return text;
  }
  /// There, scan, rest, then the program; the scan at half of real time.
  static std::string half_as_fast() {
    return track({{.real_s = 1, .program = 0, .scans = 0, .time_ratio = 0.5},
                  {.real_s = 5, .program = 0, .scans = 1, .time_ratio = 0.5},
                  {.real_s = 0.8, .program = 0, .scans = 0, .time_ratio = 0.5},
                  {.real_s = 9, .program = 1, .scans = 0, .time_ratio = 1, .pause_s = 0.3}});
  }
};

TEST(MadeTimes, ASlowedScanCountsAsTheArmWouldMakeIt) {
  std::istringstream text{half_as_fast()};
  const auto times = arm_times(text);
  CHECK(times.has_value());
  constexpr double k_row_s = 0.011;
  DOUBLES_EQUAL(2.5, times->scan_s, k_row_s);
  DOUBLES_EQUAL(0.4, times->rest_s, k_row_s);
  DOUBLES_EQUAL(0.8, times->rest_real_s, k_row_s);
  DOUBLES_EQUAL(1.1, times->gap_real_s, 2 * k_row_s);
  DOUBLES_EQUAL(9, times->program_s, k_row_s);
}

TEST(MadeTimes, TheLastScanAndItsProgramCount) {
  std::istringstream text{track({{.real_s = 2, .program = 0, .scans = 1, .time_ratio = 1},
                                 {.real_s = 8, .program = 1, .scans = 0, .time_ratio = 1},
                                 {.real_s = 3, .program = 0, .scans = 1, .time_ratio = 1},
                                 {.real_s = 6, .program = 1, .scans = 0, .time_ratio = 1}})};
  const auto times = arm_times(text);
  CHECK(times.has_value());
  DOUBLES_EQUAL(3, times->scan_s, 0.011);
  DOUBLES_EQUAL(6, times->program_s, 0.011);
}

TEST(MadeTimes, WithoutAProgramAfterTheScanThereAreNone) {
  std::istringstream text{track({{.real_s = 2, .program = 1, .scans = 0, .time_ratio = 1},
                                 {.real_s = 2, .program = 0, .scans = 1, .time_ratio = 1}})};
  CHECK(!arm_times(text).has_value());
}

TEST(MadeTimes, ComputingCountsInRealTimeBesideTheArmsRest) {
  folder.write("cell/track.csv", half_as_fast());
  folder.write("scan/report.json", R"({"stages":{"last profile to line":0.1}})");
  folder.write("scan/path/report.json", R"({"stages":{"plan":0.6}})");
  folder.write("scan/followed.json", R"({"parts_s":{"way_there":1,"approach":0.5,"line":6,"retreat":0.5}})");
  const auto times = made_times(folder.path() / "cell", folder.path() / "scan");
  CHECK(times.has_value());
  DOUBLES_EQUAL(0.7, times->line_and_path_s, 1e-9);
  // Line and path are done 0.1 s before the slowed arm stands; a quick one would have waited for them.
  DOUBLES_EQUAL(0.7 + 0.3, times->sets_out_s, 0.03);
  DOUBLES_EQUAL(2, times->way_there_s, 0.011);
  DOUBLES_EQUAL(2.5 + 1.0 + 9, times->whole_s(), 0.05);
  STRCMP_CONTAINS("scan 2.50 s", words(*times).c_str());
  STRCMP_CONTAINS("in all", words(*times).c_str());
}

}  // namespace biteline::demo
