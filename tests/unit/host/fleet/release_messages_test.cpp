// SPDX-License-Identifier: MIT
#include "host/fleet/release_messages.hpp"

#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "host/records/release/order.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"

namespace biteline::fleet {
namespace {

using Json = nlohmann::ordered_json;
const std::string k_hash(64, 'c');

/// Each field spoiled in turn is refused and named.
template <class Read>
void check_fields(const std::string& text, const Read& read) {
  const Json sound = Json::parse(text);
  for (const auto& [key, value] : sound.items()) {
    Json spoiled = sound;
    spoiled[key] = Json::array({Json::array()});
    const auto result = read(test::text_of(spoiled));
    CHECK_TEXT(!result, key.c_str());
    spoiled.erase(key);
    CHECK_TEXT(!read(test::text_of(spoiled)), key.c_str());
  }
  for (const char* garbage : {"", "{", "[]", "null"}) CHECK_TEXT(!read(std::string{garbage}), garbage);
}

}  // namespace

TEST_GROUP(ReleaseMessages){};

TEST(ReleaseMessages, PlanComesThrough) {
  ReleasePlan plan{.manifest = "biteline-release 1\n", .signature = std::string("\0\xff\x10", 3)};
  CHECK(!read_release_plan(to_text(plan))->turn);
  plan.turn = ReleasePlan::Switch{
      .order = "biteline-switch 1\n", .signature = std::string("\xff\0\x01", 3), .sure = true};
  const auto back = read_release_plan(to_text(plan));
  SUCCEEDS(back);
  CHECK(back->signature == plan.signature);
  STRCMP_EQUAL(plan.manifest.c_str(), back->manifest.c_str());
  STRCMP_EQUAL("biteline-switch 1\n", back->turn->order.c_str());
  CHECK(back->turn->signature == plan.turn->signature);
  CHECK(back->turn->sure);
  check_fields(to_text(plan), read_release_plan);
  Json spoiled = Json::parse(to_text(plan));
  spoiled["signature"] = "0g";
  CHECK(!read_release_plan(test::text_of(spoiled)));
  for (const char* key : {"order", "signature", "sure"}) {
    spoiled = Json::parse(to_text(plan));
    spoiled["switch"].erase(key);
    CHECK_TEXT(!read_release_plan(test::text_of(spoiled)), key);
  }
  spoiled = Json::parse(to_text(plan));
  spoiled["switch"]["order"] = std::string(release::k_most_order_bytes + 1, 'x');
  CHECK(!read_release_plan(test::text_of(spoiled)));
}

TEST(ReleaseMessages, WordAndAskComeThrough) {
  const ReleaseWord word{.has = {k_hash},
                         .current = k_hash,
                         .number = 2,
                         .newest = 3,
                         .refused = 4,
                         .fault = "a fault",
                         .clock_ms = 9};
  const auto back = read_release_word(to_text(word));
  SUCCEEDS(back);
  CHECK(back->has == word.has);
  STRCMP_EQUAL("a fault", back->fault.c_str());
  LONGS_EQUAL(3, back->newest);
  LONGS_EQUAL(4, back->refused);
  check_fields(to_text(word), read_release_word);
  SUCCEEDS(read_release_word(to_text(ReleaseWord{})));
  ReleaseWord many;
  many.has.assign(17, k_hash);
  CHECK(!read_release_word(to_text(many)));
  LONGS_EQUAL(49152, read_part_ask(to_text(PartAsk{.sha256 = k_hash, .at = 49152}))->at);
  check_fields(to_text(PartAsk{.sha256 = k_hash, .at = 0}), read_part_ask);
}

TEST(ReleaseMessages, PartIsALineAndBytes) {
  const Part part{.sha256 = k_hash, .at = 5, .bytes = std::string("\n\0\xff", 3)};
  const auto back = read_part(to_payload(part));
  SUCCEEDS(back);
  CHECK(back->bytes == part.bytes);
  LONGS_EQUAL(5, back->at);
  SUCCEEDS(read_part(to_payload({.sha256 = k_hash, .at = 0, .bytes = std::string(k_part_bytes, 'x')})));
  CHECK(!read_part(to_payload({.sha256 = k_hash, .at = 0, .bytes = std::string(k_part_bytes + 1, 'x')})));
  CHECK(!read_part(""));
  CHECK(!read_part("{}\nbytes"));
  CHECK(!read_part(std::string(300, ' ') + to_payload(part)));
}

}  // namespace biteline::fleet
