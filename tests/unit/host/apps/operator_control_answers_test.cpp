// SPDX-License-Identifier: MIT
// What the real service answers about itself, asked through its control end as a door asks.
#include <CppUTest/TestHarness.h>

#include "host/apps/biteline-host/operator_control.hpp"
#include "host/interfaces/control/client.hpp"
#include "tests/support/api_answers.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/apps/opened_operator_control.hpp"

namespace biteline::service {

using api::Json;

TEST_GROUP(OperatorControlAnswers) {
  test::TemporaryFolder folder;
  std::unique_ptr<OperatorControl> sut;
  std::unique_ptr<control::Client> door;
  std::string token;

  void setup() override {
    OperatorControlConfig config;
    config.results = folder.path();
    config.catalogue = {.library = folder.path() / "models",
                        .shipped_processes = BITELINE_PROCESSES,
                        .saved_processes = folder.path() / "processes"};
    config.sensor = "tcp://127.0.0.1:7117";
    config.arm = "UR5e";
    config.controller = "127.0.0.1:29999";
    config.process = "rough";
    config.endpoint = wire::Endpoint{.host = "127.0.0.1", .port = 0};
    auto opened = OperatorControl::open(config);
    SUCCEEDS(opened);
    sut = std::move(*opened);
    SUCCEEDS(sut->accounts().add("ada", accounts::Role::Administrator, "a long password", "ada", "web"));
    auto client = control::Client::open({.endpoint = *wire::parse_endpoint(sut->address()), .keys = {}});
    SUCCEEDS(client);
    door = std::move(*client);
    token = ask("POST", "/sessions", {{"name", "ada"}, {"password", "a long password"}})["token"];
  }
  void teardown() override {
    door.reset();
    sut.reset();
  }
  Json ask(const std::string& method, const std::string& path, Json body = {}) {
    control::Request request;
    request.token = token;
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    const control::Answer answer = door->ask(std::move(request));
    CHECK_TEXT(answer.status < 300, test::text_of(answer.body).c_str());
    test::note_answer(method, path, answer.status, answer.type, answer.body);
    return answer.body;
  }
  void look_everywhere() {
    for (const char* path : {"/state", "/robots", "/sensors"}) static_cast<void>(ask("GET", path));
  }
};

TEST(OperatorControlAnswers, AServiceThatHasHeardOfNobodySaysSo) {
  look_everywhere();
  STRCMP_EQUAL("unknown", ask("GET", "/state")["lamps"]["robot"]["level"].get<std::string>().c_str());
  CHECK_FALSE(ask("GET", "/sensors")["sensors"][0]["connected"].get<bool>());
}

TEST(OperatorControlAnswers, TheNextStepIsACodeOfTheCellsState) {
  const auto told = [this] { return ask("GET", "/state")["next_code"].get<std::string>(); };
  STRCMP_EQUAL("sensor_called", told().c_str());
  sut->enter(CellEvent::Heard);
  STRCMP_EQUAL("next_scan", told().c_str());
  sut->hinder(Hindrance::Robot);
  STRCMP_EQUAL("robot_ready", told().c_str());
  sut->hinder(Hindrance::None);
  sut->enter(CellEvent::Spent);
  STRCMP_EQUAL("start", told().c_str());
  sut->show_work("the sole is missed", true);
  STRCMP_EQUAL("look_then_start", told().c_str());
}

TEST(OperatorControlAnswers, LampsAndSensorTellEachStateOfTheLaser) {
  wire::SensorHello hello;
  hello.name = "head";
  hello.version = "0.1.0";
  hello.simulated = true;
  sut->hear(hello);
  look_everywhere();
  const struct {
    wire::LaserState state;
    const char *laser, *level, *code, *detail;
  } k_cases[] = {{wire::LaserState::Off, "off", "off", "laser_off", "words"},
                 {wire::LaserState::On, "on", "ok", "laser_on", ""},
                 {wire::LaserState::Fault, "fault", "fault", "laser_fault", "words"}};
  for (const auto& row : k_cases) {
    wire::Health health;
    health.laser = row.state;
    health.laser_reason = "words";
    health.devices.temperature_degc = 41.5F;
    health.devices.clocks.push_back({.name = "camera"});
    sut->hear(health);
    look_everywhere();
    STRCMP_EQUAL(row.laser, ask("GET", "/sensors")["sensors"][0]["laser"].get<std::string>().c_str());
    const Json state = ask("GET", "/state");
    const Json& lamps = state["lamps"];
    STRCMP_EQUAL(row.level, lamps["laser"]["level"].get<std::string>().c_str());
    STRCMP_EQUAL(row.code, lamps["laser"]["code"].get<std::string>().c_str());
    STRCMP_EQUAL(row.detail, lamps["laser"]["detail"].get<std::string>().c_str());
    STRCMP_EQUAL("camera_not_open", lamps["camera"]["code"].get<std::string>().c_str());
    STRCMP_EQUAL("clock_unknown", lamps["clock"]["code"].get<std::string>().c_str());
    STRCMP_EQUAL("camera", lamps["clock"]["detail"].get<std::string>().c_str());
  }
}

TEST(OperatorControlAnswers, WhatTheUnitHasBeenThroughIsToldWhereItCounts) {
  sut->hear(wire::SensorHello{});
  wire::Health health;
  sut->hear(health);
  CHECK(ask("GET", "/sensors")["sensors"][0]["upkeep"].is_null());
  health.upkeep = wire::UpkeepState{
      .starts = 12, .boots = 3, .run_s = 7200, .laser_s = 90.5, .coldest_degc = {}, .hottest_degc = {}};
  sut->hear(health);
  Json upkeep = ask("GET", "/sensors")["sensors"][0]["upkeep"];
  LONGS_EQUAL(12, upkeep["starts"].get<int>());
  DOUBLES_EQUAL(90.5, upkeep["laser_s"].get<double>(), 0);
  CHECK(upkeep["hottest_degc"].is_null());
  health.upkeep->coldest_degc = 18.0F;
  health.upkeep->hottest_degc = 46.5F;
  sut->hear(health);
  upkeep = ask("GET", "/sensors")["sensors"][0]["upkeep"];
  DOUBLES_EQUAL(46.5, upkeep["hottest_degc"].get<double>(), 0);
}

TEST(OperatorControlAnswers, RobotsProgressModelAndHolderAreTold) {
  robot::ur::ControllerWords words;
  words.serial = "20225500123";
  words.remote = true;
  words.robot_mode = "RUNNING";
  sut->hear(words, "");
  sut->scan_begins("scan-0001");
  sut->show("scans scan-0001", "its line");
  sut->show_progress(50, 100);
  sut->show_model("boot", 0.98, {.name = "rough", .by = {}});
  CHECK(sut->begin_cycle().has_value());
  CHECK(sut->begin_cycle().has_value());
  static_cast<void>(ask("POST", "/control", {{"action", "take"}, {"why", "my shift"}}));
  look_everywhere();
  test::hold_worked(*sut, {.scan = "scan-0001", .waits = Waits::ForWord, .fresh_s = 60});
  look_everywhere();
  sut->enter(CellEvent::Reject);
  static_cast<void>(ask("POST", "/commands/stop"));
  look_everywhere();
  static_cast<void>(ask("POST", "/commands/start", {{"hold", true}}));
  static_cast<void>(ask("POST", "/commands/rescan", {{"why", "again"}, {"hold", true}}));
  const Json state = ask("GET", "/state");
  DOUBLES_EQUAL(0.5, state["progress"].get<double>(), 0);
  STRCMP_EQUAL("ada", state["control"]["holder"].get<std::string>().c_str());
  STRCMP_EQUAL("boot", state["model"]["name"].get<std::string>().c_str());
  CHECK(ask("GET", "/robots")["robots"][0]["powered"].get<bool>());
}

}  // namespace biteline::service
