// SPDX-License-Identifier: MIT
#include "host/fleet/recording_messages.hpp"

#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>

#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"

namespace biteline::fleet {
namespace {

using Json = nlohmann::ordered_json;
const std::string k_hash(64, 'c');

}  // namespace

TEST_GROUP(RecordingMessages){};

TEST(RecordingMessages, AskComesThroughAndNamesNoOtherFolder) {
  const FetchAsk ask{.number = 3, .book = "b0", .scan = "scan-0007", .at = 98304};
  const auto back = read_fetch_ask(to_text(ask));
  SUCCEEDS(back);
  LONGS_EQUAL(3, back->number);
  LONGS_EQUAL(98304, back->at);
  STRCMP_EQUAL("scan-0007", back->scan.c_str());
  for (const char* scan : {"", "../..", "scan-7", "scan-0007/..", "scan-00000000001", "scan-000x"}) {
    Json json = Json::parse(to_text(ask));
    json["scan"] = scan;
    FAILS_NAMING(Errc::ProtocolError, "scan", read_fetch_ask(test::text_of(json)));
  }
  for (const char* key : {"number", "book", "scan", "at"}) {
    Json json = Json::parse(to_text(ask));
    json[key] = Json::array();
    CHECK_TEXT(!read_fetch_ask(test::text_of(json)), key);
    json.erase(key);
    CHECK_TEXT(!read_fetch_ask(test::text_of(json)), key);
  }
  Json json = Json::parse(to_text(ask));
  json["number"] = 1LL << 31;
  FAILS_NAMING(Errc::ProtocolError, "number", read_fetch_ask(test::text_of(json)));
}

TEST(RecordingMessages, PieceComesThroughWithinItsBounds) {
  Piece piece{
      .number = 3, .at = 5, .total = 9, .sha256 = k_hash, .refused = {}, .bytes = std::string("\0a\nb", 4)};
  const auto back = read_piece(to_payload(piece));
  SUCCEEDS(back);
  CHECK(back->bytes == piece.bytes);
  LONGS_EQUAL(9, back->total);
  piece.total = 8;  // beyond its end
  FAILS_NAMING(Errc::ProtocolError, "total", read_piece(to_payload(piece)));
  piece.total = 9;
  piece.sha256.assign(1, 'x');
  FAILS_NAMING(Errc::ProtocolError, "sha256", read_piece(to_payload(piece)));
  piece.sha256 = k_hash;
  piece.bytes.clear();
  FAILS_NAMING(Errc::ProtocolError, "bytes", read_piece(to_payload(piece)));
  piece.bytes.assign(k_piece_bytes + 1, 'x');
  piece.total = 1 << 20;
  FAILS_NAMING(Errc::ProtocolError, "at most", read_piece(to_payload(piece)));
  FAILS_NAMING(Errc::ProtocolError, "a line", read_piece(std::string(2000, 'x')));
}

TEST(RecordingMessages, RefusalNeedsNoBytes) {
  const auto back = read_piece(to_payload(
      {.number = 1, .at = 0, .total = 0, .sha256 = {}, .refused = std::string(900, '"'), .bytes = {}}));
  SUCCEEDS(back);
  STRCMP_CONTAINS("\"\"", back->refused.c_str());
}

}  // namespace biteline::fleet
