// SPDX-License-Identifier: MIT
#include "host/fleet/messages.hpp"

#include <CppUTest/TestHarness.h>

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
}

TEST(FleetMessages, TextThatIsNoUtf8IsSentCleaned) {
  ShoeMessage shoe = made();
  shoe.scan.reason = "bad \xff\xfe byte";
  shoe.scan.model.assign(1, '\xc3');
  SUCCEEDS(read_shoe(to_text(shoe)));
}

TEST(FleetMessages, FaultNamesTheField) {
  const Json sound = Json::parse(to_text(made()));
  for (const auto& [key, value] : sound.items()) {
    Json spoiled = sound;
    spoiled[key] = Json::array({1});
    const auto read = read_shoe(test::text_of(spoiled));
    CHECK_TEXT(!read, key.c_str());
    STRCMP_CONTAINS(key.c_str(), to_line(read.error()).c_str());
  }
  for (const auto& [key, value] :
       {std::pair{"seq", Json(7)}, std::pair{"seq", Json(-1)}, std::pair{"scan", Json("")},
        std::pair{"model", Json(std::string(300, 'x'))}, std::pair{"length_mm", Json("1")},
        std::pair{"places", Json::array({1, 2})}}) {
    Json spoiled = sound;
    spoiled[key] = value;
    CHECK_TEXT(!read_shoe(test::text_of(spoiled)), key);
  }
  for (const char* text : {"", "{", "[]", "null", "{\"seq\":1e99}"}) CHECK_TEXT(!read_shoe(text), text);
}

TEST(FleetMessages, HealthAndCommittedComeThrough) {
  const auto health =
      read_health(to_text(HealthMessage{.online = true, .version = "1.2", .book = "b", .waiting = 7}));
  SUCCEEDS(health);
  CHECK(health->online);
  LONGS_EQUAL(7, health->waiting);
  SUCCEEDS(read_health(to_text(HealthMessage{})));
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
