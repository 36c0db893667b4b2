// SPDX-License-Identifier: MIT
// What is mounted is taught at a page: touches, numbers, versions.
#include <CppUTest/TestHarness.h>

#include <cmath>

#include "host/records/mounted/mounted_record.hpp"
#include "tests/support/json.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

TEST_GROUP_BASE(ApiMounted, ApiWorld) {
  const Vec3 tip{0, 0, 180};

  void take_control_as(const std::string& name) {
    log_in(name);
    LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}, {"why", "to teach"}}).status);
  }
  /// The arm's tip at `place`, the flange leaning to one of all sides.
  control::Answer touch(const char* part, const Vec3& place, int side) {
    const double around_rad = 2.4 * side;
    SE3& T = cell.look.T_base_flange;
    T.linear() = geometry::exp_so3(0.5 * Vec3{std::cos(around_rad), std::sin(around_rad), 0.3});
    T.translation() = place - T.linear() * tip;
    return ask("POST", "/mounted/touches", {{"part", part}});
  }
  void teach_tip() {
    for (int side = 0; side < 5; ++side) LONGS_EQUAL(200, touch("tip", {400, 0, 50}, side).status);
    LONGS_EQUAL(200, ask("PUT", "/mounted/tip").status);
  }
};

TEST(ApiMounted, AnEngineerInControlTeachesTheTip) {
  log_in("ana");
  LONGS_EQUAL(200, ask("GET", "/mounted").status);
  LONGS_EQUAL(403, ask("POST", "/mounted/touches", {{"part", "tip"}}).status);
  LONGS_EQUAL(403, ask("PUT", "/mounted/payload").status);
  log_in("eng");
  STRCMP_EQUAL("control_needed", code_of(touch("tip", {400, 0, 50}, 0)).c_str());
  take_control_as("eng");
  STRCMP_EQUAL("wrong_state", code_of(ask("PUT", "/mounted/tip")).c_str());
  Json lesson = touch("tip", {400, 0, 50}, 0).body["lesson"];
  LONGS_EQUAL(1, lesson["touches"].get<int>());
  CHECK(lesson["at_mm"].is_null());
  STRCMP_CONTAINS("at least 4", lesson["missing"].get<std::string>().c_str());
  STRCMP_EQUAL("wrong_state", code_of(ask("PUT", "/mounted/tip")).c_str());
  // The arm was not moved.
  LONGS_EQUAL(409, touch("tip", {400, 0, 50}, 0).status);
  for (int side = 1; side < 5; ++side) lesson = touch("tip", {400, 0, 50}, side).body["lesson"];
  CHECK(lesson["missing"].is_null());
  DOUBLES_EQUAL(180, lesson["at_mm"][2].get<double>(), 1e-6);
  const control::Answer kept = ask("PUT", "/mounted/tip");
  LONGS_EQUAL(200, kept.status);
  STRCMP_EQUAL("eng", kept.body["tip"]["who"].get<std::string>().c_str());
  LONGS_EQUAL(5, kept.body["tip"]["touches"].get<int>());
  CHECK(kept.body["lesson"].is_null());
  DOUBLES_EQUAL(180, mounted::read_record(*memory)->tip->tip_flange.z(), 1e-6);
}

TEST(ApiMounted, TheTableIsTouchedWithATipThatIsKnown) {
  take_control_as("eng");
  STRCMP_EQUAL("wrong_state", code_of(touch("table", {400, -200, -12}, 0)).c_str());
  teach_tip();
  LONGS_EQUAL(200, touch("table", {400, -200, -12}, 0).status);
  LONGS_EQUAL(200, touch("table", {400, 200, -12.2}, 1).status);
  // A touch that slipped is taken back.
  LONGS_EQUAL(200, touch("table", {700, 0, 3}, 2).status);
  STRCMP_CONTAINS("touch 3", ask("GET", "/mounted").body["lesson"]["missing"].get<std::string>().c_str());
  LONGS_EQUAL(2, ask("POST", "/mounted/touches", {{"part", "table"}, {"take_back", true}})
                     .body["lesson"]["touches"]
                     .get<int>());
  LONGS_EQUAL(200, touch("table", {700, 0, -12.1}, 2).status);
  const control::Answer kept = ask("PUT", "/mounted/table");
  LONGS_EQUAL(200, kept.status);
  DOUBLES_EQUAL(-12.1, kept.body["table"]["z_mm"].get<double>(), 1e-6);
  LONGS_EQUAL(2, kept.body["version"].get<int>());
}

TEST(ApiMounted, ATouchThatTheArmIsAskedForTooLateDoesNotCount) {
  take_control_as("eng");
  LONGS_EQUAL(200, touch("tip", {400, 0, 50}, 0).status);
  control::Request late;
  late.token = token;
  late.method = "POST";
  late.path = "/api/v1/mounted/touches";
  late.body = {{"part", "tip"}};
  late.heard -= std::chrono::seconds{5};  // others' work came first
  cell.look.T_base_flange.translation().x() += 10;
  const control::Answer answer = sut.ordinary(late);
  STRCMP_EQUAL("wrong_state", code_of(answer).c_str());
  STRCMP_CONTAINS("touch again", test::text_of(answer.body).c_str());
  LONGS_EQUAL(1, ask("GET", "/mounted").body["lesson"]["touches"].get<int>());
}

TEST(ApiMounted, ATableTellsWhichTipTouchedIt) {
  take_control_as("eng");
  teach_tip();
  for (const auto& [place, side] :
       {std::pair{Vec3{400, -200, -12}, 0}, {Vec3{400, 200, -12}, 1}, {Vec3{700, 0, -12}, 2}})
    LONGS_EQUAL(200, touch("table", place, side).status);
  const Json kept = ask("PUT", "/mounted/table").body;
  LONGS_EQUAL(kept["tip"]["version"].get<int>(), kept["table"]["tip_version"].get<int>());
  teach_tip();
  const Json anew = ask("GET", "/mounted").body;
  CHECK(anew["tip"]["version"].get<int>() != anew["table"]["tip_version"].get<int>());
}

TEST(ApiMounted, LinesAreOfTheMountedToolAndWholeNumbers) {
  take_control_as("eng");
  const Json lines{{"on_output", 1}, {"ask_output", 4}, {"there_input", 2}};
  STRCMP_EQUAL("wrong_state", code_of(ask("PUT", "/mounted/lines", lines)).c_str());
  LONGS_EQUAL(200, ask("PUT", "/mounted/tool", {{"name", "gun"}}).status);
  for (const Json& body : {Json{{"ask_output", 4}}, Json{{"there_input", 2}}, Json{{"on_output", 8}},
                           Json{{"on_output", 1.5}}, Json{{"on_output", "1"}}, Json{{"on_input", 1}}})
    LONGS_EQUAL_TEXT(400, ask("PUT", "/mounted/lines", body).status, test::text_of(body).c_str());
  const Json kept = ask("PUT", "/mounted/lines", lines).body;
  LONGS_EQUAL(4, kept["lines"].value("ask_output", -1));
  STRCMP_EQUAL("eng", kept["lines"].value("who", "").c_str());
  CHECK(kept["wear"].is_object() && kept["wear"].empty() && kept["renewed"].is_null());
  LONGS_EQUAL(200, ask("PUT", "/mounted/renewed").status);
  LONGS_EQUAL(200, ask("PUT", "/mounted/tool", {{"name", "brush"}}).status);
  const Json shelf = ask("GET", "/mounted").body["shelf"]["gun"];
  LONGS_EQUAL(2, shelf["lines"].value("there_input", -1));
  CHECK(shelf["renewed"].is_object());
}

TEST(ApiMounted, ThePayloadIsTakenInItsRangeAndComparedWithTheControllers) {
  take_control_as("eng");
  const Json centre = Json::array({0, 0, 65});
  for (const Json& body :
       {Json::object(), Json{{"kg", 21}, {"centre_mm", centre}}, Json{{"kg", "1"}, {"centre_mm", centre}},
        Json{{"kg", 1}, {"centre_mm", Json::array({0, 0})}},
        Json{{"kg", 1}, {"centre_mm", Json::array({0, 0, 2000})}},
        Json{{"kg", 1}, {"centre_mm", Json::array({0, 0, nullptr})}},
        Json{{"kg", 1}, {"centre_mm", centre}, {"g", 9.81}}}) {
    LONGS_EQUAL_TEXT(400, ask("PUT", "/mounted/payload", body).status, test::text_of(body).c_str());
  }
  CHECK(ask("GET", "/mounted").body["payload"].is_null());
  cell.look.payload = path::Payload{.mass_kg = 1.62, .centre_flange_mm = {0, 0, 60}};
  Json told = ask("PUT", "/mounted/payload", {{"kg", 1.6}, {"centre_mm", centre}}).body;
  DOUBLES_EQUAL(1.6, told["payload"]["kg"].get<double>(), 1e-12);
  CHECK(told["controller"]["carries_as_taught"].get<bool>());
  cell.look.payload->mass_kg = 0;
  told = ask("PUT", "/mounted/payload", {{"kg", 1.6}, {"centre_mm", centre}}).body;
  CHECK(!told["controller"]["carries_as_taught"].get<bool>());
  // A controller that is away costs the comparison and nothing else.
  cell.next = fail(Errc::ConnectFailed, "127.0.0.1:30004");
  told = ask("PUT", "/mounted/payload", {{"kg", 1.5}, {"centre_mm", centre}}).body;
  CHECK(told["controller"].is_null());
  LONGS_EQUAL(3, told["version"].get<int>());
}

TEST(ApiMounted, WhatIsForgottenIsGoneAndOtherPartsAreNone) {
  take_control_as("eng");
  teach_tip();
  CHECK(ask("DELETE", "/mounted/tip").body["tip"].is_null());
  LONGS_EQUAL(404, ask("DELETE", "/mounted/wheel").status);
  LONGS_EQUAL(404, ask("PUT", "/mounted/wheel").status);
  LONGS_EQUAL(400, ask("POST", "/mounted/touches", {{"part", "wheel"}}).status);
  const auto rows = memory->log_rows(0, 1);
  SUCCEEDS(rows);
  STRCMP_EQUAL("forget what was taught", rows->front().action.c_str());
}

TEST(ApiMounted, AnOperatorSaysWhichToolIsMounted) {
  take_control_as("eng");
  teach_tip();
  LONGS_EQUAL(200, ask("PUT", "/mounted/tool", {{"name", "brush"}}).status);
  STRCMP_EQUAL("tool mounted", cell.did.back().c_str());
  take_control_as("ana");
  const Json gun = ask("PUT", "/mounted/tool", {{"name", "gun"}}).body;
  STRCMP_EQUAL("gun", gun["tool"]["name"].get<std::string>().c_str());
  STRCMP_EQUAL("ana", gun["tool"]["who"].get<std::string>().c_str());
  // Nothing was taught of it yet; the brush's tip waits for the brush.
  CHECK(gun["tip"].is_null());
  DOUBLES_EQUAL(180, gun["shelf"]["brush"]["tip"]["at_mm"][2].get<double>(), 1e-6);
  const Json brush = ask("PUT", "/mounted/tool", {{"name", "brush"}}).body;
  DOUBLES_EQUAL(180, brush["tip"]["at_mm"][2].get<double>(), 1e-6);
  CHECK(brush["shelf"].contains("gun") && !brush["shelf"].contains("brush"));
  for (const char* bad : {"", "../x", "a b"})
    CHECK_TEXT(ask("PUT", "/mounted/tool", {{"name", bad}}).status >= 400, bad);
  const Json none = ask("DELETE", "/mounted/tool").body;
  CHECK(none["tool"].is_null() && none["tip"].is_null() && none["shelf"].contains("brush"));
}

TEST(ApiMounted, AnArmThatMovesOrIsAwayIsToldAndNoTouch) {
  take_control_as("eng");
  cell.next = fail(Errc::WrongState, "the arm still moves; touch when it stands");
  LONGS_EQUAL(409, touch("tip", {400, 0, 50}, 0).status);
  cell.next = fail(Errc::ConnectFailed, "127.0.0.1:30004");
  const Answer away = touch("tip", {400, 0, 50}, 0);
  LONGS_EQUAL(409, away.status);
  STRCMP_EQUAL("wrong_state", away.body["error"]["code"].get<std::string>().c_str());
  CHECK(ask("GET", "/mounted").body["lesson"].is_null());
  cell.next = {};
  LONGS_EQUAL(200, touch("tip", {400, 0, 50}, 0).status);
  CHECK(ask("DELETE", "/mounted/touches").body["lesson"].is_null());
}

}  // namespace biteline::api
