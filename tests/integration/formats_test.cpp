// SPDX-License-Identifier: MIT
// One made shoe through `biteline extract` as the files that other programs write: each gives the same line.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(Formats) {
  test::TemporaryFolder folder;
  test::MadeCloud made = test::made_cloud(sim::ShoeClass::Deep, 4101, test::somewhere());

  int tool(std::vector<std::string> arguments) {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    const auto status = child->wait(std::chrono::minutes{10});
    return status.value_or(-1);
  }
  std::string path(const std::string& name) const {
    return (folder.path() / name).string();
  }

  /// The points as rows, each turned by 90 degrees round x: what was up is the file's y.
  std::string rows_with_y_up() const {
    std::string text;
    char row[96];
    for (const Eigen::Vector3f& p : made.cloud.points) {
      std::snprintf(row, sizeof row, "%.6f %.6f %.6f\n", p.x(), p.z(), -p.y());
      text += row;
    }
    return text;
  }
  /// The points as rows "x y z", each number divided by `mm`.
  std::string rows(const char* format, double mm) const {
    std::string text;
    char row[96];
    for (const Eigen::Vector3f& p : made.cloud.points) {
      std::snprintf(row, sizeof row, format, p.x() / mm, p.y() / mm, p.z() / mm);
      text += row;
    }
    return text;
  }
  nlohmann::json report(const std::string& out) const {
    std::ifstream file(folder.path() / out / "report.json");
    return test::read_json(file);
  }
  double error_mm(const std::string& out) const {
    const auto line = cloud::read_line(folder.path() / out / "line.csv");
    SUCCEEDS(line);
    return test::mean_error_mm(*line, made.truth);
  }
};

TEST(Formats, TheSamePointsGiveTheSameLineFromEveryFormatAndUnit) {
  folder.write("a.xyz", rows("%.6f %.6f %.6f\n", 1));
  folder.write("m.csv", "x,y,z\n" + rows("%.9f,%.9f,%.9f\n", 1000));
  folder.write("in.obj", rows("v %.8f %.8f %.8f\n", 25.4));
  LONGS_EQUAL(0, tool({"extract", path("a.xyz"), "--out", path("a"), "--quiet"}));
  LONGS_EQUAL(0, tool({"extract", path("m.csv"), "--unit", "m", "--out", path("m"), "--quiet"}));
  LONGS_EQUAL(0, tool({"extract", path("in.obj"), "--unit", "in", "--out", path("in"), "--quiet"}));
  const double alone = error_mm("a");
  // The product's aim for a made shoe is a twentieth of a millimetre.
  CHECK(alone < 0.05);
  // Points differ by the rounding of the files alone, below 0.001 mm.
  DOUBLES_EQUAL(alone, error_mm("m"), 0.002);
  DOUBLES_EQUAL(alone, error_mm("in"), 0.002);
}

TEST(Formats, CloudInMetresIsRefusedWithTheUnitToGive) {
  folder.write("m.xyz", rows("%.9f %.9f %.9f\n", 1000));
  LONGS_EQUAL(3, tool({"extract", path("m.xyz"), "--out", path("m"), "--quiet"}));
  STRCMP_EQUAL("other_unit", report("m").at("reason_code").get<std::string>().c_str());
  STRCMP_CONTAINS("--unit m", report("m").at("reason").get<std::string>().c_str());
  CHECK(!std::filesystem::exists(folder.path() / "m" / "line.csv"));
  LONGS_EQUAL(2, tool({"extract", path("m.xyz"), "--unit", "ft", "--out", path("m"), "--quiet"}));
}

TEST(Formats, CloudWithYUpIsRefusedWithTheAxisToGive) {
  folder.write("y.xyz", rows_with_y_up());
  LONGS_EQUAL(3, tool({"extract", path("y.xyz"), "--out", path("y"), "--quiet"}));
  STRCMP_EQUAL("other_up", report("y").at("reason_code").get<std::string>().c_str());
  STRCMP_CONTAINS("give --up y", report("y").at("reason").get<std::string>().c_str());
  STRCMP_CONTAINS("--up y", report("y").at("next_step").get<std::string>().c_str());
  // Nothing was turned unasked; as it says, the line is there.
  CHECK(!std::filesystem::exists(folder.path() / "y" / "line.csv"));
  LONGS_EQUAL(0, tool({"extract", path("y.xyz"), "--up", "y", "--out", path("y"), "--quiet"}));
  CHECK(std::filesystem::exists(folder.path() / "y" / "line.csv"));
}

TEST(Formats, WhatHasALineInNoAxisIsToldNone) {
  std::string text;
  char row[96];
  // A board as long as a shoe: no axis makes one of it.
  for (int i = 0; i < 300; ++i) {
    for (int k = 0; k < 100; ++k) {
      std::snprintf(row, sizeof row, "%d %d %.2f\n", i, k, 0.01 * (i % 7));
      text += row;
    }
  }
  folder.write("board.xyz", text);
  LONGS_EQUAL(3, tool({"extract", path("board.xyz"), "--out", path("board"), "--quiet"}));
  CHECK(report("board").at("reason_code") != "other_up");
  CHECK(report("board").at("next_step").get<std::string>().find("--up") == std::string::npos);
}

}  // namespace biteline
