// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/metrics.hpp"

#include <CppUTest/TestHarness.h>

#include <regex>
#include <sstream>

namespace biteline::web {

using control::Json;

TEST_GROUP(Metrics){};

TEST(Metrics, EveryLineIsOfTheTextForm) {
  const Json state{{"lamps", {{"laser", {{"level", "ok"}, {"words", "off"}}}}},
                   {"cycle", {{"last_s", 19.5}}}};
  const Json upkeep{{"starts", 4}, {"laser_s", 90.5}, {"frames", 800}, {"hottest_degc", nullptr}};
  const Json sensors{
      {"sensors", {{{"name", "a\"b\\c\nd"}, {"connected", true}, {"frames", 12}, {"upkeep", upkeep}}}},
      {"disk", {{"free_bytes", 5000000000}}}};
  const std::string text = metrics_text({.requests = 7}, state, sensors);
  STRCMP_CONTAINS("biteline_lamp{lamp=\"laser\",level=\"ok\"} 1\n", text.c_str());
  STRCMP_CONTAINS("biteline_cycle_seconds 19.5\n", text.c_str());
  STRCMP_CONTAINS("biteline_sensor_frames_total{sensor=\"a\\\"b\\\\c\\nd\"} 12\n", text.c_str());
  STRCMP_CONTAINS("biteline_sensor_laser_seconds_total{sensor=\"a\\\"b\\\\c\\nd\"} 90.5\n", text.c_str());
  STRCMP_CONTAINS("biteline_sensor_starts_total{", text.c_str());
  STRCMP_CONTAINS("biteline_sensor_unit_frames_total{sensor=\"a\\\"b\\\\c\\nd\"} 800\n", text.c_str());
  CHECK(text.find("hottest") == std::string::npos);
  STRCMP_CONTAINS("biteline_disk_free_bytes 5000000000\n", text.c_str());
  STRCMP_CONTAINS("biteline_web_requests_total 7\n", text.c_str());
  const std::regex form{
      R"re(# (HELP|TYPE) [a-z_]+ .+|[a-z_]+(\{[a-z]+="([^"\\]|\\.)*"(,[a-z]+="([^"\\]|\\.)*")*\})? [-+0-9.e]+)re"};
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) CHECK_TEXT(std::regex_match(line, form), line.c_str());
}

TEST(Metrics, WithoutAServiceItsOwnNumbersStand) {
  const std::string text = metrics_text({}, {}, {});
  STRCMP_CONTAINS("biteline_host_up 0\n", text.c_str());
  CHECK(text.find("lamp") == std::string::npos);
  for (const Json& odd : {Json("text"), Json::array({1}), Json{{"lamps", 3}, {"cycle", "x"}},
                          Json{{"sensors", {1, "x"}}, {"disk", {}}}}) {
    CHECK(!metrics_text({}, odd, odd).empty());
  }
}

}  // namespace biteline::web
