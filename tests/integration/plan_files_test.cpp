// SPDX-License-Identifier: MIT
// What biteline plan leaves in its folder: a path that is whole, or none; never an older one.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "host/cloud/closed_line.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline {

using intake::ChildProcess;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(PlanFiles) {
  test::TemporaryFolder folder;
  fs::path line{folder.path() / "line.csv"}, out{folder.path() / "out"};

  void setup() override {
    SUCCEEDS(cloud::write_line(line, path::test::made_line()));
  }
  void leave_an_older_path() const {
    folder.write("out/path.csv", "an older path");
    folder.write("out/path.script", "def biteline_path():\nend\n");
    folder.write("out/report.json", R"({"status":"ok"})");
  }
  /// The tool's exit status; `limit_blocks`: no file grows beyond so many blocks of 512 bytes, as on a disk
  /// that is full.
  int plan(const std::string& process, int limit_blocks = 0) const {
    std::string limit = "exec \"$@\"";
    if (limit_blocks > 0) limit = "trap '' XFSZ; ulimit -f " + std::to_string(limit_blocks) + "; " + limit;
    auto child = ChildProcess::start(
        {.program = "/bin/sh",
         .arguments = {"-c", limit, "sh", BITELINE_TOOL, "plan", line.string(), "--robot", "UR5e",
                       "--table-z", "40", "--process", process, "--out", out.string()}});
    SUCCEEDS(child);
    const auto status = child->wait(120s);
    SUCCEEDS(status);
    if (*status != 0) LONGS_EQUAL(1, child->stderr_lines());
    return *status;
  }
  int flow_test(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"flow-test", "--robot",    "UR10e",  "--process", spray,
                                       "--at",      "650",        "0",      "80",        "90",
                                       "--out",     out.string(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    return child->wait(120s).value_or(-1);
  }
  std::string status_told() const {
    std::ifstream stream{out / "report.json"};
    const auto json = test::read_json(stream);
    return json.is_object() ? json.value("status", "") : "";
  }
  const std::string spray{fs::path{BITELINE_PROCESSES} / "spray.yaml"};
  const std::string grind{fs::path{BITELINE_PROCESSES} / "grind.yaml"};
};

TEST(PlanFiles, GoodPlanLeavesItsScriptAndReport) {
  LONGS_EQUAL(0, plan(grind));
  CHECK(fs::file_size(out / "path.script") > 1000);
  STRCMP_EQUAL("ok", status_told().c_str());
}

TEST(PlanFiles, InputThatCannotBeReadLeavesNoOlderPath) {
  leave_an_older_path();
  LONGS_EQUAL(2, plan(folder.write("bad.yaml", "name: [\n")));
  CHECK(!fs::exists(out / "path.script"));
  CHECK(!fs::exists(out / "path.csv"));
  CHECK(status_told() != "ok");
}

TEST(PlanFiles, LineThatCannotBeReadLeavesNoOlderPath) {
  leave_an_older_path();
  folder.write("line.csv", "no line\n");
  LONGS_EQUAL(2, plan(grind));
  CHECK(!fs::exists(out / "path.script"));
  CHECK(status_told() != "ok");
}

/// Whichever of the files is the one that no longer fits: no script without all that was to be written
/// before it, and no older one.
TEST(PlanFiles, FullDiskLeavesNoScript) {
  int full = 0, fitted = 0;
  for (const int blocks : {1, 20, 80, 120, 200, 400, 1000, 100'000}) {
    fs::remove_all(out);
    leave_an_older_path();
    const int status = plan(grind, blocks);
    const bool script = fs::exists(out / "path.script");
    std::printf("%d blocks: status %d, %s\n", blocks, status, script ? "a script" : "no script");
    LONGS_EQUAL(status == 0 ? 1 : 0, script ? 1 : 0);
    if (status == 0) {
      ++fitted;
      STRCMP_EQUAL("ok", status_told().c_str());
      CHECK(fs::file_size(out / "path.script") > 1000);
    } else {
      ++full;
      LONGS_EQUAL(2, status);
      CHECK(status_told() != "ok");
    }
  }
  CHECK(full >= 3);
  CHECK(fitted >= 1);
}

/// Ends behind by 30 ms at each stroke's speed: filled in and given back.
TEST(PlanFiles, AFlowTestsStrokesAreFilledInAndTellTheDelays) {
  LONGS_EQUAL(0, flow_test());
  CHECK(fs::file_size(out / "path.script") > 1000);
  std::ifstream strokes{out / "strokes.csv"};
  std::string table;
  int rows = 0;
  for (std::string row; std::getline(strokes, row); ++rows) {
    if (row.starts_with('#')) {
      table += row + "\n";
      continue;
    }
    std::vector<std::string> fields;
    std::istringstream parts{row};
    for (std::string field; std::getline(parts, field, ',');) fields.push_back(field);
    const double speed_mm_s = std::stod(fields[7]);
    table += row.substr(0, row.size() - 3) + ",0.5," + std::to_string(0.03 * speed_mm_s) + ",\n";
  }
  LONGS_EQUAL(5, rows);
  LONGS_EQUAL(0, flow_test({"--measured", folder.write("measured.csv", table)}));
  std::ifstream stream{out / "report.json"};
  const auto json = test::read_json(stream);
  DOUBLES_EQUAL(30, json["flow"]["gun_off_ms"].get<double>(), 0.1);
  DOUBLES_EQUAL(0, json["flow"]["shift_mm"].get<double>(), 0.01);
  CHECK(json["flow"]["lag_ms"].is_null());
  LONGS_EQUAL(2, flow_test({"--measured", folder.write("three.csv", table.substr(0, table.size() / 2))}));
}

}  // namespace biteline
