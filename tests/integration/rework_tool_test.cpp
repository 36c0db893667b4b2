// SPDX-License-Identifier: MIT
// `biteline rework` on files: what `biteline inspect` misses is planned once more, once.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/cloud/ply.hpp"
#include "host/intake/child_process.hpp"
#include "tests/bench/second_look/made_work.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(ReworkTool) {
  test::TemporaryFolder folder;
  bench::WorkCase made{.shoe_class = sim::ShoeClass::Deep,
                       .seed = 7001,
                       .bare = true,
                       .work = sim::Work::WetGlue,
                       .plan = {.offset_mm = 4, .width_mm = 8}};
  std::vector<std::string> cell;

  std::string path(const std::string& name) const {
    return (folder.path() / name).string();
  }
  std::string process(const char* name) const {
    return std::string{BITELINE_PROCESSES} + "/" + name;
  }
  /// Files of both scans, and where an arm stands before the shoe.
  void write() {
    const bench::MadeWork work = bench::make_work(made);
    std::filesystem::create_directories(folder.path() / "before");
    SUCCEEDS(cloud::write_cloud(folder.path() / "before" / "cloud.ply", work.first));
    SUCCEEDS(cloud::write_cloud(folder.path() / "after.ply", work.second));
    cloud::ClosedLine line = work.line;
    Vec3 middle = Vec3::Zero();
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      line.points[i].tangent =
          (line.points[(i + 1) % line.points.size()].position - line.points[i].position).normalized();
      middle +=
          work.T_base_shoe.inverse() * line.points[i].position / static_cast<double>(line.points.size());
    }
    SUCCEEDS(cloud::write_line(folder.path() / "before" / "line.csv", line));
    const Vec3 base = work.T_base_shoe * Vec3{middle.x() - 650, middle.y(), -120};
    const Vec3 ahead = work.T_base_shoe.linear().col(0);
    const auto number = [](double value) { return std::to_string(value); };
    cell = {"--robot",
            "UR10e",
            "--base-at",
            number(base.x()),
            number(base.y()),
            number(base.z()),
            number(std::atan2(ahead.y(), ahead.x()) * 180 / std::numbers::pi),
            "--table-z",
            number(base.z()),
            "--fixture-z",
            number(work.T_base_shoe.translation().z())};
  }
  int run(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) const {
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.emplace_back("--quiet");
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    return child->wait(std::chrono::minutes{10}).value_or(-1);
  }
  int inspect() const {
    return run({"inspect", path("before"), path("after.ply"), "--process", process("rough.yaml"), "--out",
                path("look"), "--offset-mm", "4", "--width-mm", "8"});
  }
  int rework(const std::vector<std::string>& more = {}, const char* name = "rough.yaml") const {
    std::vector<std::string> arguments{"rework",      path("before"), path("look"), "--process",
                                       process(name), "--out",        path("again")};
    arguments.insert(arguments.end(), cell.begin(), cell.end());
    return run(std::move(arguments), more);
  }
  nlohmann::json report(const char* of) const {
    std::ifstream file(folder.path() / of / "report.json");
    return test::read_json(file);
  }
  bool is_planned() const {
    return std::filesystem::exists(folder.path() / "again" / "path.script");
  }
};

TEST(ReworkTool, AGapBecomesAPathOnceAndThenAPersonDecides) {
  made.plan.faults = {{.kind = sim::WorkFault::Kind::Gap, .s_mm = 150, .length_mm = 5}};
  write();
  LONGS_EQUAL(5, inspect());
  LONGS_EQUAL(0, rework());
  CHECK_TRUE(is_planned());
  const nlohmann::json again = report("again");
  LONGS_EQUAL(1, again["stretches"].size());
  LONGS_EQUAL(1, again["rework"]["pieces"].size());
  const nlohmann::json& piece = again["rework"]["pieces"][0];
  const double length_mm = piece["to_mm"].get<double>() - piece["from_mm"].get<double>();
  CHECK(length_mm > 5 && length_mm < 7);
  // 12 mm of roughing on a wall that bends.
  const auto width_mm = again["coverage"]["median_width_mm"].get<double>();
  DOUBLES_EQUAL(12, width_mm, 3);
  CHECK_TRUE(std::filesystem::exists(folder.path() / "again" / "coverage.ply"));
  CHECK_TRUE(std::filesystem::exists(folder.path() / "again" / "coverage.png"));

  LONGS_EQUAL(3, rework());
  STRCMP_EQUAL("reworked_before", report("again")["reason_code"].get<std::string>().c_str());
  CHECK_FALSE(is_planned());
  LONGS_EQUAL(5, inspect());
  STRCMP_EQUAL("still_faulty", report("look")["reason_code"].get<std::string>().c_str());
  LONGS_EQUAL(3, rework());

  LONGS_EQUAL(0, rework({"--decided-by", "ada"}));
  CHECK_TRUE(is_planned());
  STRCMP_EQUAL("ada", report("again")["rework"]["decided_by"].get<std::string>().c_str());
}

TEST(ReworkTool, WhatWasMissingAndIsThereNowIsDone) {
  made.plan.faults = {{.kind = sim::WorkFault::Kind::Gap, .s_mm = 150, .length_mm = 5}};
  write();
  LONGS_EQUAL(5, inspect());
  LONGS_EQUAL(0, rework());
  made.plan.faults.clear();
  write();
  LONGS_EQUAL(0, inspect());
  LONGS_EQUAL(1, report("look")["reworks"].get<int>());
}

TEST(ReworkTool, WithoutAFaultThereIsNothing) {
  write();
  LONGS_EQUAL(0, inspect());
  LONGS_EQUAL(3, rework());
  STRCMP_EQUAL("nothing_to_rework", report("again")["reason_code"].get<std::string>().c_str());
  CHECK_FALSE(std::filesystem::exists(folder.path() / "before" / "rework.json"));
}

TEST(ReworkTool, ANarrowBandIsAPersonsUnlessThatIsSaid) {
  made.plan.faults = {
      {.kind = sim::WorkFault::Kind::Narrow, .s_mm = 200, .length_mm = 20, .by_mm = 1.8, .high = false}};
  write();
  LONGS_EQUAL(5, inspect());
  LONGS_EQUAL(3, rework());
  STRCMP_EQUAL("for_a_person", report("again")["reason_code"].get<std::string>().c_str());
  LONGS_EQUAL(0, rework({"--narrow"}));
  CHECK_TRUE(is_planned());
}

TEST(ReworkTool, ARefusedPathIsNoRework) {
  made.plan.faults = {{.kind = sim::WorkFault::Kind::Gap, .s_mm = 150, .length_mm = 5}};
  write();
  LONGS_EQUAL(5, inspect());
  cell[3] = std::to_string(std::stod(cell[3]) + 5000);
  LONGS_EQUAL(3, rework());
  CHECK_FALSE(std::filesystem::exists(folder.path() / "before" / "rework.json"));
}

TEST(ReworkTool, AnotherProcessOrAnotherLineIsWrongUse) {
  made.plan.faults = {{.kind = sim::WorkFault::Kind::Gap, .s_mm = 150, .length_mm = 5}};
  write();
  LONGS_EQUAL(5, inspect());
  LONGS_EQUAL(2, rework({}, "grind.yaml"));
  std::ofstream(folder.path() / "before" / "line.csv", std::ios::app) << "#\n";
  LONGS_EQUAL(2, rework());
}

TEST(ReworkTool, WhatIsNoLookIsWrongUse) {
  write();
  std::filesystem::create_directories(folder.path() / "look");
  std::ofstream(folder.path() / "look" / "report.json") << R"({"status": "ok"})";
  LONGS_EQUAL(2, rework());
}

}  // namespace biteline
