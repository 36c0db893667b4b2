// SPDX-License-Identifier: MIT
// A finished scan again: worked out with other settings, or mended by hand.
#include <CppUTest/TestHarness.h>

#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_cloud.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(ApiAgain, ApiWorld){};

TEST(ApiAgain, RerunIsOrderedByAnEngineerAndToldBesideTheResult) {
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

TEST(ApiAgain, RerunThatMakesNoSenseIsRefusedBeforeTheCellHearsOfIt) {
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

TEST(ApiAgain, ScanHoldsSoManyRerunsAndNoMore) {
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

TEST(ApiAgain, AMendIsANewVersionWithWhoAndWhyAndTheCellIsToldOnBothSides) {
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
  LONGS_EQUAL_TEXT(200, answer.status, test::text_of(answer.body).c_str());
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

TEST(ApiAgain, WhatWasSentOrIsInWorkIsNotMended) {
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
  // Each that was begun is ended.
  STRCMP_EQUAL("begin mend scan-0003", cell.did.at(2).c_str());
  STRCMP_EQUAL("end mend scan-0003 no ana", cell.did.at(3).c_str());
  cell.next = fail(Errc::WrongState, "scan-0001 is in work");
  LONGS_EQUAL(409, ask("POST", "/scans/scan-0001/mend", mend).status);
  LONGS_EQUAL(5, cell.did.size());
}

}  // namespace biteline::api
