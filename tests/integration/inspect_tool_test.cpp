// SPDX-License-Identifier: MIT
// `biteline inspect` on files: a worked shoe with a gap, one without, one that nobody worked.
#include <CppUTest/TestHarness.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "host/cloud/ply.hpp"
#include "host/intake/child_process.hpp"
#include "tests/bench/second_look/made_work.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(InspectTool) {
  test::TemporaryFolder folder;
  bench::WorkCase made{.shoe_class = sim::ShoeClass::Deep,
                       .seed = 7001,
                       .bare = true,
                       .work = sim::Work::WetGlue,
                       .plan = {.offset_mm = 4, .width_mm = 8}};

  std::string path(const std::string& name) const {
    return (folder.path() / name).string();
  }
  void write(const bench::MadeWork& work) const {
    std::filesystem::create_directories(folder.path() / "before");
    SUCCEEDS(cloud::write_cloud(folder.path() / "before" / "cloud.ply", work.first));
    SUCCEEDS(cloud::write_cloud(folder.path() / "after.ply", work.second));
    cloud::ClosedLine line = work.line;
    for (std::size_t i = 0; i < line.points.size(); ++i)
      line.points[i].tangent =
          (line.points[(i + 1) % line.points.size()].position - line.points[i].position).normalized();
    SUCCEEDS(cloud::write_line(folder.path() / "before" / "line.csv", line));
  }
  int inspect(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"inspect",
                                       path("before"),
                                       path("after.ply"),
                                       "--process",
                                       std::string{BITELINE_PROCESSES} + "/rough.yaml",
                                       "--out",
                                       path("look"),
                                       "--offset-mm",
                                       "4",
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    return child->wait(std::chrono::minutes{10}).value_or(-1);
  }
  nlohmann::json report() const {
    std::ifstream file(folder.path() / "look" / "report.json");
    return test::read_json(file);
  }
};

TEST(InspectTool, AllWorkedIsDone) {
  write(bench::make_work(made));
  LONGS_EQUAL(0, inspect({"--width-mm", "8"}));
  STRCMP_EQUAL("ok", report()["status"].get<std::string>().c_str());
  LONGS_EQUAL(0, report()["work"]["faults"].size());
  CHECK_TRUE(std::filesystem::exists(folder.path() / "look" / "band.csv"));
  CHECK_TRUE(std::filesystem::exists(folder.path() / "look" / "band.svg"));
  // work-quality reads its band: twice the same look has no spread.
  auto study = intake::ChildProcess::start(
      {.program = BITELINE_TOOL,
       .arguments = {"work-quality", path("look"), path("look"), "--out", path("quality")}});
  SUCCEEDS(study);
  LONGS_EQUAL(2, study->wait(std::chrono::minutes{1}).value_or(-1));
  STRCMP_CONTAINS("all 2 values are equal", study->last_words().c_str());
}

TEST(InspectTool, AGapIsForAPerson) {
  made.plan.faults = {{.kind = sim::WorkFault::Kind::Gap, .s_mm = 150, .length_mm = 5}};
  write(bench::make_work(made));
  LONGS_EQUAL(5, inspect({"--width-mm", "8"}));
  STRCMP_EQUAL("work_faulty", report()["reason_code"].get<std::string>().c_str());
  LONGS_EQUAL(1, report()["work"]["faults"].size());
  STRCMP_EQUAL("missing", report()["work"]["faults"][0]["kind"].get<std::string>().c_str());
}

TEST(InspectTool, TheProcessTellsTheWidth) {
  write(bench::make_work(made));
  LONGS_EQUAL(5, inspect());  // 12 mm of roughing were wished, 8 mm are there
  STRCMP_EQUAL("narrow", report()["work"]["faults"][0]["kind"].get<std::string>().c_str());
}

TEST(InspectTool, NoWorkIsRefused) {
  made.work = sim::Work::Unseen;
  write(bench::make_work(made));
  LONGS_EQUAL(3, inspect({"--width-mm", "8"}));
  STRCMP_EQUAL("no_change_to_tell", report()["reason_code"].get<std::string>().c_str());
}

TEST(InspectTool, AMissingLineIsWrongUse) {
  std::filesystem::create_directories(folder.path() / "before");
  LONGS_EQUAL(2, inspect());
}

}  // namespace biteline
