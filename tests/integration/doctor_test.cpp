// SPDX-License-Identifier: MIT
// `biteline doctor`: what is ready, what one can do with it, and what the arm's controller says; and how the
// tool takes words that were mistyped.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/config/sensor_yaml.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline {

using namespace std::chrono_literals;
using nlohmann::json;

TEST_GROUP(Doctor) {
  struct Said {
    int status{0};
    std::string out, last_error;
  };
  static Said say(const std::vector<std::string>& arguments) {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    Said said;
    while (const auto line = child->next_line(30s)) said.out += *line + "\n";
    const auto status = child->wait(30s);
    SUCCEEDS(status);
    said.status = *status;
    said.last_error = child->last_words();
    return said;
  }
  static json doctor(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"doctor", "--json"});
    return test::read_json(say(more).out);
  }
  static json row_of(const json& rows, const std::string& what) {
    const auto row = std::ranges::find_if(rows, [&](const json& r) { return r.value("what", "") == what; });
    CHECK_TEXT(row != rows.end(), what.c_str());
    return row == rows.end() ? json{} : *row;
  }
};

TEST(Doctor, TellsWhatOneCanDoAndWhyNotTheRest) {
  const json told = doctor();
  CHECK(row_of(told["abilities"], "work out recordings and plan paths").value("can", false));
  std::set<std::string> missing;
  for (const json& finding : told["findings"]) {
    if (finding["ready"]) continue;
    CHECK(!finding["step"].get<std::string>().empty());
    missing.insert(finding["what"].get<std::string>() + ": " + finding["seen"].get<std::string>());
  }
  for (const json& ability : told["abilities"]) {
    CHECK(ability["can"].get<bool>() == ability["missing"].empty());
    for (const json& reason : ability["missing"]) CHECK(missing.contains(reason.get<std::string>()));
  }
  const std::string words = say({"doctor"}).out;
  STRCMP_CONTAINS("you can:    work out recordings", words.c_str());
}

TEST(Doctor, ControllersThatAreTooOldOrHaveNoDashboardAreNamed) {
  robot::test::FakeController controller;
  const std::string address = "127.0.0.1:" + std::to_string(controller.dashboard_port());
  const auto finding = [&](const std::string& version) {
    controller.answers = {{"PolyscopeVersion", version},
                          {"get robot model", "UR10"},
                          {"is in remote control", "true"},
                          {"robotmode", "Robotmode: RUNNING"}};
    const json told = doctor({"--robot", address});
    CHECK(row_of(told["abilities"], "send paths to this robot").value("can", false) ==
          row_of(told["findings"], "robot at " + address)["ready"].get<bool>());
    return row_of(told["findings"], "robot at " + address);
  };
  for (const char* good : {"URSoftware 3.12.3.1234 (Jan 01 2020)", "URSoftware 3.15.8.1",
                           "URSoftware 5.5.1.8", "URSoftware 5.21.0"})
    CHECK_TEXT(finding(good)["ready"].get<bool>(), good);
  const std::map<std::string, std::string> bad{
      {"URSoftware 3.4.5.100", "PolyScope 3.4.5 is too old: 3.12.3 is the least"},
      {"URSoftware 3.12.2.1", "3.12.2 is too old"},
      {"URSoftware 5.4.9.1", "PolyScope 5.4.9 is too old: 5.5.1 is the least"},
      {"URSoftware 1.8.2", "1.8.2 is not supported"},
      {"could not understand: 'PolyscopeVersion'", "does not tell the version"}};
  for (const auto& [version, words] : bad) {
    const json row = finding(version);
    CHECK_FALSE_TEXT(row["ready"].get<bool>(), version.c_str());
    STRCMP_CONTAINS(words.c_str(), row["seen"].get<std::string>().c_str());
    STRCMP_CONTAINS("update the controller's software", row["step"].get<std::string>().c_str());
  }
  // Nobody listens there: as on a PolyScope X.
  const json told = doctor({"--robot", "127.0.0.1:9"});
  const json row = row_of(told["findings"], "robot at 127.0.0.1:9");
  CHECK_FALSE(row["ready"].get<bool>());
  STRCMP_CONTAINS("no dashboard server there", row["seen"].get<std::string>().c_str());
  STRCMP_CONTAINS("PolyScope X has none", row["seen"].get<std::string>().c_str());
  STRCMP_CONTAINS("PolyScope 3.12.3, 5.5.1 or X 10.12", row["step"].get<std::string>().c_str());
}

TEST(Doctor, AsksTheRobotOnlyWhereItIsTold) {
  robot::test::FakeController controller;
  controller.answers = {{"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
                        {"get robot model", "UR10"},
                        {"get serial number", "20215500001"},
                        {"is in remote control", "true"},
                        {"robotmode", "Robotmode: RUNNING"}};
  const std::string address = "127.0.0.1:" + std::to_string(controller.dashboard_port());
  json told = doctor({"--robot", address});
  CHECK(row_of(told["abilities"], "send paths to this robot").value("can", false));
  STRCMP_CONTAINS("20215500001",
                  row_of(told["findings"], "robot at " + address)["seen"].get<std::string>().c_str());

  controller.answers["is in remote control"] = "false";
  told = doctor({"--robot", address});
  CHECK(!row_of(told["abilities"], "send paths to this robot").value("can", true));
  STRCMP_CONTAINS("Remote Control",
                  row_of(told["findings"], "robot at " + address)["step"].get<std::string>().c_str());
  // Nobody there.
  told = doctor({"--robot", "127.0.0.1:1"});
  CHECK(!row_of(told["abilities"], "send paths to this robot").value("can", true));
  for (const json& ability : doctor()["abilities"])
    CHECK(ability["what"].get<std::string>() != "send paths to this robot");
}

TEST(Doctor, TellsTheNoiseOfAHeadAndWhatWouldLowerIt) {
  const auto choices_of = [](std::vector<std::string> more) {
    more.insert(more.begin(), "--light");
    return doctor(more)["choices"];
  };
  const json stopped_down = choices_of({"--f-number", "8"}), open = choices_of({"--f-number", "4"});
  CHECK(stopped_down[0]["limit"].get<std::string>() == "speckle");
  CHECK(stopped_down[0]["noise_mm"].get<double>() > 1.5 * open[0]["noise_mm"].get<double>());
  // What stands among the choices of one head is what the other one has, its exposure apart.
  const auto same = std::find_if(stopped_down.begin(), stopped_down.end(),
                                 [](const json& choice) { return choice["f_number"].get<double>() == 4; });
  CHECK(same != stopped_down.end());
  DOUBLES_EQUAL(100, (*same)["exposure_us"].get<double>(), 1e-6);
  DOUBLES_EQUAL(open[0]["contrast_at_rest"].get<double>(), (*same)["contrast_at_rest"].get<double>(), 1e-9);
  // A sheet half as thick: less noise, though not half.
  const auto thin = std::find_if(open.begin(), open.end(), [](const json& choice) {
    return choice["stripe_mm"].get<double>() == 0.225;
  });
  CHECK(thin != open.end());
  CHECK((*thin)["noise_mm"].get<double>() < 0.8 * open[0]["noise_mm"].get<double>());
  const std::string told = say({"doctor", "--light", "--speed-mm-s", "250"}).out;
  STRCMP_CONTAINS("the laser's speckle limits a point", told.c_str());
  STRCMP_CONTAINS("f/2.8, same brightness", told.c_str());
  STRCMP_CONTAINS("--light", say({"doctor", "--f-number", "4"}).last_error.c_str());
}

TEST(Doctor, TellsMeasuredSpeckleBesideWhatIsForecast) {
  test::TemporaryFolder folder;
  geometry::SensorModel sensor = test::made_head(1626, 320);
  sensor.speckle_contrast = 0.48;
  const std::string yaml = folder.write("sensor.yaml", config::sensor_yaml_text(sensor, "made")),
                    report = folder.write("report.json",
                                          R"({"scan": {"speckle_contrast": {"median": 0.24, "p95": 0.3}}})"),
                    silent = folder.write("silent.json", R"({"scan": {}})");
  const json told = doctor({"--light", "--sensor", yaml, "--report", report})["measured"];
  DOUBLES_EQUAL(0.48, told["calibrated"].get<double>(), 0);
  DOUBLES_EQUAL(0.24, told["scanned"].get<double>(), 0);
  STRCMP_CONTAINS("calibrated: contrast 0.48 measured, 0.47 forecast.",
                  told["words"].get<std::string>().c_str());
  STRCMP_CONTAINS("0.46 forecast: less than this light has", told["words"].get<std::string>().c_str());
  STRCMP_CONTAINS("scanned: contrast 0.24 measured",
                  say({"doctor", "--light", "--report", report}).out.c_str());
  CHECK_FALSE(doctor({"--light", "--report", silent}).contains("measured"));
}

TEST(Doctor, TheLasersClassIsThatOfItsWorstState) {
  const auto laser_class = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"laser-class", "--json"});
    return test::read_json(say(more).out);
  };
  const json pulsed = laser_class({"--laser-mw", "100", "--wavelength-nm", "660", "--fan-deg", "60",
                                   "--exposure-us", "100", "--rate-hz", "100"});
  const auto class_in = [&](std::size_t state) { return pulsed["cases"][state]["laser_class"]; };
  LONGS_EQUAL(4, pulsed["cases"].size());
  CHECK(class_in(0) == "1" && class_in(1) == "3B" && class_in(2) == "3R" && class_in(3) == "3B");
  CHECK(pulsed["laser_class"] == "3B");
  CHECK(laser_class({"--laser-mw", "5", "--fan-deg", "60"})["laser_class"] == "1");
  CHECK(laser_class({"--laser-mw", "5", "--fan-deg", "60", "--fault-mw", "100"})["laser_class"] == "3B");
  STRCMP_CONTAINS("a test house measures", say({"laser-class"}).out.c_str());
  const auto fault = [](std::vector<std::string> more) {
    more.insert(more.begin(), "laser-class");
    return say(more).last_error;
  };
  STRCMP_CONTAINS("--rate-hz", fault({"--exposure-us", "100"}).c_str());
  STRCMP_CONTAINS("pulses shorter than", fault({"--exposure-us", "20000", "--rate-hz", "100"}).c_str());
  STRCMP_CONTAINS("no less light", fault({"--laser-mw", "5", "--fault-mw", "1"}).c_str());
  STRCMP_CONTAINS("--wavelength-nm", fault({"--wavelength-nm", "1064"}).c_str());
}

TEST(Doctor, MistypedWordsAreAnsweredByTheNearestOne) {
  STRCMP_CONTAINS("did you mean --out?", say({"extract", "cloud.ply", "--ot", "x"}).last_error.c_str());
  STRCMP_CONTAINS("did you mean --board?", say({"doctor", "--bord=x"}).last_error.c_str());
  STRCMP_CONTAINS("did you mean replay?", say({"replya"}).last_error.c_str());
  // What is near to nothing keeps the parser's own words.
  STRCMP_CONTAINS("--out is required", say({"extract", "cloud.ply", "--frobnicate"}).last_error.c_str());
  STRCMP_CONTAINS("biteline ", say({"-V"}).out.c_str());
  STRCMP_EQUAL(say({"replay", "--help"}).out.c_str(), say({"help", "replay"}).out.c_str());
  LONGS_EQUAL(0, say({"help"}).status);
}

}  // namespace biteline
