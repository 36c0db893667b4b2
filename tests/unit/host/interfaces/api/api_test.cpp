// SPDX-License-Identifier: MIT
// Who may ask what, and what comes back; the cell behind it is a fake.
#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "host/interfaces/accounts/first_token.hpp"
#include "host/interfaces/accounts/metrics_token.hpp"
#include "tests/support/json.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(Api, ApiWorld){};

TEST(Api, NothingIsToldWithoutALogin) {
  for (const char* path :
       {"/state", "/me", "/scans", "/models", "/processes", "/robots", "/mounted", "/sensors", "/log",
        "/users", "/history/trends", "/history.csv", "/control", "/scans/scan-0001", "/exchange/metrics"}) {
    const control::Answer answer = ask("GET", path);
    LONGS_EQUAL_TEXT(401, answer.status, path);
    STRCMP_EQUAL("login_needed", code_of(answer).c_str());
  }
  token = "no such token";
  LONGS_EQUAL(401, ask("GET", "/state").status);
  LONGS_EQUAL(401, ask("POST", "/sessions", {{"name", "ada"}, {"password", "wrong password"}}).status);
}

TEST(Api, TokenOfAProgramReadsTheMetricsAndNothingElse) {
  token = std::string(40, 'p');
  SUCCEEDS(accounts::use_metrics_token(folder.path() / memory::k_memory_file, folder.write("token", token)));
  const control::Answer metrics = ask("GET", "/exchange/metrics");
  LONGS_EQUAL(200, metrics.status);
  STRCMP_EQUAL("waiting", metrics.body["state"]["phase"].get<std::string>().c_str());
  CHECK(metrics.body["sensors"]["disk"]["free_bytes"].is_number());
  for (const char* path :
       {"/state", "/me", "/scans", "/sensors", "/log", "/users", "/history.csv", "/control"})
    LONGS_EQUAL_TEXT(401, ask("GET", path).status, path);
  LONGS_EQUAL(401, ask("POST", "/commands/start").status);
  LONGS_EQUAL(401, ask("POST", "/commands/stop").status);
  // A person's session does as well.
  log_in("vic");
  LONGS_EQUAL(200, ask("GET", "/exchange/metrics").status);
}

TEST(Api, RolesAreTheLeastThatMay) {
  const struct {
    const char *method, *path;
    int viewer, operator_, engineer;
  } k_cases[] = {
      {"GET", "/state", 200, 200, 200},           {"GET", "/log", 403, 403, 200},
      {"GET", "/users", 403, 403, 403},           {"POST", "/control", 403, 400, 400},
      {"POST", "/models", 403, 403, 400},         {"PUT", "/processes/x", 403, 403, 400},
      {"POST", "/commands/start", 403, 409, 409},
  };
  for (const auto& row : k_cases) {
    for (const auto& [name, status] :
         {std::pair{"vic", row.viewer}, std::pair{"ana", row.operator_}, std::pair{"eng", row.engineer}}) {
      log_in(name);
      LONGS_EQUAL_TEXT(status, ask(row.method, row.path).status, row.path);
    }
  }
}

TEST(Api, CommandsNeedTheHolderOfControl) {
  log_in("ana");
  STRCMP_EQUAL("control_needed", code_of(ask("POST", "/commands/start")).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}, {"why", "my shift"}}).status);
  LONGS_EQUAL(202, ask("POST", "/commands/start", {{"process", "grind"}}).status);
  log_in("eng");
  const control::Answer held = ask("POST", "/commands/start");
  STRCMP_EQUAL("control_held", code_of(held).c_str());
  STRCMP_CONTAINS("ana", held.body["error"]["message"].get<std::string>().c_str());
  LONGS_EQUAL(1, cell.did.size());
  STRCMP_EQUAL("start ana grind", cell.did.front().c_str());
  CHECK(std::ranges::find(events, "control") != events.end());
  CHECK(std::ranges::find(events, "log") != events.end());
}

TEST(Api, StopAndLaserOffNeedNoLoginAtTheCellAndOneElsewhere) {
  local = true;
  LONGS_EQUAL(200, ask("POST", "/commands/stop").status);
  LONGS_EQUAL(200, ask("POST", "/commands/laser-off").status);
  LONGS_EQUAL(2, cell.did.size());
  local = false;
  LONGS_EQUAL(401, ask("POST", "/commands/stop").status);
  log_in("vic");
  LONGS_EQUAL(403, ask("POST", "/commands/stop").status);
  LONGS_EQUAL(2, cell.did.size());
  log_in("ana");
  LONGS_EQUAL(200, ask("POST", "/commands/stop").status);
  STRCMP_EQUAL("stop ana", cell.did.back().c_str());
}

TEST(Api, BodiesAreReadStrictly) {
  log_in("ana");
  const control::Answer unknown = ask("POST", "/control", {{"action", "take"}, {"acton", 1}});
  LONGS_EQUAL(400, unknown.status);
  STRCMP_EQUAL("acton", unknown.body["error"]["faults"][0]["field"].get<std::string>().c_str());
  LONGS_EQUAL(400, ask("POST", "/control", {{"action", 5}}).status);
  LONGS_EQUAL(400, ask("POST", "/control", Json::array({1})).status);
  LONGS_EQUAL(400, ask("POST", "/control", {{"action", "take"}, {"why", std::string(501, 'a')}}).status);
  LONGS_EQUAL(405, ask("PUT", "/state").status);
  LONGS_EQUAL(404, ask("GET", "/nothing").status);
}

TEST(Api, PeopleAreMadeChangedAndRemovedByAnAdministrator) {
  log_in("ada");
  LONGS_EQUAL(201,
              ask("POST", "/users", {{"name", "bob"}, {"role", "viewer"}, {"password", k_password}}).status);
  STRCMP_EQUAL("exists",
               code_of(ask("POST", "/users", {{"name", "bob"}, {"role", "viewer"}, {"password", k_password}}))
                   .c_str());
  LONGS_EQUAL(400,
              ask("POST", "/users", {{"name", "cat"}, {"role", "king"}, {"password", k_password}}).status);
  LONGS_EQUAL(200, ask("PATCH", "/users/bob", {{"role", "operator"}}).status);
  LONGS_EQUAL(400, ask("PATCH", "/users/ada", {{"enabled", false}}).status);
  log_in("bob");
  LONGS_EQUAL(
      403,
      ask("PATCH", "/users/bob", {{"password", "another long one"}, {"old_password", "wrong wrong"}}).status);
  LONGS_EQUAL(
      403,
      ask("PATCH", "/users/ada", {{"password", "another long one"}, {"old_password", k_password}}).status);
  LONGS_EQUAL(
      200,
      ask("PATCH", "/users/bob", {{"password", "another long one"}, {"old_password", k_password}}).status);
  LONGS_EQUAL(401, ask("GET", "/state").status);  // the session ended with the password
  log_in("ada");
  LONGS_EQUAL(204, ask("DELETE", "/users/bob").status);
  const control::Answer users = ask("GET", "/users");
  STRCMP_EQUAL("", test::text_of(users.body).find("argon2") == std::string::npos ? "" : "a hash is told");
}

TEST(Api, FirstAccountIsMadeAtTheCellOnly) {
  test::TemporaryFolder fresh;
  auto empty = memory::Memory::open(fresh.path() / memory::k_memory_file);
  SUCCEEDS(empty);
  accounts::Accounts nobody{*empty};
  Api api{Rooms{.memory = *empty,
                .accounts = nobody,
                .cell = cell,
                .results = fresh.path(),
                .processes = ProcessStore{{}, fresh.path()},
                .models = transfer::Library{fresh.path()},
                .exchange = Exchange{fresh.path() / ".exchange"},
                .version = {},
                .publish = {},
                .last_seq = {}}};
  control::Request request;
  request.method = "POST";
  request.path = "/api/v1/users";
  request.body = {{"name", "ada"}, {"role", "administrator"}, {"password", k_password}};
  // Any program may say that it was asked at the cell, and a door on another machine does.
  request.local = true;
  LONGS_EQUAL(403, api.ordinary(request).status);
  SUCCEEDS(accounts::offer_first_account(nobody, fresh.path()));
  LONGS_EQUAL(403, api.ordinary(request).status);
  request.token = "made up";
  LONGS_EQUAL(403, api.ordinary(request).status);
  const std::filesystem::path file = fresh.path() / accounts::k_first_token_file;
  CHECK(std::filesystem::status(file).permissions() ==
        (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
  request.token = accounts::read_first_token(fresh.path());
  request.local = false;
  LONGS_EQUAL(403, api.ordinary(request).status);
  request.local = true;
  LONGS_EQUAL(201, api.ordinary(request).status);
  request.body["name"] = "eve";
  LONGS_EQUAL(401, api.ordinary(request).status);
  // With an account none is offered any more.
  SUCCEEDS(accounts::offer_first_account(nobody, fresh.path()));
  CHECK(!std::filesystem::exists(file));
  STRCMP_EQUAL("", accounts::read_first_token(fresh.path()).c_str());
}

TEST(Api, ProcessWithAFaultIsRefusedWholeAndItsFieldNamed) {
  log_in("eng");
  const std::size_t shipped = ask("GET", "/processes").body["processes"].size();
  Json process = ask("GET", "/processes/grind").body["process"];
  process["motion"]["speed_mm_s"] = -1;
  const control::Answer refused = ask("PUT", "/processes/mine", process);
  LONGS_EQUAL(422, refused.status);
  STRCMP_EQUAL("check_failed", code_of(refused).c_str());
  STRCMP_CONTAINS("motion.speed_mm_s",
                  refused.body["error"]["faults"][0]["field"].get<std::string>().c_str());
  LONGS_EQUAL(404, ask("GET", "/processes/mine").status);
  process["motion"]["speed_mm_s"] = 40;
  LONGS_EQUAL(200, ask("PUT", "/processes/mine", process).status);
  DOUBLES_EQUAL(40, ask("GET", "/processes/mine").body["process"]["motion"]["speed_mm_s"].get<double>(), 0);
  LONGS_EQUAL(shipped + 1, ask("GET", "/processes").body["processes"].size());
}

TEST(Api, LogTellsChangesNewestFirstWithACursor) {
  log_in("eng");
  const control::Answer first = ask("GET", "/log", {}, {{"limit", "2"}});
  LONGS_EQUAL(2, first.body["entries"].size());
  STRCMP_EQUAL("login", first.body["entries"][0]["what"].get<std::string>().c_str());
  const control::Answer second = ask("GET", "/log", {}, {{"cursor", first.body["next"].get<std::string>()}});
  CHECK(second.body["entries"][0]["seq"].get<int>() < first.body["entries"][1]["seq"].get<int>());
}

TEST(Api, LinesControlHasNoLoginAndOnlyItsOwnWords) {
  control::Request request;
  const auto say = [&](const char* door, const char* method, const std::string& path, Json body = {}) {
    request.door = door;
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    return sut.ordinary(request);
  };
  const auto refusal = [&](const control::Answer& answer) {
    LONGS_EQUAL(200, answer.status);
    return answer.body["refusal"].get<int>();
  };
  for (const char* door : {"modbus", "text"}) {
    LONGS_EQUAL(0, say(door, "GET", "/line").body["job"].get<int>());
    LONGS_EQUAL(0, refusal(say(door, "PUT", "/line/job", {{"job", 1}})));
    LONGS_EQUAL(0, refusal(say(door, "PUT", "/line/part", {{"part", " A-17 "}})));
    STRCMP_EQUAL("A-17", say(door, "GET", "/line").body["next_part"].get<std::string>().c_str());
    LONGS_EQUAL(0, refusal(say(door, "POST", "/line/start", {{"request", 7}})));
    STRCMP_EQUAL("line start 7", cell.did.back().c_str());
    // Nothing else is open to a door without login: no approval, no laser, no reading of results.
    for (const char* path : {"/scans/scan-0001/accept", "/scans/scan-0001/send", "/scans/scan-0001/mend",
                             "/commands/start", "/commands/rescan", "/control"})
      LONGS_EQUAL_TEXT(401, say(door, "POST", path).status, path);
    for (const char* path : {"/state", "/scans", "/models", "/log", "/users"})
      LONGS_EQUAL_TEXT(401, say(door, "GET", path).status, path);
    cell.chosen = 0;
  }
  // A page, or a tool that names no such door, has none of it.
  for (const char* door : {"web", "", "Modbus"}) LONGS_EQUAL(404, say(door, "GET", "/line").status);
}

TEST(Api, LinesControlIsToldWhyNot) {
  control::Request request;
  request.door = "modbus";
  const auto refusal = [&](const char* method, const std::string& path, Json body) {
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    const control::Answer answer = sut.ordinary(request);
    LONGS_EQUAL(200, answer.status);
    return static_cast<line_control::Refusal>(answer.body["refusal"].get<int>());
  };
  using line_control::Refusal;
  for (const Json& body : {Json{}, Json{{"job", "1"}}, Json{{"job", 1.5}}, Json{{"job", -1}},
                           Json{{"job", 65536}}, Json{{"job", 1}, {"x", 1}}, Json(3)})
    CHECK(refusal("PUT", "/line/job", body) == Refusal::BadRequest);
  CHECK(refusal("POST", "/line/start", {{"job", 1}}) == Refusal::BadRequest);
  for (const Json& body :
       {Json{}, Json{{"part", 17}}, Json{{"part", "a\nb"}}, Json{{"part", std::string(65, 'x')}},
        Json{{"part", "A-17"}, {"job", 1}}, Json("A-17")})
    CHECK(refusal("PUT", "/line/part", body) == Refusal::BadRequest);
  // Of no such number; of a process and of a model that are not there.
  for (const int number : {9, 2, 3})
    CHECK(refusal("PUT", "/line/job", {{"job", number}}) == Refusal::UnknownJob);
  SUCCEEDS(accounts.take_control("ana", "web"));
  CHECK(refusal("PUT", "/line/job", {{"job", 1}}) == Refusal::ControlHeld);
  CHECK(refusal("PUT", "/line/part", {{"part", "A-17"}}) == Refusal::ControlHeld);
  CHECK(refusal("POST", "/line/start", {{"request", 1}}) == Refusal::None);
  STRCMP_EQUAL("line start 1 held", cell.did.back().c_str());
  cell.jobs = false;
  CHECK(refusal("POST", "/line/start", {{"request", 1}}) == Refusal::NotOpen);
}

}  // namespace biteline::api
