// SPDX-License-Identifier: MIT
// A page changes what the sensor runs with: who may, what is read, what comes back.
#include <CppUTest/TestHarness.h>

#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(ApiSettings, ApiWorld){control::Answer change(const Json& settings){
    return ask("PATCH", "/sensors/settings", {{"settings", settings}});
}
void take_control_as(const std::string& name) {
  log_in(name);
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}, {"why", "to focus"}}).status);
}
}
;

TEST(ApiSettings, AnEngineerInControlChangesThem) {
  log_in("ana");
  LONGS_EQUAL(403, change({{"camera.exposure_us", 250}}).status);
  log_in("eng");
  STRCMP_EQUAL("control_needed", code_of(change({{"camera.exposure_us", 250}})).c_str());
  CHECK(cell.did.empty());
  take_control_as("eng");
  LONGS_EQUAL(200, change({{"peaks.choice", "first"},
                           {"camera.exposure_us", 250.5},
                           {"camera.follow_stripe", true},
                           {"camera.gain", nullptr}})
                       .status);
  LONGS_EQUAL(4, cell.did.size());
  STRCMP_EQUAL("set camera.exposure_us 250.5 us eng", cell.did[0].c_str());
  STRCMP_EQUAL("set camera.gain none eng", cell.did[1].c_str());
  STRCMP_EQUAL("set camera.follow_stripe on eng", cell.did[2].c_str());
  STRCMP_EQUAL("set peaks.choice first eng", cell.did[3].c_str());
  const auto rows = memory->log_rows(0, 1);
  SUCCEEDS(rows);
  STRCMP_EQUAL("settings", rows->front().action.c_str());
  STRCMP_CONTAINS("camera.exposure_us 250.5 us, camera.gain as usual", rows->front().after.c_str());
}

TEST(ApiSettings, WhatIsNoSettingNeverReachesTheSensor) {
  take_control_as("eng");
  const struct {
    Json settings;
    const char* words;
  } k_cases[] = {
      {{{"camera.exposure_us", 0}}, "camera.exposure_us: a number from"},
      {{{"camera.exposure_us", "250"}}, "a number from"},
      {{{"camera.exposure_us", 2e7}}, "a number from"},
      {{{"region.height_px", 100.5}}, "region.height_px: a whole number expected"},
      {{{"camera.auto_exposure", 1}}, "true or false"},
      {{{"peaks.mode", "best"}}, "peaks.mode: one of "},
      {{{"camera.exposure", 250}}, "camera.exposure: unknown field"},
      {Json::object(), "at least one of them"},
      {Json::array({1}), "a JSON object expected"},
  };
  for (const auto& row : k_cases) {
    const control::Answer answer = change(row.settings);
    LONGS_EQUAL_TEXT(400, answer.status, row.words);
    STRCMP_CONTAINS(row.words, answer.body["error"]["message"].get<std::string>().c_str());
  }
  CHECK(cell.did.empty());
}

TEST(ApiSettings, TheSensorsReasonComesBackAndIsNoChange) {
  take_control_as("eng");
  cell.next = fail(Errc::PeerRefused, "region.width_px: it stays 1626 px while a scan is on");
  const control::Answer answer = change({{"region.width_px", 800}});
  LONGS_EQUAL(409, answer.status);
  STRCMP_EQUAL("refused", code_of(answer).c_str());
  STRCMP_CONTAINS("it stays 1626 px", answer.body["error"]["message"].get<std::string>().c_str());
  const auto rows = memory->log_rows(0, 1);
  SUCCEEDS(rows);
  CHECK(rows->front().action != "settings");
}

TEST(ApiSettings, AnOperatorInControlHasTheSensorKeepARecording) {
  const auto keep = [this](const Json& body) { return ask("POST", "/sensors/keep", body); };
  log_in("ana");
  STRCMP_EQUAL("control_needed", code_of(keep({{"which", "last"}})).c_str());
  take_control_as("ana");
  for (const Json& body : {Json{{"which", "all"}}, Json{{"which", 1}}, Json::object()}) {
    const control::Answer answer = keep(body);
    LONGS_EQUAL(400, answer.status);
    STRCMP_CONTAINS("which", answer.body["error"]["message"].get<std::string>().c_str());
  }
  CHECK(cell.did.empty());
  control::Answer answer = keep({{"which", "last"}});
  LONGS_EQUAL(200, answer.status);
  STRCMP_EQUAL("kept: /data/scan-2", answer.body["words"].get<std::string>().c_str());
  LONGS_EQUAL(200, keep({{"which", "next"}}).status);
  STRCMP_EQUAL("keep last ana", cell.did[0].c_str());
  STRCMP_EQUAL("keep next ana", cell.did[1].c_str());
  const auto rows = memory->log_rows(0, 2);
  SUCCEEDS(rows);
  STRCMP_EQUAL("keep recording", rows->back().action.c_str());
  STRCMP_EQUAL("/data/scan-2", rows->back().after.c_str());
  cell.next = fail(Errc::PeerRefused, "/data/scan-last: no scan waits there");
  answer = keep({{"which", "last"}});
  LONGS_EQUAL(409, answer.status);
  STRCMP_CONTAINS("no scan waits", answer.body["error"]["message"].get<std::string>().c_str());
}

}  // namespace biteline::api
