// SPDX-License-Identifier: MIT
#pragma once
/// \file The 15 records of an MCAP file (version 0 of its specification) as plain structs, and their bytes.
///
/// Integers are little-endian.  Spans are borrowed from the bytes that were parsed.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::mcap {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;
using Map = std::map<std::string, std::string>;

/// First and last in each file.
inline constexpr std::array<std::uint8_t, 8> k_magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
/// Before each record's content: opcode and 64-bit length.
inline constexpr std::size_t k_record_head_bytes = 9;

enum class Opcode : std::uint8_t {
  Header = 1,
  Footer,
  Schema,
  Channel,
  Message,
  Chunk,
  MessageIndex,
  ChunkIndex,
  Attachment,
  AttachmentIndex,
  Statistics,
  Metadata,
  MetadataIndex,
  SummaryOffset,
  DataEnd,
};

// Times are nanoseconds of whatever clock the writer says; offsets are bytes from the file's beginning.

struct Header {
  static constexpr Opcode k_opcode = Opcode::Header;
  std::string profile;
  std::string library;
};

struct Footer {
  static constexpr Opcode k_opcode = Opcode::Footer;
  std::uint64_t summary_start{0};         ///< 0: no summary
  std::uint64_t summary_offset_start{0};  ///< 0: no summary offsets
  std::uint32_t summary_crc{0};           ///< from summary_start to this field; 0: not told
};

struct Schema {
  static constexpr Opcode k_opcode = Opcode::Schema;
  std::uint16_t id{0};  ///< from 1
  std::string name;
  std::string encoding;
  std::string data;
  [[nodiscard]] bool operator==(const Schema&) const = default;
};

struct Channel {
  static constexpr Opcode k_opcode = Opcode::Channel;
  std::uint16_t id{0};
  std::uint16_t schema_id{0};  ///< 0: none
  std::string topic;
  std::string message_encoding;
  Map metadata;
  [[nodiscard]] bool operator==(const Channel&) const = default;
};

struct Message {
  static constexpr Opcode k_opcode = Opcode::Message;
  std::uint16_t channel_id{0};
  std::uint32_t sequence{0};
  std::uint64_t log_time_ns{0};
  std::uint64_t publish_time_ns{0};
  View data;
};

struct Chunk {
  static constexpr Opcode k_opcode = Opcode::Chunk;
  std::uint64_t start_time_ns{0};
  std::uint64_t end_time_ns{0};
  std::uint64_t uncompressed_bytes{0};
  std::uint32_t uncompressed_crc{0};  ///< 0: not told
  std::string compression;            ///< "", "zstd" or "lz4"
  View records;
};

struct MessageIndex {
  static constexpr Opcode k_opcode = Opcode::MessageIndex;
  std::uint16_t channel_id{0};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  ///< log time, place in the unpacked chunk
};

struct ChunkIndex {
  static constexpr Opcode k_opcode = Opcode::ChunkIndex;
  std::uint64_t start_time_ns{0};
  std::uint64_t end_time_ns{0};
  std::uint64_t chunk_start{0};
  std::uint64_t chunk_bytes{0};  ///< with its head
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_bytes{0};
  std::string compression;
  std::uint64_t compressed_bytes{0};
  std::uint64_t uncompressed_bytes{0};
  [[nodiscard]] bool operator==(const ChunkIndex&) const = default;
};

struct Attachment {
  static constexpr Opcode k_opcode = Opcode::Attachment;
  std::uint64_t log_time_ns{0};
  std::uint64_t create_time_ns{0};
  std::string name;
  std::string media_type;
  View data;
  std::uint32_t crc{0};  ///< of the fields before it; 0: not told
};

struct AttachmentIndex {
  static constexpr Opcode k_opcode = Opcode::AttachmentIndex;
  std::uint64_t offset{0};
  std::uint64_t record_bytes{0};
  std::uint64_t log_time_ns{0};
  std::uint64_t create_time_ns{0};
  std::uint64_t data_bytes{0};
  std::string name;
  std::string media_type;
  [[nodiscard]] bool operator==(const AttachmentIndex&) const = default;
};

struct Statistics {
  static constexpr Opcode k_opcode = Opcode::Statistics;
  std::uint64_t messages{0};
  std::uint16_t schemas{0};
  std::uint32_t channels{0};
  std::uint32_t attachments{0};
  std::uint32_t metadata{0};
  std::uint32_t chunks{0};
  std::uint64_t start_time_ns{0};
  std::uint64_t end_time_ns{0};
  std::map<std::uint16_t, std::uint64_t> messages_of_channel;
  [[nodiscard]] bool operator==(const Statistics&) const = default;
};

struct Metadata {
  static constexpr Opcode k_opcode = Opcode::Metadata;
  std::string name;
  Map values;
};

struct MetadataIndex {
  static constexpr Opcode k_opcode = Opcode::MetadataIndex;
  std::uint64_t offset{0};
  std::uint64_t record_bytes{0};
  std::string name;
  [[nodiscard]] bool operator==(const MetadataIndex&) const = default;
};

struct SummaryOffset {
  static constexpr Opcode k_opcode = Opcode::SummaryOffset;
  std::uint8_t group_opcode{0};
  std::uint64_t group_start{0};
  std::uint64_t group_bytes{0};
  [[nodiscard]] bool operator==(const SummaryOffset&) const = default;
};

struct DataEnd {
  static constexpr Opcode k_opcode = Opcode::DataEnd;
  std::uint32_t data_crc{0};  ///< of all before this record; 0: not told
};

/// Appends the whole record.  Pre: texts and maps below 4 GB.
template <class Record>
void append_record(const Record& record, Bytes& out);

/// The record of its content; bytes behind its last field are a later version's and passed over.
/// Errc::BadFormat, naming the kind of record.
template <class Record>
[[nodiscard]] Result<Record> parse(View content);

/// What an attachment's check sum covers: its fields before the sum.  Behind the sum a later version's fields
/// may stand.  Pre: `attachment` was parsed from `content`.
[[nodiscard]] View summed_bytes(View content, const Attachment& attachment);

/// "chunk" and so on; "record 42" for an opcode of a later version.
[[nodiscard]] std::string name_of(std::uint8_t opcode);

/// CRC-32 as in zlib.  `sum`: of what came before.
[[nodiscard]] std::uint32_t crc32(View bytes, std::uint32_t sum = 0);

}  // namespace biteline::mcap
