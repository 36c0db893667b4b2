// SPDX-License-Identifier: MIT
// What is taught is an object of the service: every door sees it, and a model saved is what was run in the
// air.
#include <CppUTest/TestHarness.h>

#include <fstream>
#include <iterator>

#include "tests/support/json.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

struct ApiTeachWorld : ApiWorld {
  /// As the service leaves a scan that waits for a person.
  void hold(const std::string& scan, int line_version = 0, const char* decision = "held") {
    memory::Scan row;
    row.name = scan;
    row.time = memory::now_ms();
    row.verdict = "ok";
    row.decision = decision;
    row.process = "cement";
    row.line_version = line_version;
    SUCCEEDS(memory->put_scan(row, {}));
    if (!std::filesystem::exists(folder.path() / scan / "line.csv")) write_sample(scan);
    cell.held = scan;
  }
  void plan(const std::string& scan, const std::string& process, const std::string& by) {
    std::ifstream stream{std::filesystem::path{BITELINE_PROCESSES} / (process + ".yaml")};
    folder.write(scan + "/process.yaml", {std::istreambuf_iterator<char>{stream}, {}});
    folder.write(scan + "/path/tracking.html", "<!doctype html>");
    cell.process_by = by;
  }
  /// The arm has run it, or not.
  void end_air(const std::string& scan, const std::string& followed) {
    std::filesystem::remove_all(folder.path() / scan / "air");
    folder.write(scan + "/air/followed.json", followed);
  }
  Json teaching() { return ask("GET", "/teachings", {}, {{"limit", "1"}}).body["teachings"][0]; }
  std::string step() {
    const Json told = ask("GET", "/state").body["teaching"];
    return told.is_null() ? "none" : told["step"].get<std::string>();
  }
  std::string why(std::size_t step) {
    const Json told = teaching()["steps"][step]["why"];
    return told.is_null() ? "" : told.get<std::string>();
  }
  void begin() {
    log_in("eng");
    LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
    LONGS_EQUAL(202, ask("POST", "/commands/start", {{"hold", true}}).status);
  }
  /// To a scan that was planned, looked at and run in the air.
  void run_once() {
    begin();
    hold("scan-0001");
    plan("scan-0001", "cement", "eng");
    LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
    end_air("scan-0001", R"({"completed":true,"duration_s":161.2})");
  }
  control::Answer save(Json more = {}) {
    Json body{{"name", "boot"}, {"scan", "scan-0001"}};
    if (!more.is_null()) body.update(more);
    return ask("POST", "/models", body);
  }
};

TEST_GROUP_BASE(ApiTeach, ApiTeachWorld){};

TEST(ApiTeach, EveryDoorSeesWhoTeachesWhatAndAtWhichStep) {
  log_in("vic");
  STRCMP_EQUAL("none", step().c_str());
  LONGS_EQUAL(0, ask("GET", "/teachings").body["teachings"].size());
  begin();
  STRCMP_EQUAL("scan", step().c_str());
  STRCMP_EQUAL("eng", teaching()["begun_by"].get<std::string>().c_str());
  CHECK(teaching()["scan"].is_null());
  hold("scan-0001");
  STRCMP_EQUAL("process", step().c_str());
  STRCMP_EQUAL("scan-0001", teaching()["scan"].get<std::string>().c_str());
  STRCMP_EQUAL("not_chosen", why(2).c_str());
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/process", {{"process", "cement"}}).status);
  plan("scan-0001", "cement", "eng");
  STRCMP_EQUAL("dry_run", step().c_str());
  STRCMP_EQUAL("eng", teaching()["process_by"].get<std::string>().c_str());
  const std::string at = "/teachings/" + std::to_string(teaching()["id"].get<int>());
  const Json shown{{"scan", "scan-0001"},
                   {"line_version", 0},
                   {"process_sha256", teaching()["process_sha256"].get<std::string>()}};
  const control::Answer seen = ask("POST", at + "/dry-run", shown);
  LONGS_EQUAL_TEXT(200, seen.status, test::text_of(seen.body).c_str());
  STRCMP_EQUAL("eng", seen.body["dry_run"]["who"].get<std::string>().c_str());
  STRCMP_EQUAL("look at dry run", memory->log_rows(0, 1)->front().action.c_str());
  STRCMP_EQUAL("air", step().c_str());
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
  STRCMP_EQUAL("running", why(4).c_str());
  end_air("scan-0001", R"({"completed":true,"duration_s":161.2})");
  STRCMP_EQUAL("model", step().c_str());
  LONGS_EQUAL(201, save().status);
  STRCMP_EQUAL("none", step().c_str());
  // Whoever looks later sees how it ended.
  log_in("vic");
  const Json ended = ask("GET", at).body;
  STRCMP_EQUAL("saved", ended["ended_how"].get<std::string>().c_str());
  STRCMP_EQUAL("boot", ended["model"].get<std::string>().c_str());
  CHECK(ended["step"].is_null());
  CHECK(std::ranges::count(events, "teaching") >= 6);
}

TEST(ApiTeach, WhoeverLooksOnTellsNothing) {
  begin();
  const std::string at = "/teachings/" + std::to_string(teaching()["id"].get<int>());
  log_in("vic");
  LONGS_EQUAL(403, ask("POST", at + "/dry-run").status);
  LONGS_EQUAL(403, ask("DELETE", at).status);
  LONGS_EQUAL(404, ask("GET", "/teachings/99").status);
  LONGS_EQUAL(404, ask("GET", "/teachings/x").status);
  LONGS_EQUAL(404, ask("GET", "/teachings/0").status);
  log_in("ana");
  STRCMP_EQUAL("control_held", code_of(ask("DELETE", at)).c_str());
}

TEST(ApiTeach, ADryRunCountsForWhatWasLookedAtAlone) {
  begin();
  const std::string at = "/teachings/" + std::to_string(teaching()["id"].get<int>());
  LONGS_EQUAL(409, ask("POST", at + "/dry-run").status);
  hold("scan-0001");
  LONGS_EQUAL(409, ask("POST", at + "/dry-run").status);
  plan("scan-0001", "cement", "eng");
  LONGS_EQUAL(404, ask("POST", "/teachings/99/dry-run").status);
  LONGS_EQUAL(404, ask("POST", "/teachings/x/dry-run").status);
  LONGS_EQUAL(400, ask("POST", at + "/dry-run", {{"seen", true}}).status);
  LONGS_EQUAL(409, ask("POST", at + "/dry-run", {{"line_version", 1}}).status);
  LONGS_EQUAL(409, ask("POST", at + "/dry-run", {{"scan", "scan-0002"}}).status);
  LONGS_EQUAL(409, ask("POST", at + "/dry-run", {{"process_sha256", "b2"}}).status);
  LONGS_EQUAL(200, ask("POST", at + "/dry-run").status);
  STRCMP_EQUAL("air", step().c_str());
  hold("scan-0001", 1);
  STRCMP_EQUAL("dry_run", step().c_str());
  STRCMP_EQUAL("line_changed", why(3).c_str());
  LONGS_EQUAL(200, ask("POST", at + "/dry-run").status);
  plan("scan-0001", "grind", "eng");
  STRCMP_EQUAL("process_changed", why(3).c_str());
}

TEST(ApiTeach, AnOldRunInTheAirIsNotTakenForTheOneThatWasJustOrdered) {
  run_once();
  STRCMP_EQUAL("model", step().c_str());
  hold("scan-0001", 1);
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
  // The files of the run before still stand there.
  STRCMP_EQUAL("running", why(4).c_str());
  std::filesystem::remove_all(folder.path() / "scan-0001/air");
  STRCMP_EQUAL("running", why(4).c_str());
  end_air("scan-0001", R"({"completed":false})");
  STRCMP_EQUAL("stopped", why(4).c_str());
  LONGS_EQUAL(409, save().status);
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
  end_air("scan-0001", R"({"completed":true})");
  STRCMP_EQUAL("model", step().c_str());
  LONGS_EQUAL(201, save().status);
}

TEST(ApiTeach, AModelSavedIsWhatWasRunInTheAirUnlessSomebodySaysThatItIsNot) {
  begin();
  hold("scan-0001");
  plan("scan-0001", "cement", "eng");
  control::Answer refused = save();
  LONGS_EQUAL(409, refused.status);
  STRCMP_CONTAINS("was not run in the air yet", test::text_of(refused.body).c_str());
  CHECK(!std::filesystem::exists(folder.path() / "models/boot"));
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
  end_air("scan-0001", R"({"completed":true})");
  // Mended since.
  hold("scan-0001", 1);
  refused = save();
  LONGS_EQUAL(409, refused.status);
  STRCMP_CONTAINS("the line of scan-0001 is another one", test::text_of(refused.body).c_str());
  hold("scan-0001", 0);
  // Planned anew since, or saved with another one.
  plan("scan-0001", "grind", "eng");
  STRCMP_CONTAINS("the process of scan-0001 is another one", test::text_of(save().body).c_str());
  plan("scan-0001", "cement", "eng");
  LONGS_EQUAL(409, save({{"process", "grind"}, {"other_process", true}}).status);
  const control::Answer said = save({{"process", "grind"}, {"other_process", true}, {"not_run", true}});
  LONGS_EQUAL_TEXT(201, said.status, test::text_of(said.body).c_str());
  const memory::LogRow row = memory->log_rows(0, 1)->front();
  STRCMP_EQUAL("save model", row.action.c_str());
  STRCMP_CONTAINS("scan-0001, not run: the process of scan-0001 is another one", row.after.c_str());
  // What was run needs no such word, and it says nothing then.
  LONGS_EQUAL(201, save({{"replace", true}, {"not_run", true}}).status);
  STRCMP_EQUAL("scan-0001", memory->log_rows(0, 1)->front().after.c_str());
}

TEST(ApiTeach, AScanThatNobodyTeachesIsSavedAsEver) {
  log_in("eng");
  hold("scan-0001");
  plan("scan-0001", "cement", "eng");
  LONGS_EQUAL(201, save().status);
  // Nor one of a teaching that was given up.
  begin();
  hold("scan-0001");
  const std::string at = "/teachings/" + std::to_string(teaching()["id"].get<int>());
  LONGS_EQUAL(409, save({{"replace", true}}).status);
  LONGS_EQUAL(204, ask("DELETE", at).status);
  STRCMP_EQUAL("give up teaching", memory->log_rows(0, 1)->front().action.c_str());
  STRCMP_EQUAL("none", step().c_str());
  LONGS_EQUAL(409, ask("DELETE", at).status);
  LONGS_EQUAL(409, ask("POST", at + "/dry-run").status);
  LONGS_EQUAL(404, ask("DELETE", "/teachings/99").status);
  LONGS_EQUAL(404, ask("DELETE", "/teachings/x").status);
  LONGS_EQUAL(201, save({{"replace", true}}).status);
}

TEST(ApiTeach, AShoeThatIsScannedAgainStaysOneTeaching) {
  run_once();
  const int id = teaching()["id"].get<int>();
  LONGS_EQUAL(202, ask("POST", "/commands/rescan", {{"hold", true}}).status);
  hold("scan-0001", 0, "rejected");
  hold("scan-0002");
  plan("scan-0002", "cement", "eng");
  const Json now = teaching();
  LONGS_EQUAL(id, now["id"].get<int>());
  STRCMP_EQUAL("scan-0002", now["scan"].get<std::string>().c_str());
  STRCMP_EQUAL("scan-0001", now["scans_before"][0].get<std::string>().c_str());
  STRCMP_EQUAL("scanned_again", why(4).c_str());
  const control::Answer refused = ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0002"}});
  LONGS_EQUAL(409, refused.status);
  STRCMP_CONTAINS("scan-0001 was run in the air, and not scan-0002", test::text_of(refused.body).c_str());
  // What was run may be saved all the same.
  LONGS_EQUAL(201, save().status);
}

TEST(ApiTeach, AnotherStartReplacesItAndOneWithoutHoldGivesItUp) {
  const auto ended_how = [this](std::size_t newest) {
    const Json told = ask("GET", "/teachings").body["teachings"][newest]["ended_how"];
    return told.is_null() ? "" : told.get<std::string>();
  };
  begin();
  LONGS_EQUAL(202, ask("POST", "/commands/start", {{"hold", true}}).status);
  STRCMP_EQUAL("replaced", ended_how(1).c_str());
  STRCMP_EQUAL("", ended_how(0).c_str());
  // A start that was refused changes nothing.
  cell.next = fail(Errc::WrongState, "it waits");
  LONGS_EQUAL(409, ask("POST", "/commands/start").status);
  STRCMP_EQUAL("", ended_how(0).c_str());
  cell.next = {};
  LONGS_EQUAL(202, ask("POST", "/commands/start").status);
  STRCMP_EQUAL("given_up", ended_how(0).c_str());
  // A rescan that holds begins one where there is none, and goes on with one that is open.
  for (int again = 0; again < 2; ++again)
    LONGS_EQUAL(202, ask("POST", "/commands/rescan", {{"hold", true}}).status);
  LONGS_EQUAL(3, ask("GET", "/teachings").body["teachings"].size());
  LONGS_EQUAL(202, ask("POST", "/commands/rescan").status);
  STRCMP_EQUAL("given_up", ended_how(0).c_str());
  const Json page = ask("GET", "/teachings", {}, {{"limit", "2"}}).body;
  LONGS_EQUAL(2, page["teachings"].size());
  const Json rest = ask("GET", "/teachings", {}, {{"cursor", page["next"].get<std::string>()}}).body;
  LONGS_EQUAL(1, rest["teachings"].size());
  CHECK(rest["next"].is_null());
  LONGS_EQUAL(400, ask("GET", "/teachings", {}, {{"limit", "0"}}).status);
}

TEST(ApiTeach, ItOutlivesTheServiceAndAFolderThatIsCleared) {
  run_once();
  STRCMP_EQUAL("model", step().c_str());
  std::filesystem::remove_all(folder.path() / "scan-0001");
  STRCMP_EQUAL("model", step().c_str());
  FakeCell anew;
  Api next{Rooms{.memory = *memory,
                 .accounts = accounts,
                 .cell = anew,
                 .results = folder.path(),
                 .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"},
                 .models = transfer::Library{folder.path() / "models"},
                 .exchange = Exchange{folder.path() / ".exchange"},
                 .version = "1.2.3",
                 .publish = {},
                 .last_seq = {}}};
  STRCMP_EQUAL("model", next.teaching_json()["step"].get<std::string>().c_str());
}

TEST(ApiTeach, TheSensorLooksAgainForWhoeverHoldsControl) {
  hold("scan-0001");
  log_in("vic");
  LONGS_EQUAL(403, ask("POST", "/scans/scan-0001/look").status);
  log_in("ana");
  STRCMP_EQUAL("control_needed", code_of(ask("POST", "/scans/scan-0001/look")).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/look").status);
  STRCMP_EQUAL("look scan-0001 ana", cell.did.back().c_str());
  STRCMP_EQUAL("look again", memory->log_rows(0, 1)->front().action.c_str());
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/look", {{"x", 1}}).status);
  LONGS_EQUAL(404, ask("POST", "/scans/scan/look").status);
  cell.next = fail(Errc::WrongState, "it does not wait");
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0001/look").status);
}

}  // namespace biteline::api
