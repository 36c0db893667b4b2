// SPDX-License-Identifier: MIT
#include "host/fleet/messages.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"

namespace biteline::fleet {
namespace {

using Json = nlohmann::ordered_json;

ShoeMessage made() {
  ShoeMessage shoe{.book = "0123abcd", .seq = 8, .after = 7, .scan = {}, .places = memory::Places{}};
  shoe.scan.name = "scan-0007";
  shoe.scan.time = 1'795'000'000'123;
  shoe.scan.model = "boot";
  shoe.scan.verdict = "refused";
  shoe.scan.part = "A-17";
  shoe.scan.follows = "scan-0041";
  shoe.scan.work = {.verdict = "faulty",
                    .reworked = true,
                    .missing_mm = 6.5,
                    .narrow = 1,
                    .wide = 2,
                    .beside = 3,
                    .doubled = 4};
  shoe.scan.foot = "left";
  shoe.scan.size = "EU 42";
  shoe.scan.reason_code = "too_short";
  shoe.scan.reason = "a \"quoted\" reason, ü";
  shoe.scan.length_mm = 801.25;
  shoe.scan.followed = true;
  shoe.places->at(35) = -0.125F;
  return shoe;
}

}  // namespace

TEST_GROUP(FleetMessages){};

TEST(FleetMessages, ShoeComesThroughUnchanged) {
  const auto back = read_shoe(to_text(made()));
  SUCCEEDS(back);
  LONGS_EQUAL(8, back->seq);
  LONGS_EQUAL(7, back->after);
  STRCMP_EQUAL("scan-0007", back->scan.name.c_str());
  STRCMP_EQUAL(made().scan.reason.c_str(), back->scan.reason.c_str());
  CHECK(back->scan.time == made().scan.time);
  CHECK(back->scan.length_mm == made().scan.length_mm);
  CHECK(!back->scan.u95_mm.has_value());
  CHECK(back->scan.followed.value_or(false));
  CHECK(back->places == made().places);
  STRCMP_EQUAL("A-17", back->scan.part.c_str());
  STRCMP_EQUAL("left", back->scan.foot.c_str());
  STRCMP_EQUAL("EU 42", back->scan.size.c_str());
  STRCMP_EQUAL("scan-0041", back->scan.follows.c_str());
  CHECK(back->scan.work == made().scan.work);
}

TEST(FleetMessages, TextThatIsNoUtf8IsSentCleaned) {
  ShoeMessage shoe = made();
  shoe.scan.reason = "bad \xff\xfe byte";
  shoe.scan.model.assign(1, '\xc3');
  SUCCEEDS(read_shoe(to_text(shoe)));
}

TEST(FleetMessages, WhateverAMemoryHoldsTheCentreReadsItWhole) {
  const std::string odd[] = {"",
                             std::string(300, 'p'),
                             std::string(100'000, 'p'),
                             "two\nlines\r\n",
                             "\x1b[31mred\x1b[0m",
                             "</script><img src=x>",
                             "bad \xff\xfe byte",
                             "cut \xC3",
                             std::string{"a\0b", 3},
                             std::string(70'000, '\xff')};
  const double numbers[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, -0.0};
  for (const std::string& text : odd) {
    for (const double number : numbers) {
      ShoeMessage shoe = made();
      memory::Scan& scan = shoe.scan;
      for (std::string* one : {&scan.name, &scan.model, &scan.verdict, &scan.reason_code, &scan.reason,
                               &scan.process, &scan.decision, &shoe.release, &scan.part, &scan.foot,
                               &scan.size, &scan.follows, &scan.work.verdict})
        *one = text;
      scan.length_mm = scan.confidence = scan.u95_mm = scan.cycle_s = number;
      scan.time = std::isinf(number) ? std::numeric_limits<std::int64_t>::max() : -1;
      shoe.places->at(3) = std::isinf(number) ? HUGE_VALF : std::nanf("");
      const std::string sent = to_text(shoe);
      CHECK(sent.size() < 8000);
      const auto back = read_shoe(sent);
      SUCCEEDS(back);
      STRCMP_EQUAL("", back->fault.c_str());
      CHECK(!back->scan.name.empty());
    }
  }
}

TEST(FleetMessages, WhatIsCutSaysSo) {
  ShoeMessage shoe = made();
  shoe.scan.process = std::string(300, 'p');
  const auto back = read_shoe(to_text(shoe));
  SUCCEEDS(back);
  LONGS_EQUAL(200, back->scan.process.size());
  CHECK(back->scan.process.ends_with("..."));
}

TEST(FleetMessages, FaultNamesTheFieldAndTheRestStands) {
  const Json sound = Json::parse(to_text(made()));
  for (const auto& [key, value] : sound.items()) {
    for (const bool missing : {false, true}) {
      Json spoiled = sound;
      spoiled[key] = Json::array({1});
      if (missing) spoiled.erase(key);
      const auto read = read_shoe(test::text_of(spoiled));
      if (key == "book" || key == "seq" || key == "after") {
        CHECK_TEXT(!read, key.c_str());
        STRCMP_CONTAINS(key.c_str(), to_line(read.error()).c_str());
        continue;
      }
      SUCCEEDS(read);
      // Older cells name no release, not whose shoe it was, and nothing of its work.
      const bool told_later = key == "release" || key == "part" || key == "foot" || key == "size" ||
                              key == "follows" || key == "work";
      const bool older =
          missing && (told_later || key == "places" || value.is_null() || value.is_number_float());
      if (!older) STRCMP_CONTAINS(key.c_str(), read->fault.c_str());
      LONGS_EQUAL(8, read->seq);
      LONGS_EQUAL(7, read->after);
      if (key != "reason") STRCMP_EQUAL(made().scan.reason.c_str(), read->scan.reason.c_str());
      if (key != "model") STRCMP_EQUAL("boot", read->scan.model.c_str());
      CHECK(!read->scan.verdict.empty());
      CHECK(!read->scan.decision.empty());
    }
  }
  for (const auto& [key, value] :
       {std::pair{"scan", Json("")}, std::pair{"model", Json(std::string(300, 'x'))},
        std::pair{"process", Json(std::string(100'000, 'x'))}, std::pair{"length_mm", Json("1")},
        std::pair{"places", Json::array({1, 2})}}) {
    Json spoiled = sound;
    spoiled[key] = value;
    const auto read = read_shoe(test::text_of(spoiled));
    SUCCEEDS(read);
    STRCMP_CONTAINS(key, read->fault.c_str());
  }
  for (const auto& [key, value] :
       {std::pair{"seq", Json(7)}, std::pair{"seq", Json(-1)}, std::pair{"book", Json("")}}) {
    Json spoiled = sound;
    spoiled[key] = value;
    CHECK_TEXT(!read_shoe(test::text_of(spoiled)), key);
  }
  for (const char* text : {"", "{", "[]", "null", "{\"seq\":1e99}"}) CHECK_TEXT(!read_shoe(text), text);
}

TEST(FleetMessages, WhatIsNoJsonIsPlacedByItsNumbers) {
  const std::string sound = to_text(made());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = sound;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string deep(2000, '[');
  for (const std::string& text :
       {with("801.25", "NaN"), with("boot", "bo\xffot"), with("boot", "bo\not"),
        with("boot", std::string(600'000, 'x')), with("\"places\":[", "\"places\":" + deep),
        sound.substr(0, sound.size() / 2)}) {
    const auto read = read_shoe(text);
    SUCCEEDS(read);
    STRCMP_EQUAL("0123abcd", read->book.c_str());
    LONGS_EQUAL(8, read->seq);
    LONGS_EQUAL(7, read->after);
    STRCMP_EQUAL("row-8", read->scan.name.c_str());
    STRCMP_EQUAL("unread", read->scan.verdict.c_str());
    CHECK(!read->fault.empty());
  }
  for (const char* text :
       {R"({"book":"b","seq":1)", R"({"book":"b","seq":1,"after":1,)", R"({"book":"","seq":2,"after":1,)",
        R"({"book":b,"seq":2,"after":1,)", R"({"seq":2,"after":1,)"})
    CHECK_TEXT(!read_shoe(text), text);
}

TEST(FleetMessages, ACellsOwnStubIsADeadLetterToo) {
  const auto read = read_shoe(to_text(bare_of(made(), "in vain")));
  SUCCEEDS(read);
  LONGS_EQUAL(8, read->seq);
  LONGS_EQUAL(7, read->after);
  CHECK(!read->fault.empty());
  CHECK(read->scan.model.empty());
}

TEST(FleetMessages, DeadLettersComeBackToTheCell) {
  CommittedMessage word{.book = "b", .seq = 12, .dead = 30, .held = "later"};
  for (std::int64_t seq = 1; seq <= 20; ++seq)
    word.letters.push_back({.seq = seq, .scan = "scan-0001", .why = std::string(seq * 30, 'w')});
  const auto back = read_committed(to_text(word));
  SUCCEEDS(back);
  LONGS_EQUAL(30, back->dead);
  LONGS_EQUAL(20, back->letters.size());
  CHECK(back->letters[2] == word.letters[2]);
  STRCMP_EQUAL("later", back->held.c_str());
  const auto old = read_committed(R"({"book":"b","seq":12})");
  SUCCEEDS(old);
  CHECK(old->letters.empty() && old->held.empty());
  CHECK(!read_committed(R"({"book":"b","seq":12,"dead":1,"letters":[1]})"));
  CHECK(!read_committed(R"({"book":"b","seq":12,"dead":1,"letters":7})"));
}

TEST(FleetMessages, NoCellIsCalledAsTheCentre) {
  CHECK(is_reserved_name("fleet"));
  CHECK(is_reserved_name("host"));
  CHECK(!is_reserved_name("cell-1"));
}

TEST(FleetMessages, HealthAndCommittedComeThrough) {
  const auto health =
      read_health(to_text(HealthMessage{.online = true, .version = "1.2", .book = "b", .waiting = 7}));
  SUCCEEDS(health);
  CHECK(health->online);
  LONGS_EQUAL(7, health->waiting);
  LONGS_EQUAL(0, health->log.row);
  SUCCEEDS(read_health(to_text(HealthMessage{})));
  const memory::LogLink link{.row = 12, .link = std::string(64, 'a')};
  const auto told =
      read_health(to_text(HealthMessage{.online = true, .version = "1.2", .book = "b", .log = link}));
  SUCCEEDS(told);
  CHECK(told->log == link);
  for (const char* wrong : {"short", "", "\u0000"})
    CHECK_TEXT(
        !read_health(R"({"online":true,"version":"1","book":"b","waiting":0,"log_row":3,"log_link":")" +
                     std::string{wrong} + "\"}"),
        wrong);
  CHECK(!read_health("{}"));
  const auto committed = read_committed(to_text(CommittedMessage{.book = "b", .seq = 12}));
  SUCCEEDS(committed);
  LONGS_EQUAL(12, committed->seq);
  CHECK(!read_committed(R"({"book":"b","seq":-1})"));
}

TEST(FleetMessages, TopicNamesItsCellAndNothingElse) {
  STRCMP_EQUAL("cell-3", cell_of(shoes_topic("cell-3"), "shoes").value_or("").c_str());
  STRCMP_EQUAL("a", cell_of(health_topic("a"), "health").value_or("").c_str());
  for (const char* topic : {"biteline/1/cells//shoes", "biteline/1/cells/a/b/shoes", "biteline/1/cells/shoes",
                            "biteline/1/cells/a/xshoes", "biteline/2/cells/a/shoes", "shoes", ""})
    CHECK_TEXT(!cell_of(topic, "shoes"), topic);
  for (const char* name : {"", "a/b", "a+", "#", "a b", "ä"}) CHECK_TEXT(!is_cell_name(name), name);
}

}  // namespace biteline::fleet
