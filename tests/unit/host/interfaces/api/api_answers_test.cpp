// SPDX-License-Identifier: MIT
// The good answers that no other test looks at: each is noted and held against openapi.yaml (api_answers).
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/core/base64.hpp"
#include "tests/support/json.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

struct ApiAnswersWorld : ApiWorld {
  void put_sample(const std::string& scan) {
    put(scan, "ok");
    write_sample(scan);
  }
  static std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
  }
};

TEST_GROUP_BASE(ApiAnswers, ApiAnswersWorld){};

TEST(ApiAnswers, AModelIsMadeToldAndTakenOutOfUse) {
  put_sample("scan-0001");
  log_in("eng");
  const Json wish{
      {"name", "boot"}, {"scan", "scan-0001"}, {"process", "grind"}, {"size", "EU 42"}, {"foot", "left"}};
  const control::Answer made = ask("POST", "/models", wish);
  LONGS_EQUAL_TEXT(201, made.status, test::text_of(made.body).c_str());
  STRCMP_EQUAL("left", made.body["foot"].get<std::string>().c_str());
  STRCMP_EQUAL("exists", code_of(ask("POST", "/models", wish)).c_str());
  DOUBLES_EQUAL(12, ask("GET", "/models/boot").body["length_mm"].get<double>(), 1e-3);
  folder.write("models/torn/line.csv", "nothing");
  const Json models = ask("GET", "/models").body["models"];
  LONGS_EQUAL(2, models.size());
  CHECK(models[1].contains("damage"));
  LONGS_EQUAL(204, ask("DELETE", "/models/boot").status);
  LONGS_EQUAL(404, ask("GET", "/models/boot").status);
}

/// Whatever a tab remembers: a model has the process that its scan was planned with.
TEST(ApiAnswers, AModelTakesItsScansOwnProcessAndAnotherOneOnlyWhenThatIsSaid) {
  put_sample("scan-0001");
  memory::Scan scan = **memory->scan("scan-0001");
  scan.process = "cement";
  SUCCEEDS(memory->put_scan(scan, {}));
  const std::string cement = text_of(std::filesystem::path{BITELINE_PROCESSES} / "cement.yaml");
  folder.write("scan-0001/process.yaml", cement);
  log_in("eng");
  STRCMP_EQUAL("cement", ask("GET", "/scans/scan-0001").body["process_file"].get<std::string>().c_str());
  const control::Answer own = ask("POST", "/models", {{"name", "own"}, {"scan", "scan-0001"}});
  LONGS_EQUAL_TEXT(201, own.status, test::text_of(own.body).c_str());
  STRCMP_EQUAL("cement", own.body["process"].get<std::string>().c_str());
  CHECK_EQUAL(cement, text_of(folder.path() / "models/own/process.yaml"));
  STRCMP_CONTAINS("saved ", cell.did.back().c_str());
  const Json same{{"name", "same"}, {"scan", "scan-0001"}, {"process", "cement"}};
  LONGS_EQUAL(201, ask("POST", "/models", same).status);
  Json other{{"name", "other"}, {"scan", "scan-0001"}, {"process", "grind"}};
  const control::Answer refused = ask("POST", "/models", other);
  LONGS_EQUAL(409, refused.status);
  STRCMP_CONTAINS("planned with cement, and not with grind", test::text_of(refused.body).c_str());
  CHECK(!std::filesystem::exists(folder.path() / "models/other"));
  other["other_process"] = true;
  LONGS_EQUAL(201, ask("POST", "/models", other).status);
  CHECK_EQUAL(text_of(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
              text_of(folder.path() / "models/other/process.yaml"));
  LONGS_EQUAL(
      400, ask("POST", "/models", {{"name", "none"}, {"scan", "scan-0001"}, {"other_process", true}}).status);

  // Saved anew under the same name since it was planned: what was looked at is what the model gets.
  folder.write("processes/cement.yaml", cement + "# anew\n");
  LONGS_EQUAL(
      409, ask("POST", "/models", {{"name", "anew"}, {"scan", "scan-0001"}, {"process", "cement"}}).status);
  LONGS_EQUAL(201, ask("POST", "/models", {{"name", "anew"}, {"scan", "scan-0001"}}).status);
  CHECK_EQUAL(cement, text_of(folder.path() / "models/anew/process.yaml"));
  CHECK(ask("GET", "/scans/scan-0001").body["process_file"].is_null());

  // Of an older program nothing lies beside the scan; its row still knows the name.
  std::filesystem::remove(folder.path() / "scan-0001/process.yaml");
  LONGS_EQUAL(409,
              ask("POST", "/models", {{"name", "old"}, {"scan", "scan-0001"}, {"process", "grind"}}).status);
  const control::Answer old = ask("POST", "/models", {{"name", "old"}, {"scan", "scan-0001"}});
  LONGS_EQUAL(201, old.status);
  STRCMP_EQUAL("cement", old.body["process"].get<std::string>().c_str());
  scan.process = "not-there";
  SUCCEEDS(memory->put_scan(scan, {}));
  LONGS_EQUAL(409, ask("POST", "/models", {{"name", "gone"}, {"scan", "scan-0001"}}).status);
}

TEST(ApiAnswers, AStartSaysWhoseShoeComesNext) {
  log_in("eng");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  const Json whose{{"model", "boot"}, {"foot", "left"}, {"size", "EU 42"}, {"part", " A-17 "}};
  LONGS_EQUAL(202, ask("POST", "/commands/start", whose).status);
  STRCMP_EQUAL("left", cell.job.foot.c_str());
  STRCMP_EQUAL("EU 42", cell.job.size.c_str());
  STRCMP_EQUAL("A-17", cell.job.part.c_str());
  const Json entry = ask("GET", "/log").body["entries"][0];
  STRCMP_EQUAL("boot, left, EU 42, A-17", entry["after"].get<std::string>().c_str());
  for (const auto& [field, value] :
       {std::pair{"foot", Json("links")}, std::pair{"foot", Json(1)},
        std::pair{"size", Json(std::string(21, 'x'))}, std::pair{"part", Json(std::string(65, 'x'))},
        std::pair{"part", Json("two\nlines")}}) {
    const control::Answer answer = ask("POST", "/commands/start", {{field, value}});
    LONGS_EQUAL_TEXT(400, answer.status, field);
    STRCMP_EQUAL(field, answer.body["error"]["faults"][0]["field"].get<std::string>().c_str());
  }
  // Nothing of before is left.
  LONGS_EQUAL(202, ask("POST", "/commands/start").status);
  CHECK(cell.job.foot.empty() && cell.job.size.empty() && cell.job.part.empty());
}

TEST(ApiAnswers, AModelMayBeASampleOfAnother) {
  put_sample("scan-0001");
  log_in("eng");
  const Json sample{
      {"name", "boot-41"}, {"scan", "scan-0001"}, {"size", "EU 41"}, {"foot", "left"}, {"of", "boot"}};
  const control::Answer answer = ask("POST", "/models", sample);
  LONGS_EQUAL(201, answer.status);
  STRCMP_EQUAL("boot", answer.body["of"].get<std::string>().c_str());
  STRCMP_EQUAL("boot", ask("GET", "/models/boot-41").body["of"].get<std::string>().c_str());
  LONGS_EQUAL(400, ask("POST", "/models", {{"name", "x"}, {"scan", "scan-0001"}, {"of", "../x"}}).status);
  LONGS_EQUAL(201, ask("POST", "/models", {{"name", "alone"}, {"scan", "scan-0001"}}).status);
  CHECK(ask("GET", "/models/alone").body["of"].is_null());
}

TEST(ApiAnswers, AStartThatSaysNothingOfTheProcessKeepsWhatAPersonChose) {
  log_in("eng");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  const auto kept = [&](Json body) {
    LONGS_EQUAL(202, ask("POST", "/commands/start", std::move(body)).status);
    return cell.job.keep_process;
  };
  CHECK(kept({}));
  CHECK(kept({{"hold", true}}));
  CHECK_FALSE(kept({{"process", ""}}));
  CHECK_FALSE(kept({{"process", "grind"}}));
  // A model is named for its own process.
  CHECK_FALSE(kept({{"model", "boot"}}));
}

TEST(ApiAnswers, AModelGoesOutAsAFileAndComesBackInPieces) {
  put_sample("scan-0001");
  log_in("eng");
  LONGS_EQUAL(201, ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0001"}}).status);
  LONGS_EQUAL(404, ask("GET", "/models/shoe/file").status);
  const control::Answer out = ask("GET", "/models/boot/file");
  LONGS_EQUAL_TEXT(200, out.status, test::text_of(out.body).c_str());
  STRCMP_EQUAL("application/x-tar", out.type.c_str());
  const std::string file = text_of(folder.path() / out.file);
  CHECK(file.size() > 1024);

  const auto piece = [&](std::size_t at, const std::string& bytes, bool last, Json more = Json::object()) {
    more["at"] = at;
    more["bytes"] = to_base64(bytes);
    more["last"] = last;
    return ask("POST", "/exchange/model", more);
  };
  const std::size_t half = file.size() / 2;
  STRCMP_EQUAL("control_needed", code_of(piece(0, file, true)).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  // Its own name is taken; another is not, and a piece that does not fit ends it.
  STRCMP_EQUAL("exists", code_of(piece(0, file, true, {{"name", "boot"}})).c_str());
  // Under the name that the file has, the answer is the same.
  const control::Answer nameless = piece(0, file, true);
  LONGS_EQUAL(409, nameless.status);
  STRCMP_EQUAL("exists", code_of(nameless).c_str());
  LONGS_EQUAL(200, piece(0, file.substr(0, half), false).status);
  STRCMP_EQUAL("wrong_state", code_of(piece(half + 1, "x", false)).c_str());
  STRCMP_EQUAL("wrong_state", code_of(piece(half, file.substr(half), true)).c_str());
  LONGS_EQUAL(200, piece(0, file.substr(0, half), false).status);
  const control::Answer in = piece(half, file.substr(half), true, {{"name", "twin"}});
  LONGS_EQUAL_TEXT(201, in.status, test::text_of(in.body).c_str());
  STRCMP_EQUAL("twin", in.body["name"].get<std::string>().c_str());
  DOUBLES_EQUAL(12, in.body["length_mm"].get<double>(), 1e-3);
  LONGS_EQUAL(201, piece(0, file, true, {{"replace", true}}).status);
  LONGS_EQUAL(2, ask("GET", "/models/boot").body["version"].get<int>());

  // Cut short or changed: nothing of it, no path of this machine in the words, and no file is left.
  std::string changed = file;
  changed[half] = static_cast<char>(changed[half] + 1);
  for (const std::string& bad : {file.substr(0, half), changed, std::string{"no archive"}, std::string{}}) {
    const control::Answer refused = piece(0, bad, true, {{"name", "torn"}});
    LONGS_EQUAL_TEXT(400, refused.status, test::text_of(refused.body).c_str());
    CHECK(test::text_of(refused.body).find(folder.path().string()) == std::string::npos);
  }
  LONGS_EQUAL(404, ask("GET", "/models/torn").status);
  LONGS_EQUAL(200, piece(0, file, false).status);
  LONGS_EQUAL(204, ask("DELETE", "/exchange/model").status);
  int left = 0;
  for (const auto& entry : std::filesystem::directory_iterator{folder.path() / ".exchange"})
    left += entry.path().filename().string().starts_with("in") ? 1 : 0;
  LONGS_EQUAL(0, left);
  log_in("ana");
  STRCMP_EQUAL("not_allowed", code_of(piece(0, file, true)).c_str());
}

TEST(ApiAnswers, CapabilityComesWithTheModelsTolerance) {
  put_sample("scan-0001");
  log_in("eng");
  LONGS_EQUAL(201,
              ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0001"}, {"process", "grind"}}).status);
  for (const auto& [name, place_mm] : {std::pair{"scan-0002", 0.1F}, std::pair{"scan-0003", 0.3F}}) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'000'000;
    scan.verdict = "ok";
    scan.model = "boot";
    memory::Places places;
    places.fill(place_mm);
    SUCCEEDS(memory->put_scan(scan, {}, places));
  }
  const Json capability = ask("GET", "/history/trends", {}, {{"model", "boot"}}).body["capability"];
  LONGS_EQUAL(2, capability["scans"].get<int>());
  LONGS_EQUAL(36, capability["ppk"].size());
  // Mean 0.2 mm, spread 0.1 * sqrt(2) mm.
  const double tolerance_mm = capability["tolerance_mm"].get<double>();
  DOUBLES_EQUAL((tolerance_mm - 0.2) / (0.3 * std::sqrt(2.0)), capability["ppk"][0].get<double>(), 1e-4);
}

TEST(ApiAnswers, WordsAboutAScanComeBackWithItsRow) {
  put_sample("scan-0001");
  log_in("eng");
  LONGS_EQUAL(201, ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0001"}}).status);
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  STRCMP_EQUAL("eng", ask("GET", "/control").body["holder"].get<std::string>().c_str());
  const struct {
    const char* path;
    int status;
  } k_words[] = {{"accept", 200}, {"hold", 200}, {"send", 202}};
  for (const auto& word : k_words) {
    const control::Answer answer = ask("POST", std::string{"/scans/scan-0001/"} + word.path);
    LONGS_EQUAL_TEXT(word.status, answer.status, word.path);
    STRCMP_EQUAL("scan-0001", answer.body["id"].get<std::string>().c_str());
  }
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/model", {{"model", "boot"}}).status);
  LONGS_EQUAL(202, ask("POST", "/commands/rescan", {{"why", "it moved"}}).status);
  LONGS_EQUAL(5, cell.did.size());
}

TEST(ApiAnswers, AProcessIsTriedOnTheNewestLineWithoutBeingSaved) {
  log_in("ana");
  LONGS_EQUAL(403, ask("POST", "/processes/check").status);
  log_in("eng");
  Json wish{{"process", ask("GET", "/processes/grind").body["process"]}};
  CHECK(ask("POST", "/processes/check", wish).body["fits"].is_null());
  put_sample("scan-0001");
  put("scan-0002", "refused");
  cell.tried.duration_s = 16.6;
  const std::size_t told = events.size();
  Json fits = ask("POST", "/processes/check", wish).body;
  CHECK(fits["fits"].get<bool>());
  STRCMP_EQUAL("scan-0001", fits["scan"].get<std::string>().c_str());
  DOUBLES_EQUAL(16.6, fits["duration_s"].get<double>(), 0);
  cell.tried.refused =
      report::ToldRefusal{.reason_code = "cannot_follow", .reason = "joint 4", .next_step = "move the shoe"};
  wish["scan"] = "scan-0002";
  fits = ask("POST", "/processes/check", wish).body;
  CHECK_FALSE(fits["fits"].get<bool>());
  STRCMP_EQUAL("joint 4", fits["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("try scan-0002 grind", cell.did.back().c_str());
  LONGS_EQUAL(told, events.size());

  wish["process"]["motion"]["speed_mm_s"] = -1;
  const control::Answer fault = ask("POST", "/processes/check", wish);
  LONGS_EQUAL(422, fault.status);
  STRCMP_CONTAINS("motion.speed_mm_s", fault.body["error"]["faults"][0]["field"].get<std::string>().c_str());
  for (const char* bad : {R"({})", R"({"process":3})", R"({"process":{},"scan":"../x"})"})
    LONGS_EQUAL_TEXT(400, ask("POST", "/processes/check", Json::parse(bad)).status, bad);
  cell.next = fail(Errc::WrongState, "no arm");
  wish["process"]["motion"]["speed_mm_s"] = 20;
  LONGS_EQUAL(409, ask("POST", "/processes/check", wish).status);
}

TEST(ApiAnswers, AWaitingScanGetsAProcessAndARunInTheAir) {
  put_sample("scan-0001");
  log_in("ana");
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  LONGS_EQUAL(403, ask("POST", "/scans/scan-0001/process", {{"process", "grind"}}).status);
  CHECK(ask("GET", "/scans/scan-0001").body["air"].is_null());
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/air").status);
  STRCMP_EQUAL("air scan-0001 ana", cell.did.back().c_str());
  log_in("eng");
  STRCMP_EQUAL("control_held",
               code_of(ask("POST", "/scans/scan-0001/process", {{"process", "grind"}})).c_str());
  LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}, {"why", "to teach"}}).status);
  LONGS_EQUAL(202, ask("POST", "/scans/scan-0001/process", {{"process", "grind"}}).status);
  STRCMP_EQUAL("process scan-0001 grind eng", cell.did.back().c_str());
  LONGS_EQUAL(404, ask("POST", "/scans/scan-0001/process", {{"process", "not-there"}}).status);
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/process", {{"process", "../x"}}).status);
  LONGS_EQUAL(400, ask("POST", "/scans/scan-0001/air", {{"speed", 1}}).status);
  LONGS_EQUAL(404, ask("POST", "/scans/scan/air").status);
  // What is taught waits from its start on.
  LONGS_EQUAL(202, ask("POST", "/commands/start", {{"hold", true}}).status);
  STRCMP_EQUAL("start eng  held", cell.did.back().c_str());
  LONGS_EQUAL(202, ask("POST", "/commands/rescan", {{"hold", true}}).status);
  STRCMP_EQUAL("rescan eng held", cell.did.back().c_str());
  LONGS_EQUAL(400, ask("POST", "/commands/start", {{"hold", "yes"}}).status);
  cell.next = fail(Errc::WrongState, "it does not wait");
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0001/process", {{"process", "grind"}}).status);
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0001/air").status);
}

TEST(ApiAnswers, WhatBecameOfARunInTheAirIsTold) {
  put_sample("scan-0001");
  log_in("vic");
  const auto state = [this] {
    const Json air = ask("GET", "/scans/scan-0001").body["air"];
    return air["state"].get<std::string>() + " " +
           (air["reason"].is_null() ? "" : air["reason"].get<std::string>());
  };
  folder.write("scan-0001/air/path/report.json", R"({"status":"ok"})");
  STRCMP_EQUAL("begun ", state().c_str());
  folder.write("scan-0001/air/path/report.json", R"({"reason_code":"cannot_follow","reason":"joint 4"})");
  STRCMP_EQUAL("refused joint 4", state().c_str());
  folder.write("scan-0001/air/gate.json",
               R"({"permitted":false,"rows":[{"state":"passed"},{"state":"failed","name":"scan's age",)"
               R"("value":"130 s","limit":"120 s","reason_code":"scan_too_old","next_step":"scan again"}]})");
  STRCMP_EQUAL("refused not sent: scan's age: 130 s (120 s)", state().c_str());
  folder.write("scan-0001/air/report.json", R"({"status":"refused","reason":"no controller"})");
  STRCMP_EQUAL("refused no controller", state().c_str());
  folder.write("scan-0001/air/followed.json", R"({"completed":false,"stopped":{"reason":"a stop"}})");
  STRCMP_EQUAL("stopped a stop", state().c_str());
  folder.write("scan-0001/air/followed.json", R"({"completed":true,"duration_s":99.5})");
  STRCMP_EQUAL("followed ", state().c_str());
}

TEST(ApiAnswers, ASessionTellsWhoItIsAndEnds) {
  log_in("vic");
  const control::Answer me = ask("GET", "/me");
  STRCMP_EQUAL("vic", me.body["name"].get<std::string>().c_str());
  CHECK_FALSE(me.body["control"].get<bool>());
  STRCMP_EQUAL("object", ask("GET", "/processes/schema").body["type"].get<std::string>().c_str());
  LONGS_EQUAL(204, ask("DELETE", "/sessions").status);
  LONGS_EQUAL(401, ask("GET", "/me").status);
}

}  // namespace biteline::api
