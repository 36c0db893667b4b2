// SPDX-License-Identifier: MIT
// `biteline work-quality` on looks that are made here, so that mean, spread and wear are known.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>
#include <random>

#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(WorkQualityTool) {
  test::TemporaryFolder folder;
  std::vector<std::string> looks;

  /// A band of this width, planned from 0 to 8 mm; three of its four places tell both edges.
  void look(double width_mm, double off_mm = 0, double planned_mm = 8) {
    const std::string name = "look-" + std::to_string(100 + looks.size());
    const std::string low = std::to_string(planned_mm / 2 + off_mm - width_mm / 2),
                      high = std::to_string(planned_mm / 2 + off_mm + width_mm / 2);
    folder.write(name + "/report.json", R"({"work": {"planned_low_mm": 0, "planned_high_mm": )" +
                                            std::to_string(planned_mm) + R"(, "tolerance_mm": 0.5}})");
    std::string band = "#along [mm],state\n";
    for (int i = 0; i < 3; ++i)
      band += std::to_string(i) + ",worked," + low + ",0.1,0,0,0," + high + ",0.1,0,0,0\n";
    folder.write(name + "/band.csv", band + "3,unclear,,,,,,,,,,\n");
    looks.push_back((folder.path() / name).string());
  }
  struct Said {
    int status{0};
    std::string out, last_error;
  };
  Said tell(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"work-quality"};
    arguments.insert(arguments.end(), looks.begin(), looks.end());
    arguments.insert(arguments.end(), {"--out", (folder.path() / "out").string()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    Said said;
    while (const auto line = child->next_line(std::chrono::seconds{30})) said.out += *line + "\n";
    said.status = child->wait(std::chrono::seconds{30}).value_or(-1);
    said.last_error = child->last_words();
    return said;
  }
  nlohmann::json report() const {
    std::ifstream file(folder.path() / "out" / "report.json");
    return test::read_json(file);
  }
};

TEST(WorkQualityTool, PpAndPpkAreOfTheMeansOfTheShoes) {
  // 7.9 and 8.1 mm by turns, 0.1 mm too high and too low: s = 0.1 sqrt(10 / 9).
  for (int i = 0; i < 10; ++i) look(i % 2 == 0 ? 7.9 : 8.1, i % 2 == 0 ? 0.2 : 0.0);
  const Said said = tell();
  LONGS_EQUAL(0, said.status);
  const nlohmann::json told = report();
  const double s = 0.1 * std::sqrt(10.0 / 9);
  DOUBLES_EQUAL(8, told["width"]["mean_mm"].get<double>(), 1e-6);
  DOUBLES_EQUAL(1 / (3 * s), told["width"]["pp"].get<double>(), 1e-4);
  DOUBLES_EQUAL(1 / (3 * s), told["width"]["ppk"].get<double>(), 1e-4);
  DOUBLES_EQUAL(0.1, told["place"]["mean_mm"].get<double>(), 1e-6);
  DOUBLES_EQUAL(0.4 / (3 * s), told["place"]["ppk"].get<double>(), 1e-4);
  CHECK_FALSE(told["width"]["trend"]["sure"].get<bool>());
  for (const char* file : {"index.html", "shoes.csv", "width.svg", "place.svg"})
    CHECK_TEXT(std::filesystem::exists(folder.path() / "out" / file), file);
  // Another tolerance, another index.
  LONGS_EQUAL(0, tell({"--width-tolerance-mm", "0.2"}).status);
  DOUBLES_EQUAL(0.2 / (3 * s), report()["width"]["pp"].get<double>(), 1e-4);
}

TEST(WorkQualityTool, AToolThatWearsIsToldBeforeItsLimit) {
  // A brush that leaves 0.01 mm less with each shoe, from 8 mm: 7 mm after 100.
  std::mt19937 random{62};
  std::normal_distribution<double> noise{0, 0.03};
  for (int shoe = 1; shoe <= 40; ++shoe) look(8 - 0.01 * shoe + noise(random), noise(random));
  const Said said = tell();
  LONGS_EQUAL(0, said.status);
  const nlohmann::json trend = report()["width"]["trend"];
  CHECK(trend["sure"].get<bool>());
  // The noise leaves 0.03 / sqrt(squares of 1 to 40) of slope, 0.41 um a shoe: four times it.
  DOUBLES_EQUAL(-0.01, trend["mm_per_shoe"].get<double>(), 4 * 0.00041);
  DOUBLES_EQUAL(7, trend["reaches"]["limit_mm"].get<double>(), 1e-9);
  const double earliest = trend["reaches"]["earliest_shoe"].get<double>(),
               likely = trend["reaches"]["shoe"].get<double>(),
               latest = trend["reaches"]["latest_shoe"].get<double>();
  CHECK(40 < earliest && earliest < likely && likely < latest);
  // Of this slope: four of its deviations at 100 shoes.
  DOUBLES_EQUAL(100, likely, 4 * 0.00041 / 0.01 * 80);
  STRCMP_CONTAINS("more shoes, not before", said.out.c_str());
}

TEST(WorkQualityTool, LooksThatTellNoBandAreLeftOutAndKeepTheirPlace) {
  look(8);
  look(8.1);
  folder.write("look-101/band.csv", "#along [mm],state\n0,missing,,,,,,,,,,\n");
  look(8.3, 0.1);
  look(8.5, 0.2);
  LONGS_EQUAL(0, tell().status);
  const nlohmann::json told = report();
  LONGS_EQUAL(4, told["looks"].get<int>());
  LONGS_EQUAL(1, told["left_out"].get<int>());
  LONGS_EQUAL(3, told["width"]["shoes"].get<int>());
  // Over the shoes 1, 3 and 4: slope of (8, 8.3, 8.5).
  DOUBLES_EQUAL(0.164286, told["width"]["trend"]["mm_per_shoe"].get<double>(), 1e-5);
}

TEST(WorkQualityTool, WhatDoesNotBelongTogetherIsToldByName) {
  look(8);
  STRCMP_CONTAINS("at least 2", tell().last_error.c_str());
  looks.push_back(looks.front());
  STRCMP_CONTAINS("all 2 values are equal", tell().last_error.c_str());
  looks.pop_back();
  look(8.1, 0, 10);
  const Said said = tell();
  LONGS_EQUAL(2, said.status);
  STRCMP_CONTAINS("look-101: a band of 10.000 mm", said.last_error.c_str());
  looks.back() = (folder.path() / "nothing").string();
  STRCMP_CONTAINS("nothing/report.json", tell().last_error.c_str());
}

TEST(WorkQualityTool, AGageStudyOfLooksIsThatOfTheirWidths) {
  // 3 shoes, 2 persons, 2 looks each.
  const double widths_mm[] = {7.90, 7.92, 8.00, 8.03, 8.10, 8.09, 7.95, 7.93, 8.02, 8.04, 8.14, 8.12};
  std::string of_looks = "#part,person,look\n", of_values = "#part,person,value\n";
  for (int i = 0; i < 12; ++i) {
    look(widths_mm[i]);
    const std::string who =
        std::to_string(i / 2 % 3) + "," + std::string(1, static_cast<char>('A' + i / 6)) + ",";
    of_looks += who + std::filesystem::path(looks.back()).filename().string() + "\n";
    of_values += who + std::to_string(widths_mm[i]) + "\n";
  }
  const auto study = [&](const std::string& table, std::vector<std::string> more) {
    more.insert(more.begin(), {"study", folder.write("table.csv", table), "--out",
                               (folder.path() / "out").string(), "--quiet"});
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = more});
    SUCCEEDS(child);
    LONGS_EQUAL(0, child->wait(std::chrono::seconds{30}).value_or(-1));
    return report()["study"];
  };
  const nlohmann::json values = study(of_values, {}), widths = study(of_looks, {"--of", "width"});
  for (const char* figure : {"ev", "av", "pv", "grr", "tv", "grr_percent"})
    DOUBLES_EQUAL(values[figure].get<double>(), widths[figure].get<double>(), 1e-4);
  CHECK(values["pv"].get<double>() > 0.05);
  CHECK(std::filesystem::exists(folder.path() / "out" / "index.html"));
}

}  // namespace biteline
