// SPDX-License-Identifier: MIT
// Records that are longer than this version's: a later version adds fields at their ends.
#include <set>

#include "common/mcap/reader.hpp"
#include "common/mcap/verify.hpp"
#include "tests/unit/common/mcap/made_file.hpp"

namespace biteline::mcap {
namespace {

/// A file of one chunk, one attachment and one metadata record, with indexes and sums, whose records of some
/// kinds have bytes behind their last field.
class LongerFile {
 public:
  explicit LongerFile(std::set<Opcode> longer, std::size_t by) : longer_{std::move(longer)}, by_{by} {
    bytes_.assign(k_magic.begin(), k_magic.end());
    add(Header{.profile = "", .library = "test"});
    const Schema schema{.id = 1, .name = "Pose", .encoding = "", .data = "{}"};
    const Channel channel{
        .id = 1, .schema_id = 1, .topic = "/pose", .message_encoding = "json", .metadata = {}};
    add_chunk(schema, channel);
    add_attachment();
    const std::size_t metadata_at = bytes_.size();
    add(Metadata{.name = "build", .values = {{"version", "1"}}});
    const MetadataIndex metadata_index{
        .offset = metadata_at, .record_bytes = bytes_.size() - metadata_at, .name = "build"};
    add(DataEnd{.data_crc = crc32(bytes_)});
    const std::size_t summary = bytes_.size();
    add(schema);
    add(channel);
    add(Statistics{.messages = 1,
                   .schemas = 1,
                   .channels = 1,
                   .attachments = 1,
                   .metadata = 1,
                   .chunks = 1,
                   .start_time_ns = 7,
                   .end_time_ns = 7,
                   .messages_of_channel = {{1, 1}}});
    const std::size_t indexes = bytes_.size();
    add(chunk_index_);
    const std::size_t indexes_end = bytes_.size();
    add(attachment_index_);
    add(metadata_index);
    const std::size_t offsets = bytes_.size();
    add(SummaryOffset{.group_opcode = static_cast<std::uint8_t>(Opcode::ChunkIndex),
                      .group_start = indexes,
                      .group_bytes = indexes_end - indexes});
    add_footer(summary, offsets);
    bytes_.insert(bytes_.end(), k_magic.begin(), k_magic.end());
  }
  [[nodiscard]] std::string text() const { return {bytes_.begin(), bytes_.end()}; }

 private:
  /// The record's length is told in the eight bytes behind its opcode.
  template <class Record>
  void add_to(Bytes& out, const Record& record) const {
    const std::size_t at = out.size();
    append_record(record, out);
    if (!longer_.contains(Record::k_opcode)) return;
    out.insert(out.end(), by_, std::uint8_t{0xA5});
    const std::uint64_t length = out.size() - at - k_record_head_bytes;
    for (std::size_t i = 0; i < 8; ++i) out[at + 1 + i] = static_cast<std::uint8_t>(length >> (8 * i));
  }
  template <class Record>
  void add(const Record& record) {
    add_to(bytes_, record);
  }
  void add_chunk(const Schema& schema, const Channel& channel) {
    Bytes records;
    add_to(records, schema);
    add_to(records, channel);
    const std::size_t message_at = records.size();
    const std::string said = "said";
    append_record(Message{.channel_id = 1, .log_time_ns = 7, .publish_time_ns = 7, .data = view(said)},
                  records);
    const std::size_t at = bytes_.size();
    add(Chunk{.start_time_ns = 7,
              .end_time_ns = 7,
              .uncompressed_bytes = records.size(),
              .uncompressed_crc = crc32(records),
              .compression = "",
              .records = records});
    const std::size_t index_at = bytes_.size();
    add(MessageIndex{.channel_id = 1, .entries = {{7, message_at}}});
    chunk_index_ = {.start_time_ns = 7,
                    .end_time_ns = 7,
                    .chunk_start = at,
                    .chunk_bytes = index_at - at,
                    .message_index_offsets = {{1, index_at}},
                    .message_index_bytes = bytes_.size() - index_at,
                    .compression = "",
                    .compressed_bytes = records.size(),
                    .uncompressed_bytes = records.size()};
  }
  void add_attachment() {
    const std::string data = "rate_hz: 25\n";
    Attachment attachment{.log_time_ns = 1,
                          .create_time_ns = 2,
                          .name = "settings.yaml",
                          .media_type = "text/yaml",
                          .data = view(data),
                          .crc = 0};
    Bytes plain;
    append_record(attachment, plain);
    attachment.crc = crc32(View{plain}.subspan(k_record_head_bytes, plain.size() - k_record_head_bytes - 4));
    const std::size_t at = bytes_.size();
    add(attachment);
    attachment_index_ = {.offset = at,
                         .record_bytes = bytes_.size() - at,
                         .log_time_ns = 1,
                         .create_time_ns = 2,
                         .data_bytes = data.size(),
                         .name = "settings.yaml",
                         .media_type = "text/yaml"};
  }
  /// Its sum covers its own head and places, so its length counts, too.
  void add_footer(std::size_t summary, std::size_t offsets) {
    Bytes record;
    add_to(record, Footer{.summary_start = summary, .summary_offset_start = offsets, .summary_crc = 0});
    constexpr std::size_t k_sum_at = k_record_head_bytes + 16;
    const std::uint32_t sum = crc32(View{record}.first(k_sum_at), crc32(View{bytes_}.subspan(summary)));
    for (std::size_t i = 0; i < 4; ++i) record[k_sum_at + i] = static_cast<std::uint8_t>(sum >> (8 * i));
    bytes_.insert(bytes_.end(), record.begin(), record.end());
  }

  std::set<Opcode> longer_;
  std::size_t by_;
  Bytes bytes_;
  ChunkIndex chunk_index_;
  AttachmentIndex attachment_index_;
};

/// All but a message, whose data go to its end.
const std::set<Opcode> k_may_grow{Opcode::Header,          Opcode::Footer,       Opcode::Schema,
                                  Opcode::Channel,         Opcode::Chunk,        Opcode::MessageIndex,
                                  Opcode::ChunkIndex,      Opcode::Attachment,   Opcode::Statistics,
                                  Opcode::AttachmentIndex, Opcode::Metadata,     Opcode::MetadataIndex,
                                  Opcode::DataEnd,         Opcode::SummaryOffset};

}  // namespace

TEST_GROUP(McapLonger) {
  test::TemporaryFolder folder;

  void is_whole(const std::set<Opcode>& longer, std::size_t by) const {
    const std::filesystem::path file = put(folder, LongerFile{longer, by}.text());
    const auto verdict = verify(file);
    SUCCEEDS(verdict);
    STRCMP_EQUAL("", verdict->faults.empty() ? "" : verdict->faults[0].what.c_str());
    CHECK(verdict->check_sums);
    std::string heard;
    const auto end = read_messages(
        file, {.on_message = [&](const Channel&, const Schema*, const Message& message) -> Result<void> {
                 heard.append(message.data.begin(), message.data.end());
                 return {};
               },
               .on_attachment = [&](const Attachment& attachment) -> Result<void> {
                 heard += "|" + attachment.name;
                 return {};
               },
               .on_metadata = [&](const Metadata& metadata) -> Result<void> {
                 heard += "|" + metadata.values.at("version");
                 return {};
               }});
    SUCCEEDS(end);
    STRCMP_EQUAL("", end->damage.c_str());
    STRCMP_EQUAL("said|settings.yaml|1", heard.c_str());
  }
};

TEST(McapLonger, EachKindOfRecordMayGrow) {
  is_whole({}, 0);
  for (const Opcode kind : k_may_grow) {
    for (const std::size_t by : {1, 3, 4, 8, 200}) is_whole({kind}, by);
  }
  is_whole(k_may_grow, 11);
}

// What is behind the sum is not covered by it; what is before it still is.
TEST(McapLonger, ChangedAttachmentIsStillFound) {
  std::string bytes = LongerFile{{Opcode::Attachment}, 6}.text();
  bytes[bytes.find("rate_hz")] = 'R';
  const std::filesystem::path file = put(folder, bytes);
  const auto verdict = verify(file);
  SUCCEEDS(verdict);
  STRCMP_CONTAINS("attachment 'settings.yaml': its check sum differs", verdict->faults.at(0).what.c_str());
  const auto end = read_messages(file, {});
  SUCCEEDS(end);
  STRCMP_CONTAINS("attachment whose check sum differs", end->damage.c_str());
}

}  // namespace biteline::mcap
