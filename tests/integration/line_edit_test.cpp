// SPDX-License-Identifier: MIT
// A made shoe's line spoiled in its file and mended by `biteline line edit`.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/core/fixed_text.hpp"
#include "host/cloud/ply.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(LineEdit) {
  test::TemporaryFolder folder;
  test::MadeCloud made = test::made_cloud(sim::ShoeClass::Deep, 4101, test::somewhere());
  std::filesystem::path scan = folder.path() / "scan";
  cloud::ClosedLine found;

  int tool(std::vector<std::string> arguments) {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    return child->wait(std::chrono::minutes{10}).value_or(-1);
  }
  void setup() override {
    SUCCEEDS(cloud::write_cloud(folder.path() / "cloud.ply", made.cloud));
    LONGS_EQUAL(0,
                tool({"extract", (folder.path() / "cloud.ply").string(), "--out", scan.string(), "--quiet"}));
    const auto line = cloud::read_line(scan / "line.csv");
    SUCCEEDS(line);
    found = *line;
  }
  /// 4 mm too high over 40 mm, as a seam beside the line would draw it.
  void spoil() {
    cloud::ClosedLine line = found;
    for (std::size_t k = 0; k < 80; ++k)
      line.points[400 + k].position.z() +=
          4 * std::pow(std::sin(3.14159265 * static_cast<double>(k) / 80), 2);
    SUCCEEDS(cloud::write_line(scan / "line.csv", line));
  }
  double most_mm() const {
    const auto line = cloud::read_line(scan / "line.csv");
    SUCCEEDS(line);
    double most = 0;
    for (const cloud::LinePoint& point : line->points)
      most = std::max(most, test::distance_mm(point.position, made.truth));
    return most;
  }
  std::string text(const std::string& name) const {
    std::ifstream file(scan / name);
    std::ostringstream all;
    all << file.rdbuf();
    return all.str();
  }
  nlohmann::json report() const {
    return test::read_json(text("report.json"));
  }
  static std::string point(const Vec3& p) {
    return FixedText<80>::format("%.3f,%.3f,%.3f", p.x(), p.y(), p.z()).c_str();
  }
};

TEST(LineEdit, OnePointLeadsTheLineBackAndWhatWasFoundStays) {
  spoil();
  const std::string before = text("line.csv");
  CHECK(most_mm() > 2.5);
  LONGS_EQUAL(0, tool({"line", "edit", scan.string(), "--through", point(found.points[440].position), "--why",
                       "the seam drew it", "--who", "ada", "--quiet"}));
  // Off by the found line's own error, and a little where it was led in.
  CHECK(most_mm() < 0.3);
  STRCMP_EQUAL(before.c_str(), text("lines/line-0.csv").c_str());
  STRCMP_EQUAL(text("lines/line-1.csv").c_str(), text("line.csv").c_str());
  LONGS_EQUAL(1, report().at("line_version").get<int>());
  CHECK(report().at("mended_mm").get<double>() > 30);
  STRCMP_EQUAL("ada", report().at("versions").at(1).at("who").get<std::string>().c_str());
  CHECK(std::filesystem::exists(scan / "index.html"));

  // As it was, bump and all: a version, whatever the checks say of it.
  const int undone = tool({"line", "edit", scan.string(), "--undo", "--why", "to see it again", "--quiet"});
  CHECK(undone == 0 || undone == 3);
  CHECK(most_mm() > 2.5);
  LONGS_EQUAL(0,
              tool({"line", "edit", scan.string(), "--back-to", "1", "--why", "it was better", "--quiet"}));
  CHECK(most_mm() < 0.3);
  LONGS_EQUAL(3, report().at("line_version").get<int>());
  LONGS_EQUAL(0, tool({"line", "show", scan.string()}));
}

TEST(LineEdit, WhatCannotBeDoneChangesNothingAndSaysWhy) {
  const std::string line = text("line.csv");
  const std::string before = text("report.json");
  const std::string at = scan.string();
  LONGS_EQUAL(3, tool({"line", "edit", at, "--candidate", "99", "--why", "x", "--quiet"}));
  LONGS_EQUAL(3, tool({"line", "edit", at, "--through", "0,0,9000", "--why", "x", "--quiet"}));
  LONGS_EQUAL(3, tool({"line", "edit", at, "--cut", "--from", "10", "--to", "11", "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--through", "1,2", "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--through", "1,2,nan", "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--from", "10", "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--undo", "--why", "x", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", at, "--candidate", "1", "--quiet"}));
  LONGS_EQUAL(2, tool({"line", "edit", (folder.path() / "none").string(), "--candidate", "1", "--why", "x"}));
  STRCMP_EQUAL(line.c_str(), text("line.csv").c_str());
  STRCMP_EQUAL(before.c_str(), text("report.json").c_str());
  CHECK_FALSE(std::filesystem::exists(scan / "lines/line-1.csv"));
}

TEST(LineEdit, ALineThatAHandMadeWorseIsRefusedAndKept) {
  Vec3 off = found.points[440].position;
  off.z() += 8;
  const int status =
      tool({"line", "edit", scan.string(), "--through", point(off), "--why", "to try it", "--quiet"});
  const auto line = cloud::read_line(scan / "lines/line-1.csv");
  SUCCEEDS(line);
  // The upper has no crease there: the hand is followed, and said to be half a millimetre good at best.
  double nearest = 1e9;
  double u95_mm = 0;
  for (const cloud::LinePoint& p : line->points) {
    if ((p.position - off).norm() > nearest) continue;
    nearest = (p.position - off).norm();
    u95_mm = p.u95_mm.value_or(0);
  }
  CHECK(nearest < 1.5);
  CHECK(u95_mm >= 0.5);
  LONGS_EQUAL(status == 0, report().at("status").get<std::string>() == "ok");
}

}  // namespace biteline
