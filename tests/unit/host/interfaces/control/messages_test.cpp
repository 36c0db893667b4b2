// SPDX-License-Identifier: MIT
#include "host/interfaces/control/messages.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "tests/support/errors.hpp"
#include "tests/support/fuzz.hpp"

namespace biteline::control {
namespace {

Request whole_request() {
  return {.id = 7,
          .token = "abc",
          .local = true,
          .door = "web",
          .method = "POST",
          .path = "/api/v1/scans/scan-0003/reject",
          .query = {{"limit", "20"}},
          .body = {{"why", "a hole at the toe"}}};
}

}  // namespace

TEST_GROUP(ControlMessages){};

TEST(ControlMessages, RequestComesBackAsItWas) {
  const Request sent = whole_request();
  const auto read = read_from_door(to_text(sent));
  SUCCEEDS(read);
  const auto& got = std::get<Request>(*read);
  LONGS_EQUAL(7, got.id);
  STRCMP_EQUAL("abc", got.token.c_str());
  CHECK(got.local);
  STRCMP_EQUAL("POST", got.method.c_str());
  STRCMP_EQUAL("/api/v1/scans/scan-0003/reject", got.path.c_str());
  STRCMP_EQUAL("20", got.query.at("limit").c_str());
  STRCMP_EQUAL("a hole at the toe", got.body["why"].get<std::string>().c_str());
}

TEST(ControlMessages, AnswerAndEventComeBackAsTheyWere) {
  const auto answer = read_from_service(to_text(Answer{.id = 9, .status = 404, .body = {{"a", 1}}}));
  SUCCEEDS(answer);
  LONGS_EQUAL(404, std::get<Answer>(*answer).status);
  LONGS_EQUAL(9, std::get<Answer>(*answer).id);
  const auto event =
      read_from_service(to_text(Event{.name = "scan", .data = {{"name", "x"}}, .seq = 3, .time = utc_now()}));
  SUCCEEDS(event);
  LONGS_EQUAL(3, std::get<Event>(*event).seq);
  STRCMP_EQUAL("x", std::get<Event>(*event).data["name"].get<std::string>().c_str());
}

TEST(ControlMessages, WhatIsWrongIsNamedByItsField) {
  const struct {
    const char* text;
    const char* named;
  } k_cases[] = {
      {"", "JSON object"},
      {"[]", "JSON object"},
      {"{\"id\":-1,\"method\":\"GET\",\"path\":\"/\"}", "id"},
      {"{\"id\":1e3,\"method\":\"GET\",\"path\":\"/\"}", "id"},
      {"{\"id\":1,\"method\":5,\"path\":\"/\"}", "method"},
      {"{\"id\":1,\"path\":\"/\"}", "method"},
      {"{\"id\":1,\"method\":\"GET\",\"path\":\"x\"}", "path"},
      {"{\"id\":1,\"method\":\"GET\",\"path\":\"/a\\u0007\"}", "path"},
      {"{\"id\":1,\"method\":\"GET\",\"path\":\"/\",\"local\":1}", "local"},
      {"{\"id\":1,\"method\":\"GET\",\"path\":\"/\",\"query\":{\"a\":1}}", "query"},
      {"{\"id\":1,\"method\":\"GET\",\"path\":\"/\",\"query\":[1]}", "query"},
      {"{\"hello\":7}", "hello"},
  };
  for (const auto& row : k_cases) FAILS_NAMING(Errc::ProtocolError, row.named, read_from_door(row.text));
}

TEST(ControlMessages, DepthAndLengthAreBounded) {
  const auto nested = [](int depth) {
    return "{\"id\":1,\"method\":\"GET\",\"path\":\"/\",\"body\":" +
           std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']') + "}";
  };
  SUCCEEDS(read_from_door(nested(k_most_depth - 1)));
  FAILS_NAMING(Errc::ProtocolError, "JSON object", read_from_door(nested(k_most_depth)));
  FAILS_NAMING(Errc::ProtocolError, "JSON object", read_from_door(nested(200'000)));
  // Brackets in a text are no depth.
  Request request = whole_request();
  request.body = std::string(1000, '[') + "\"\\";
  SUCCEEDS(read_from_door(to_text(request)));
  request.body = std::string(k_most_message_bytes, 'a');
  FAILS_NAMING(Errc::ProtocolError, "at most", read_from_door(to_text(request)));
}

TEST(ControlMessages, TheIdOfWhatIsRefusedIsReadFromItsBeginAlone) {
  Request request;
  request.id = 18446744073709551615U;
  CHECK(request.id == id_of_refused(to_text(request)));
  for (const char* text : {"", "{", R"({"id":)", R"({"id":7)", R"({"id":-7,)", R"({"id":"7",)",
                           R"({"id":7.5,)", R"({"hello":"web"})", R"({"id":18446744073709551616,)"})
    CHECK_TEXT(id_of_refused(text) == 0, text);
}

TEST(ControlMessages, GarbledMessagesAreRefusedOrRead) {
  std::mt19937_64 random{42};
  const std::string whole = to_text(whole_request());
  int refused = 0;
  for (int i = 0; i < 10'000 * test::fuzz_factor(); ++i) {
    std::vector<std::uint8_t> bytes{whole.begin(), whole.end()};
    test::garble(bytes, random);
    const std::string text{bytes.begin(), bytes.end()};
    if (!read_from_door(text)) ++refused;
    static_cast<void>(read_from_service(text));
  }
  CHECK(refused > 1000);  // most garbled bytes leave no JSON
}

}  // namespace biteline::control
