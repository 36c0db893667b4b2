// SPDX-License-Identifier: MIT
// What is told of scans, and what a person decides about them.
#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(ApiScans, ApiWorld){};

TEST(ApiScans, ScansAreListedAndDecidedAbout) {
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

TEST(ApiScans, AShoeIsFoundByItsPartNumberOrTheBeginningOfIt) {
  for (const auto& [name, part] :
       {std::pair{"scan-0001", "A-17"}, std::pair{"scan-0002", "A-171"}, std::pair{"scan-0003", ""}}) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'000'000;
    scan.verdict = "ok";
    scan.part = part;
    scan.foot = "left";
    scan.size = "EU 42";
    SUCCEEDS(memory->put_scan(scan, {}));
  }
  log_in("vic");
  const auto found = [this](const char* part) {
    return ask("GET", "/scans", {}, {{"part", part}}).body["scans"];
  };
  const Json exact = found("A-17");
  LONGS_EQUAL(1, exact.size());
  STRCMP_EQUAL("A-17", exact[0]["part"].get<std::string>().c_str());
  STRCMP_EQUAL("left", exact[0]["foot"].get<std::string>().c_str());
  STRCMP_EQUAL("EU 42", exact[0]["size"].get<std::string>().c_str());
  LONGS_EQUAL(2, found("A-17*").size());
  LONGS_EQUAL(0, found("-17").size());
  LONGS_EQUAL(3, found("").size());
  CHECK(ask("GET", "/scans/scan-0003").body["part"].is_null());
  STRCMP_CONTAINS("A-171",
                  ask("GET", "/history.csv", {}, {{"part", "A-171"}}).body.get<std::string>().c_str());
}

TEST(ApiScans, OneScanComesWithItsReportAndWeakStretches) {
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

TEST(ApiScans, MarkedScanIsKept) {
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

TEST(ApiScans, ModelOfAHeldScanIsNamedByAnOperatorAndMustExist) {
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

TEST(ApiScans, HistoryIsToldAsTrendsAndCsv) {
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

TEST(ApiScans, TablesComeAsTheSpreadsheetReadsThemAndFiltersTakeTheFactorysDays) {
  put("scan-0001", "ok");
  log_in("vic");
  const control::Answer csv = ask("GET", "/history.csv", {},
                                  {{"separator", "semicolon"}, {"decimal", "comma"}, {"byte_mark", "yes"}});
  LONGS_EQUAL(200, csv.status);
  CHECK(csv.body.get<std::string>().starts_with("\xEF\xBB\xBFtime;scan;"));
  for (const auto& [separator, decimal] :
       {std::pair{"comma", "comma"}, std::pair{";", "point"}, std::pair{"tab", "both"}})
    LONGS_EQUAL(400, ask("GET", "/history.csv", {}, {{"separator", separator}, {"decimal", decimal}}).status);
  for (const char* from :
       {"1970-01-01", "1970-01-01T00:00", "1970-01-01T00:00:00Z", "1970-01-01T00:00:00+08:00"})
    LONGS_EQUAL_TEXT(1, ask("GET", "/scans", {}, {{"from", from}}).body["scans"].size(), from);
  LONGS_EQUAL(0, ask("GET", "/scans", {}, {{"from", "1970-01-03"}}).body["scans"].size());
  for (const char* from : {"yesterday", "27.11.2026", "2026-11-27T08:00+99:00"})
    LONGS_EQUAL_TEXT(400, ask("GET", "/scans", {}, {{"from", from}}).status, from);
}

}  // namespace biteline::api
