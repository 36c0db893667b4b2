// SPDX-License-Identifier: MIT
// Who may ask what, and what comes back; the cell behind it is a fake.
#include "host/api/api.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "host/api/words.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::api {
namespace {

constexpr const char* k_password = "a long password";

struct FakeCell final : Cell {
  std::vector<std::string> did;
  std::filesystem::path results{};  ///< of the scan that is worked out again
  Result<void> next{};

  Json state() override { return {{"phase", "waiting"}}; }
  Json robots() override { return Json::array(); }
  Json sensors() override { return Json::array(); }
  void stop(const std::string& who) override { did.push_back("stop " + who); }
  void laser_off(const std::string& who) override { did.push_back("laser off " + who); }
  Result<void> start(const Job& job, const std::string& who) override {
    did.push_back("start " + who + " " + job.process);
    return next;
  }
  Result<void> rescan(const std::string& who, const std::string&, const std::string&) override {
    did.push_back("rescan " + who);
    return next;
  }
  Result<void> begin_mend(const std::string& scan) override {
    did.push_back("begin mend " + scan);
    return next;
  }
  void end_mend(const std::string& scan, bool mended, const std::string& who) override {
    did.push_back("end mend " + scan + (mended ? " yes " : " no ") + who);
  }
  bool on_demand() override { return jobs; }
  line_control::LineState line_state() override {
    line_control::LineState state;
    state.job = chosen;
    return state;
  }
  std::optional<Job> job_of(int number) override {
    if (number < 1 || number > 3) return std::nullopt;
    return Job{.model = number == 3 ? "not-there" : "", .process = number == 2 ? "not-there" : ""};
  }
  line_control::Refusal choose_job(int number, bool control_held) override {
    if (control_held) return line_control::Refusal::ControlHeld;
    chosen = number;
    return line_control::Refusal::None;
  }
  LineStart start_for_line(int request, bool control_held) override {
    did.push_back("line start " + std::to_string(request) + (control_held ? " held" : ""));
    return {.refusal = line_control::Refusal::None, .fresh = true};
  }
  bool jobs{true};
  int chosen{0};

  Result<void> choose_model(const std::string& scan, const std::string& model,
                            const std::string& who) override {
    did.push_back("model " + scan + " " + model + " " + who);
    return next;
  }
  Result<int> rerun(const RerunOrder& order) override {
    did.push_back("rerun " + order.scan + " " + order.who + " " + settings_json(order).dump());
    if (!next) return tl::unexpected<Error>{next.error()};
    return keep_order(results, order);
  }
  bool rerun_open(const std::string&, int number) override { return number > 1; }
  Result<void> decide(const Decision& decision) override {
    did.push_back("decide " + decision.scan + " " + decision.who + " " + decision.door + " " + decision.why);
    return next;
  }
};

}  // namespace

TEST_GROUP(Api) {
  test::TemporaryFolder folder;
  Result<memory::Memory> memory{memory::Memory::open(folder.path() / memory::k_memory_file)};
  accounts::Accounts accounts{*memory};
  FakeCell cell;
  std::vector<std::string> events;
  Api sut{Rooms{.memory = *memory,
                .accounts = accounts,
                .cell = cell,
                .results = folder.path(),
                .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"},
                .models = transfer::Library{folder.path() / "models"},
                .version = "1.2.3",
                .publish = [this](const std::string& name, const Json&) { events.push_back(name); },
                .last_seq = [] { return std::uint64_t{7}; }}};
  std::string token;
  bool local{false};

  void setup() override {
    SUCCEEDS(accounts.add("ada", accounts::Role::Administrator, k_password, "ada", "web"));
    for (const auto& [name, role] :
         {std::pair{"vic", accounts::Role::Viewer}, std::pair{"ana", accounts::Role::Operator},
          std::pair{"eng", accounts::Role::Engineer}})
      SUCCEEDS(accounts.add(name, role, k_password, "ada", "web"));
  }
  control::Answer ask(const std::string& method, const std::string& path, Json body = {},
                      std::map<std::string, std::string> query = {}) {
    control::Request request;
    request.token = token;
    request.local = local;
    request.door = "web";
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    request.query = std::move(query);
    return sut.ordinary(request);
  }
  void log_in(const std::string& name) {
    const control::Answer answer = ask("POST", "/sessions", {{"name", name}, {"password", k_password}});
    LONGS_EQUAL(201, answer.status);
    token = answer.body["token"].get<std::string>();
  }
  static std::string code_of(const control::Answer& answer) {
    return answer.body["error"]["code"].get<std::string>();
  }
  void put(const std::string& name, const std::string& verdict) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'000'000;
    scan.verdict = verdict;
    memory::LogRow event;
    event.who = "service";
    SUCCEEDS(memory->put_scan(scan, event));
  }
};

TEST(Api, NothingIsToldWithoutALogin) {
  for (const char* path : {"/state", "/me", "/scans", "/models", "/processes", "/robots", "/sensors", "/log",
                           "/users", "/history/trends", "/history.csv", "/control", "/scans/scan-0001"}) {
    const control::Answer answer = ask("GET", path);
    LONGS_EQUAL_TEXT(401, answer.status, path);
    STRCMP_EQUAL("login_needed", code_of(answer).c_str());
  }
  token = "no such token";
  LONGS_EQUAL(401, ask("GET", "/state").status);
  LONGS_EQUAL(401, ask("POST", "/sessions", {{"name", "ada"}, {"password", "wrong password"}}).status);
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

TEST(Api, ScansAreListedAndDecidedAbout) {
  put("scan-0001", "ok");
  put("scan-0002", "refused");
  log_in("ana");
  const control::Answer list = ask("GET", "/scans", {}, {{"limit", "1"}});
  LONGS_EQUAL(1, list.body["scans"].size());
  STRCMP_EQUAL("scan-0002", list.body["scans"][0]["id"].get<std::string>().c_str());
  const control::Answer rest = ask("GET", "/scans", {}, {{"cursor", list.body["next"].get<std::string>()}});
  STRCMP_EQUAL("scan-0001", rest.body["scans"][0]["id"].get<std::string>().c_str());
  CHECK(rest.body["next"].is_null());
  for (const auto& [name, value] :
       {std::pair{"limit", "0"}, std::pair{"limit", "x"}, std::pair{"from", "today"},
        std::pair{"verdict", "good"}, std::pair{"cursor", "-1"}, std::pair{"who", "me"}})
    LONGS_EQUAL(400, ask("GET", "/scans", {}, {{name, value}}).status);

  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/reject").status);  // why?
  LONGS_EQUAL(200, ask("POST", "/scans/scan-0001/reject", {{"why", "a hole"}}).status);
  STRCMP_EQUAL("decide scan-0001 ana web a hole", cell.did.back().c_str());
  LONGS_EQUAL(404, ask("POST", "/scans/..%2fx/accept").status);
  cell.next = fail(Errc::WrongState, "scan-0001 does not wait");
  const control::Answer late = ask("POST", "/scans/scan-0001/accept");
  LONGS_EQUAL(409, late.status);
  STRCMP_EQUAL("wrong_state", code_of(late).c_str());
}

TEST(Api, OneScanComesWithItsReportAndWeakStretches) {
  put("scan-0001", "amber");
  folder.write(
      "scan-0001/report.json",
      R"({"status":"ok","weak_stretches":[{"place":"heel","from_mm":10,"length_mm":5,"least_confidence":0.4}]})");
  log_in("vic");
  const control::Answer scan = ask("GET", "/scans/scan-0001");
  LONGS_EQUAL(200, scan.status);
  STRCMP_EQUAL("ok", scan.body["report"]["status"].get<std::string>().c_str());
  DOUBLES_EQUAL(15, scan.body["stretches"][0]["to_mm"].get<double>(), 1e-9);
  CHECK(scan.body["gate"].is_null());
  LONGS_EQUAL(404, ask("GET", "/scans/scan-0009").status);
  LONGS_EQUAL(404, ask("GET", "/scans/memory.sqlite").status);
}

TEST(Api, MarkedScanIsKept) {
  put("scan-0001", "ok");
  log_in("ana");
  CHECK(ask("POST", "/scans/scan-0001/keep", {{"kept", true}}).body["kept"].get<bool>());
  memory::Retention all;
  all.oldest = 2'000'000;
  CHECK(memory->folders_to_go(all, folder.path())->empty());
  CHECK(!ask("POST", "/scans/scan-0001/keep", {{"kept", false}}).body["kept"].get<bool>());
  LONGS_EQUAL(1, memory->folders_to_go(all, folder.path())->size());
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/keep").status);
  LONGS_EQUAL(404, ask("POST", "/scans/scan-0002/keep", {{"kept", true}}).status);
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
  STRCMP_EQUAL("", users.body.dump().find("argon2") == std::string::npos ? "" : "a hash is told");
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
                .version = {},
                .publish = {},
                .last_seq = {}}};
  control::Request request;
  request.method = "POST";
  request.path = "/api/v1/users";
  request.body = {{"name", "ada"}, {"role", "administrator"}, {"password", k_password}};
  LONGS_EQUAL(401, api.ordinary(request).status);
  request.local = true;
  LONGS_EQUAL(201, api.ordinary(request).status);
  request.body["name"] = "eve";
  LONGS_EQUAL(401, api.ordinary(request).status);
}

TEST(Api, ProcessWithAFaultIsRefusedWholeAndItsFieldNamed) {
  log_in("eng");
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
  LONGS_EQUAL(5, ask("GET", "/processes").body["processes"].size());
}

TEST(Api, RerunIsOrderedByAnEngineerAndToldBesideTheResult) {
  put("scan-0001", "refused");
  std::filesystem::create_directories(folder.path() / "scan-0001");
  cell.results = folder.path() / "scan-0001";
  const Json order{{"settings", {{"process", "grind"}, {"method", "default"}}}, {"why", "to see"}};
  log_in("ana");
  LONGS_EQUAL(403, ask("POST", "/scans/scan-0001/rerun", order).status);
  log_in("eng");
  STRCMP_EQUAL("control_needed", code_of(ask("POST", "/scans/scan-0001/rerun", order)).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  const control::Answer first = ask("POST", "/scans/scan-0001/rerun", order);
  LONGS_EQUAL(202, first.status);
  LONGS_EQUAL(1, first.body["rerun"].get<int>());
  STRCMP_EQUAL("rerun", memory->log_rows(0, 1)->front().action.c_str());
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/rerun", order).status);

  // The first was left by a service that ended, until its outcome stands there.
  Json reruns = ask("GET", "/scans/scan-0001").body["reruns"];
  LONGS_EQUAL(2, reruns.size());
  STRCMP_EQUAL("lost", reruns[0]["state"].get<std::string>().c_str());
  STRCMP_EQUAL("working", reruns[1]["state"].get<std::string>().c_str());
  STRCMP_EQUAL("grind", reruns[0]["settings"]["process"].get<std::string>().c_str());
  STRCMP_EQUAL("to see", reruns[0]["why"].get<std::string>().c_str());
  folder.write("scan-0001/rerun-1/report.json", R"({"status":"ok","length_mm":500.5,"confidence":0.9})");
  std::filesystem::create_directories(cell.results / "rerun-1/path");
  folder.write("scan-0001/rerun-1/path/report.json", R"({"status":"refused","reason_code":"cannot_follow"})");
  reruns = ask("GET", "/scans/scan-0001").body["reruns"];
  STRCMP_EQUAL("done", reruns[0]["state"].get<std::string>().c_str());
  STRCMP_EQUAL("refused", reruns[0]["verdict"].get<std::string>().c_str());
  STRCMP_EQUAL("cannot_follow", reruns[0]["reason_code"].get<std::string>().c_str());
  DOUBLES_EQUAL(500.5, reruns[0]["length_mm"].get<double>(), 0);
  CHECK(reruns[0]["path"].is_null());
  // The scan's own row says what it said.
  STRCMP_EQUAL("refused", ask("GET", "/scans/scan-0001").body["verdict"].get<std::string>().c_str());
}

TEST(Api, ModelOfAHeldScanIsNamedByAnOperatorAndMustExist) {
  put("scan-0001", "ok");
  log_in("ana");
  STRCMP_EQUAL("control_needed", code_of(ask("POST", "/scans/scan-0001/model", {{"model", "boot"}})).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/model").status);
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/model", {{"model", "../x"}}).status);
  LONGS_EQUAL(404, ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);
  LONGS_EQUAL(0, cell.did.size());
  log_in("vic");
  LONGS_EQUAL(403, ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);
}

TEST(Api, RerunThatMakesNoSenseIsRefusedBeforeTheCellHearsOfIt) {
  put("scan-0001", "ok");
  log_in("eng");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  for (const char* bad :
       {R"({})", R"({"settings":{}})", R"({"settings":5})", R"({"settings":{"method":"best"}})",
        R"({"settings":{"model":"a","method":"default"}})",
        R"({"settings":{"mirror":true,"process":"grind"}})", R"({"settings":{"process":"../x"}})",
        R"({"settings":{"process":"grind","candidate":1}})"}) {
    LONGS_EQUAL_TEXT(400, ask("POST", "/scans/scan-0001/rerun", Json::parse(bad)).status, bad);
  }
  const auto status_of = [&](const char* scan, const Json& settings) {
    return ask("POST", std::string{"/scans/"} + scan + "/rerun", {{"settings", settings}}).status;
  };
  LONGS_EQUAL(404, status_of("scan-0002", {{"process", "grind"}}));
  LONGS_EQUAL(404, status_of("scan-0001", {{"process", "none-such"}}));
  LONGS_EQUAL(404, status_of("scan-0001", {{"model", "none-such"}}));
  LONGS_EQUAL(0, cell.did.size());
  cell.next = fail(Errc::WrongState, "full");
  LONGS_EQUAL(409, status_of("scan-0001", {{"process", "grind"}}));
}

TEST(Api, ScanHoldsSoManyRerunsAndNoMore) {
  const RerunOrder order{.scan = "scan-0001",
                         .model = {},
                         .method = "default",
                         .process = {},
                         .who = "eng",
                         .why = {},
                         .door = {}};
  for (int number = 1; number <= k_most_reruns; ++number) {
    const Result<int> kept = keep_order(folder.path(), order);
    SUCCEEDS(kept);
    LONGS_EQUAL(number, *kept);
  }
  FAILS_NAMING(Errc::WrongState, "20 times", keep_order(folder.path(), order));
}

TEST(Api, LogTellsChangesNewestFirstWithACursor) {
  log_in("eng");
  const control::Answer first = ask("GET", "/log", {}, {{"limit", "2"}});
  LONGS_EQUAL(2, first.body["entries"].size());
  STRCMP_EQUAL("login", first.body["entries"][0]["what"].get<std::string>().c_str());
  const control::Answer second = ask("GET", "/log", {}, {{"cursor", first.body["next"].get<std::string>()}});
  CHECK(second.body["entries"][0]["seq"].get<int>() < first.body["entries"][1]["seq"].get<int>());
}

TEST(Api, HistoryIsToldAsTrendsAndCsv) {
  put("scan-0001", "ok");
  put("scan-0002", "refused");
  log_in("vic");
  const control::Answer trends = ask("GET", "/history/trends", {}, {{"bucket", "week"}});
  LONGS_EQUAL(1, trends.body["buckets"].size());
  LONGS_EQUAL(2, trends.body["buckets"][0]["scans"].get<int>());
  CHECK(trends.body["capability"].is_null());
  LONGS_EQUAL(400, ask("GET", "/history/trends", {}, {{"bucket", "year"}}).status);
  const control::Answer csv = ask("GET", "/history.csv");
  STRCMP_EQUAL("text/csv", csv.type.c_str());
  LONGS_EQUAL(3, std::ranges::count(csv.body.get<std::string>(), '\n'));
}

TEST(Api, LinesControlHasNoLoginAndOnlyItsThreeWords) {
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
  // Of no such number; of a process and of a model that are not there.
  for (const int number : {9, 2, 3})
    CHECK(refusal("PUT", "/line/job", {{"job", number}}) == Refusal::UnknownJob);
  SUCCEEDS(accounts.take_control("ana", "web"));
  CHECK(refusal("PUT", "/line/job", {{"job", 1}}) == Refusal::ControlHeld);
  CHECK(refusal("POST", "/line/start", {{"request", 1}}) == Refusal::None);
  STRCMP_EQUAL("line start 1 held", cell.did.back().c_str());
  cell.jobs = false;
  CHECK(refusal("POST", "/line/start", {{"request", 1}}) == Refusal::NotOpen);
}

TEST(Api, AMendIsANewVersionWithWhoAndWhyAndTheCellIsToldOnBothSides) {
  const test::MadeCloud made = test::made_cloud(sim::ShoeClass::Deep, 4101, test::somewhere());
  const bite_line::Extraction found = bite_line::find_bite_line(made.cloud, {});
  const std::filesystem::path scan = folder.path() / "scan-0001";
  folder.write("scan-0001/report.json", R"({"status":"ok","confidence":0.9})");
  SUCCEEDS(cloud::write_cloud(scan / "cloud.ply", made.cloud));
  SUCCEEDS(cloud::write_line(scan / "line.csv", found.line));
  put("scan-0001", "ok");
  log_in("ana");
  const Vec3& at = found.line.points[300].position;
  const Json mend{{"line_version", 0},
                  {"why", "the heel"},
                  {"steps",
                   {{{"step", "through"},
                     {"from_mm", 130},
                     {"to_mm", 170},
                     {"points", Json::array({{at.x(), at.y(), at.z()}})}}}}};
  STRCMP_EQUAL("control_needed", code_of(ask("POST", "/scans/scan-0001/mend", mend)).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  for (const char* bad :
       {R"({})", R"({"line_version":0,"why":"x","steps":[]})",
        R"({"line_version":0,"why":"x","steps":[{"step":"glue"}]})",
        R"({"line_version":0,"why":"x","steps":[{"step":"cut","from_mm":1}]})",
        R"({"line_version":0,"why":"x","steps":[{"step":"candidate","candidate":0}]})",
        R"({"line_version":0,"why":"x","steps":[{"step":"candidate","candidate":1,"more":1}]})",
        R"({"line_version":-1,"why":"x","steps":[{"step":"candidate","candidate":1}]})"})
    LONGS_EQUAL_TEXT(400, ask("POST", "/scans/scan-0001/mend", Json::parse(bad)).status, bad);
  CHECK(cell.did.empty());

  const control::Answer answer = ask("POST", "/scans/scan-0001/mend", mend);
  LONGS_EQUAL_TEXT(200, answer.status, answer.body.dump().c_str());
  LONGS_EQUAL(1, answer.body["line_version"].get<int>());
  STRCMP_EQUAL("amber", answer.body["verdict"].get<std::string>().c_str());
  CHECK(answer.body["confidence"].get<double>() <= 0.9);
  STRCMP_EQUAL("begin mend scan-0001", cell.did.at(0).c_str());
  STRCMP_EQUAL("end mend scan-0001 yes ana", cell.did.at(1).c_str());
  const control::Answer now = ask("GET", "/scans/scan-0001");
  LONGS_EQUAL(2, now.body["versions"].size());
  STRCMP_EQUAL("the heel", now.body["versions"][1]["why"].get<std::string>().c_str());
  STRCMP_EQUAL("ana", now.body["versions"][1]["who"].get<std::string>().c_str());
  CHECK(std::filesystem::exists(scan / now.body["versions"][0]["file"].get<std::string>()));
  STRCMP_EQUAL("mend", memory->log_rows(0, 1)->front().action.c_str());

  // Somebody else's mend came between, and a step that cannot be done.
  STRCMP_EQUAL("wrong_state", code_of(ask("POST", "/scans/scan-0001/mend", mend)).c_str());
  Json far = mend;
  far["line_version"] = 1;
  far["steps"][0]["points"][0][2] = 9000;
  const control::Answer refused = ask("POST", "/scans/scan-0001/mend", far);
  LONGS_EQUAL(422, refused.status);
  STRCMP_EQUAL("end mend scan-0001 no ana", cell.did.back().c_str());
  LONGS_EQUAL(2, ask("GET", "/scans/scan-0001").body["versions"].size());
}

TEST(Api, WhatWasSentOrIsInWorkIsNotMended) {
  memory::Scan sent;
  sent.name = "scan-0002";
  sent.time = 1'000'000;
  sent.verdict = "ok";
  sent.sent = true;
  SUCCEEDS(memory->put_scan(sent, {.id = 0,
                                   .time = 0,
                                   .who = "service",
                                   .door = {},
                                   .action = {},
                                   .subject = {},
                                   .before = {},
                                   .after = {}}));
  put("scan-0001", "ok");
  log_in("ana");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  const Json mend{{"line_version", 0}, {"why", "x"}, {"steps", {{{"step", "candidate"}, {"candidate", 1}}}}};
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0002/mend", mend).status);
  LONGS_EQUAL(404, ask("POST", "/scans/scan-0003/mend", mend).status);
  CHECK(cell.did.empty());
  cell.next = fail(Errc::WrongState, "scan-0001 is in work");
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0001/mend", mend).status);
  LONGS_EQUAL(1, cell.did.size());
}

}  // namespace biteline::api
