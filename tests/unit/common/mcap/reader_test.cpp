// SPDX-License-Identifier: MIT
#include "common/mcap/reader.hpp"

#include "common/mcap/record_file.hpp"
#include "tests/unit/common/mcap/made_file.hpp"

namespace biteline::mcap {

TEST_GROUP(McapReader) {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "a.mcap";

  struct Heard {
    std::vector<std::string> messages, attachments, metadata;
    Handlers handlers() {
      return {.on_message = [this](const Channel& channel, const Schema* schema,
                                   const Message& message) -> Result<void> {
                messages.push_back(channel.topic + " " + (schema == nullptr ? "-" : schema->name) + " " +
                                   std::to_string(message.log_time_ns) + " " +
                                   std::string(message.data.begin(), message.data.end()));
                return {};
              },
              .on_attachment = [this](const Attachment& attachment) -> Result<void> {
                attachments.push_back(attachment.name + " " +
                                      std::string(attachment.data.begin(), attachment.data.end()));
                return {};
              },
              .on_metadata = [this](const Metadata& entry) -> Result<void> {
                metadata.push_back(entry.name);
                return {};
              }};
    }
  };
};

TEST(McapReader, GivesWhatWasWritten) {
  for (const Compression compression : {Compression::None, Compression::Zstd}) {
    std::filesystem::remove(file);
    made_file(file, compression);
    Heard heard;
    const auto end = read_messages(file, heard.handlers());
    SUCCEEDS(end);
    STRCMP_EQUAL("", end->damage.c_str());
    LONGS_EQUAL(std::filesystem::file_size(file), end->good_bytes);
    LONGS_EQUAL(9, end->messages);
    STRCMP_CONTAINS("/raw - 100 message 0", heard.messages.front().c_str());
    STRCMP_CONTAINS("/pose Pose 180 message 8", heard.messages.back().c_str());
    STRCMP_EQUAL("settings.yaml rate_hz: 25\n", heard.attachments.at(0).c_str());
    STRCMP_EQUAL("build", heard.metadata.at(0).c_str());
  }
}

TEST(McapReader, CutFileGivesEveryWholeChunkBeforeTheCut) {
  const std::string whole = made_file(file, Compression::None);
  auto records = RecordFile::open(file);
  SUCCEEDS(records);
  std::vector<std::size_t> chunk_ends;
  for (auto record = records->next(); record && *record; record = records->next()) {
    if ((*record)->opcode == static_cast<std::uint8_t>(Opcode::Chunk))
      chunk_ends.push_back((*record)->start + (*record)->whole.size());
  }
  LONGS_EQUAL(3, chunk_ends.size());
  for (std::size_t size = k_magic.size(); size < whole.size(); ++size) {
    const auto end = read_messages(put(folder, whole.substr(0, size)), {});
    SUCCEEDS(end);
    const auto chunks = static_cast<std::uint64_t>(
        std::count_if(chunk_ends.begin(), chunk_ends.end(), [&](std::size_t at) { return at <= size; }));
    LONGS_EQUAL(3 * chunks, end->messages);
    CHECK(!end->damage.empty() && end->good_bytes <= size);
  }
}

TEST(McapReader, HandlersErrorEndsItAndIsTheirs) {
  made_file(file, Compression::Zstd);
  FAILS_NAMING(
      Errc::DiskFull, "theirs",
      read_messages(file, {.on_message = [](const Channel&, const Schema*, const Message&) -> Result<void> {
                             return fail(Errc::DiskFull, "theirs");
                           },
                           .on_attachment = {},
                           .on_metadata = {}}));
}

TEST(McapReader, WhatIsNoMcapFileIsRefused) {
  FAILS_NAMING(Errc::BadFormat, "not an MCAP file", read_messages(folder.write("b", "BTLNSCAN1234"), {}));
  FAILS_NAMING(Errc::FileNotFound, "none", read_messages(folder.path() / "none", {}));
}

TEST(McapReader, ChunkInAChunkIsNotOpened) {
  Bytes inner, chunk, text(k_magic.begin(), k_magic.end());
  append_record(Chunk{}, inner);
  append_record(Header{}, text);
  append_record(Chunk{.start_time_ns = 0,
                      .end_time_ns = 0,
                      .uncompressed_bytes = inner.size(),
                      .uncompressed_crc = 0,
                      .compression = "",
                      .records = inner},
                text);
  const auto end = read_messages(folder.write("c", std::string(text.begin(), text.end())), {});
  SUCCEEDS(end);
  STRCMP_CONTAINS("a chunk in a chunk", end->damage.c_str());
}

TEST(McapReader, MessageOfAChannelThatNobodyToldEndsIt) {
  Bytes text(k_magic.begin(), k_magic.end());
  append_record(Header{}, text);
  append_record(Message{.channel_id = 4, .sequence = 0, .log_time_ns = 0, .publish_time_ns = 0, .data = {}},
                text);
  const auto end = read_messages(folder.write("d", std::string(text.begin(), text.end())), {});
  SUCCEEDS(end);
  STRCMP_CONTAINS("channel 4", end->damage.c_str());
}

TEST(McapReader, WriterLeavesWhatIsThere) {
  folder.write("a.mcap", "mine");
  FAILS_NAMING(Errc::WriteFailed, "a.mcap", Writer::create(file, {.library = "test"}));
  STRCMP_EQUAL("mine", content(file).c_str());
}

}  // namespace biteline::mcap
