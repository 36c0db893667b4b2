// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/scan_row.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/apps/biteline-host/recognise.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/work_book.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_good =
    R"({"status":"ok","length_mm":640.5,"confidence":0.98,"weak_stretches":[],"scan":{"duration_s":6.25},"stages":{"last profile to line":0.03}})";

}  // namespace

TEST_GROUP(ScanRow) {
  test::TemporaryFolder folder;
  std::optional<memory::Scan> row() const {
    return row_of(folder.path() / "scan-0001");
  }
};

TEST(ScanRow, FolderWithoutReportHasNone) {
  CHECK(!row());
  folder.write("scan-0001/report.json", "{ torn");
  CHECK(!row());
}

TEST(ScanRow, LineIsOkAndAmberWithWeakStretches) {
  folder.write("scan-0001/report.json", k_good);
  STRCMP_EQUAL("ok", row()->verdict.c_str());
  DOUBLES_EQUAL(640.5, *row()->length_mm, 0);
  DOUBLES_EQUAL(0.03, *row()->line_s, 0);
  DOUBLES_EQUAL(6.25, *row()->scan_s, 0);
  CHECK(!row()->sent);
  folder.write("scan-0001/report.json", R"({"status":"ok","weak_stretches":[{},{}]})");
  STRCMP_EQUAL("amber", row()->verdict.c_str());
  LONGS_EQUAL(2, row()->weak_stretches);
}

TEST(ScanRow, WhoseShoeItIsStandsInTheReportElseBesideTheRecording) {
  folder.write("scan-0001/report.json", R"({"status":"ok","part":null,"foot":"left","size":"EU 42"})");
  STRCMP_EQUAL("", row()->part.c_str());
  STRCMP_EQUAL("left", row()->foot.c_str());
  STRCMP_EQUAL("EU 42", row()->size.c_str());
  folder.write("scan-0001/scan.part", "A-18\n");
  STRCMP_EQUAL("A-18", row()->part.c_str());
  folder.write("scan-0001/report.json", R"({"status":"ok","part":"A-17"})");
  STRCMP_EQUAL("A-17", row()->part.c_str());
}

TEST(ScanRow, WhatALookAfterTheWorkToldStandsInTheRow) {
  folder.write("scan-0001/report.json", k_good);
  folder.write("scan-0001/gate.json", R"({"permitted":true,"rows":[],"inputs":{}})");
  folder.write("scan-0001/followed.json", R"({"completed":true})");
  CHECK(row()->work == memory::Work{});
  const fs::path scan = folder.path() / "scan-0001";
  second_look::Findings found{.line_mm = 600};
  found.faults = {{.kind = second_look::FaultKind::Missing, .along = {.from_mm = 595, .to_mm = 3}},
                  {.kind = second_look::FaultKind::Missing, .along = {.from_mm = 100, .to_mm = 102}},
                  {.kind = second_look::FaultKind::Wide, .along = {.from_mm = 200, .to_mm = 210}}};
  WorkBook book{.work = work_of(found, ExitStatus::Review),
                .looks = 2,
                .told = {.reason_code = "still_faulty", .reason = "3 faults", .next_step = "look"}};
  book.work.reworked = true;
  SUCCEEDS(write_work(scan, book));
  STRCMP_EQUAL("faulty", row()->work.verdict.c_str());
  DOUBLES_EQUAL(10, *row()->work.missing_mm, 1e-9);
  LONGS_EQUAL(1, row()->work.wide);
  LONGS_EQUAL(0, row()->work.narrow + row()->work.beside + row()->work.doubled);
  CHECK(row()->work.reworked);
  STRCMP_EQUAL("still_faulty", row()->reason_code.c_str());
  CHECK(row()->sent && *row()->followed);
  // All is worked: what the row says otherwise stands.
  SUCCEEDS(write_work(scan, {.work = work_of({.line_mm = 600}, ExitStatus::Done), .looks = 1}));
  STRCMP_EQUAL("ok", row()->work.verdict.c_str());
  STRCMP_EQUAL("", row()->reason_code.c_str());
  folder.write("scan-0001/work/work.json", "{ torn");
  CHECK(!read_work(scan));
  CHECK(row()->work == memory::Work{});
  forget_work(scan);
  const auto none = read_work(scan);
  SUCCEEDS(none);
  CHECK(!*none);
}

TEST(ScanRow, ALineThatAPersonMustSettleIsForReviewWhateverItsPathSays) {
  folder.write(
      "scan-0001/report.json",
      R"({"status":"review","reason_code":"rivalled","reason":"r","next_step":"n","length_mm":640.5,"weak_stretches":[{},{}]})");
  folder.write("scan-0001/path/report.json",
               R"({"status":"refused","reason_code":"line_check","reason":"not settled"})");
  STRCMP_EQUAL("review", row()->verdict.c_str());
  STRCMP_EQUAL("rivalled", row()->reason_code.c_str());
  LONGS_EQUAL(2, row()->weak_stretches);
  DOUBLES_EQUAL(640.5, *row()->length_mm, 0);
  CHECK(!row()->sent);
}

TEST(ScanRow, RefusalsOfLinePathAndGateAreTold) {
  folder.write("scan-0001/report.json",
               R"({"status":"refused","reason_code":"no_crease","reason":"r","next_step":"n"})");
  STRCMP_EQUAL("refused", row()->verdict.c_str());
  STRCMP_EQUAL("no_crease", row()->reason_code.c_str());
  folder.write("scan-0001/report.json", k_good);
  folder.write("scan-0001/path/report.json",
               R"({"status":"refused","reason_code":"cannot_follow","reason":"r"})");
  STRCMP_EQUAL("cannot_follow", row()->reason_code.c_str());
  folder.write("scan-0001/path/report.json", R"({"status":"ok"})");
  folder.write("scan-0001/gate.json",
               R"({"permitted":false,"rows":[{"name":"a","state":"passed"},
                   {"name":"scan's age","state":"failed","value":"130 s","limit":"120 s","reason_code":"scan_too_old"}]})");
  STRCMP_EQUAL("scan_too_old", row()->reason_code.c_str());
  STRCMP_CONTAINS("130 s", row()->reason.c_str());
  STRCMP_EQUAL("ok", row()->verdict.c_str());
  CHECK(!row()->sent);
}

TEST(ScanRow, WhatTheArmDidIsTold) {
  folder.write("scan-0001/report.json", k_good);
  folder.write("scan-0001/gate.json", R"({"permitted":true,"rows":[]})");
  CHECK(row()->sent);
  CHECK(!row()->followed);
  folder.write("scan-0001/followed.json", R"({"completed":true})");
  CHECK(row()->followed == true);
  folder.write("scan-0001/followed.json",
               R"({"completed":false,"stopped":{"reason_code":"off_path","reason":"r"}})");
  CHECK(row()->followed == false);
  STRCMP_EQUAL("off_path", row()->reason_code.c_str());
}

TEST(ScanRow, WhatWasSentTellsWhoseYesItWentBy) {
  folder.write("scan-0001/report.json", k_good);
  const auto decided = [&](const std::string& inputs) {
    folder.write("scan-0001/gate.json", R"({"permitted":true,"rows":[],"inputs":)" + inputs + "}");
    return row()->decision + ", " + row()->decided_by;
  };
  // A process that asks nobody, and a line that is sure enough.
  STRCMP_EQUAL("automatic, ", decided(R"({"scan":{},"result":{}})").c_str());
  STRCMP_EQUAL(
      "automatic, ",
      decided(R"({"result":{"approved":true,"approved_by":"automatic, confidence 0.991"}})").c_str());
  STRCMP_EQUAL("accepted, ada", decided(R"({"result":{"approved_by":"ada, 2026-11-28T10:00:00Z"}})").c_str());
  // --confirm at the start.
  STRCMP_EQUAL("accepted, bob", decided(R"({"scan":{"confirmed":{"by":"bob","at":"now"}}})").c_str());
  // What was not sent is still open, whoever said what.
  folder.write("scan-0001/gate.json",
               R"({"permitted":false,"inputs":{"result":{"approved_by":"ada, now"}}})");
  STRCMP_EQUAL("open", row()->decision.c_str());
  for (const char* torn : {"3", "null", R"({"scan":1,"result":[]})"}) CHECK(!decided(torn).empty());
}

TEST(ScanRow, MissingRowsAreTakenUpOnce) {
  auto memory = memory::Memory::open(folder.path() / memory::k_memory_file);
  SUCCEEDS(memory);
  folder.write("scan-0001/report.json", k_good);
  folder.write("scan-0002/other.txt", "");
  folder.write("notes/report.json", k_good);
  LONGS_EQUAL(1, *take_up_rows(*memory, folder.path()));
  LONGS_EQUAL(0, *take_up_rows(*memory, folder.path()));
  CHECK(memory->scan("scan-0001")->has_value());
  CHECK(!memory->scan("notes")->has_value());
}

TEST(ScanRow, PlacesAreSignedDistancesToTheModelsLine) {
  constexpr int k_points = 720;
  cloud::ClosedLine model, line;
  for (int i = 0; i < k_points; ++i) {
    const double angle = 2 * 3.14159265358979 * i / k_points;
    cloud::LinePoint point{.position = Vec3::Zero(), .normal = Vec3::Zero(), .tangent = Vec3::Zero()};
    point.normal = Vec3{std::cos(angle), std::sin(angle), 0};
    point.position = 100 * point.normal + Vec3{10, 20, 30};
    model.points.push_back(point);
    // Half of it 0.5 mm outside, half 0.2 mm inside.
    point.position = (i < k_points / 2 ? 100.5 : 99.8) * point.normal + Vec3{10, 20, 30};
    line.points.push_back(point);
  }
  const memory::Places places = places_of(line, model);
  // Chords of 0.9 mm on a radius of 100 mm stand off by 0.001 mm.
  for (std::size_t place = 1; place < 17; ++place) DOUBLES_EQUAL(0.5, places[place], 0.002);
  for (std::size_t place = 19; place < 35; ++place) DOUBLES_EQUAL(-0.2, places[place], 0.002);
}

TEST(ScanRow, EachRefusalOfTheServiceHasItsWords) {
  test::check_refusal_table(Refused::SequenceCut);
}

}  // namespace biteline::service
