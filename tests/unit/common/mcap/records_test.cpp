// SPDX-License-Identifier: MIT
#include "common/mcap/records.hpp"

#include <CppUTest/TestHarness.h>

#include "common/mcap/chunk.hpp"
#include "tests/support/errors.hpp"

namespace biteline::mcap {

TEST_GROUP(McapRecords){template <class Record> static Bytes bytes_of(const Record& record){Bytes bytes;
append_record(record, bytes);
return bytes;
}  // namespace biteline::mcap
static View content_of(const Bytes& bytes) {
  return View{bytes}.subspan(k_record_head_bytes);
}
}
;

// The check value of CRC-32/ISO-HDLC, which the specification names by its polynomial.
TEST(McapRecords, CheckSumIsThatOfTheSpecification) {
  const std::string text = "123456789";
  const View bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  LONGS_EQUAL(0xCBF43926, crc32(bytes));
  LONGS_EQUAL(0xCBF43926, crc32(bytes.subspan(4), crc32(bytes.first(4))));
}

TEST(McapRecords, ChannelHasTheBytesOfTheSpecification) {
  const Bytes bytes = bytes_of(
      Channel{.id = 2, .schema_id = 1, .topic = "/p", .message_encoding = "json", .metadata = {{"k", "v"}}});
  const Bytes expected{4,  36, 0, 0, 0,   0,   0,   0,   0,                      // opcode, length
                       2,  0,  1, 0,                                             // id, schema's id
                       2,  0,  0, 0, '/', 'p',                                   // topic
                       4,  0,  0, 0, 'j', 's', 'o', 'n',                         // message encoding
                       10, 0,  0, 0, 1,   0,   0,   0,   'k', 1, 0, 0, 0, 'v'};  // map
  CHECK(Bytes(expected.begin() + 9, expected.end()) == Bytes(bytes.begin() + 9, bytes.end()));
  LONGS_EQUAL(expected.size() - 9, bytes[1]);
}

TEST(McapRecords, CutRecordIsRefusedAndALongerOneRead) {
  const Bytes bytes = bytes_of(Statistics{.messages = 7,
                                          .schemas = 1,
                                          .channels = 2,
                                          .attachments = 0,
                                          .metadata = 0,
                                          .chunks = 3,
                                          .start_time_ns = 5,
                                          .end_time_ns = 9,
                                          .messages_of_channel = {{1, 3}, {2, 4}}});
  const View content = content_of(bytes);
  for (std::size_t size = 0; size < content.size(); ++size)
    FAILS_NAMING(Errc::BadFormat, "statistics", parse<Statistics>(content.first(size)));
  Bytes longer(content.begin(), content.end());
  longer.push_back(1);
  const auto parsed = parse<Statistics>(longer);
  SUCCEEDS(parsed);
  LONGS_EQUAL(4, parsed->messages_of_channel.at(2));
}

TEST(McapRecords, MapThatIsLongerThanItsRecordIsRefused) {
  Bytes bytes = bytes_of(Metadata{.name = "n", .values = {{"k", "v"}}});
  bytes[k_record_head_bytes + 5] = 0xFF;  // the map's length
  FAILS_NAMING(Errc::BadFormat, "metadata", parse<Metadata>(content_of(bytes)));
}

TEST(McapRecords, ChunkThatClaimsMoreThanIsReadIsRefusedUnopened) {
  const Bytes few{1, 2, 3};
  FAILS_NAMING(Errc::BadFormat, "at most",
               unpack({.start_time_ns = 0,
                       .end_time_ns = 0,
                       .uncompressed_bytes = k_most_chunk_bytes + 1,
                       .uncompressed_crc = 0,
                       .compression = "zstd",
                       .records = few}));
}

TEST(McapRecords, CompressionThatIsNotKnownIsNamed) {
  FAILS_NAMING(Errc::NotSupported, "'lz4'",
               unpack({.start_time_ns = 0,
                       .end_time_ns = 0,
                       .uncompressed_bytes = 0,
                       .uncompressed_crc = 0,
                       .compression = "lz4",
                       .records = {}}));
}

}  // namespace biteline::mcap
