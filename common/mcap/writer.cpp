// SPDX-License-Identifier: MIT
#include "common/mcap/writer.hpp"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::mcap {

Result<Writer> Writer::create(const std::filesystem::path& file, Options options) {
  std::FILE* const out = std::fopen(file.c_str(), "wbx");
  if (out == nullptr) return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  Writer writer{file, out, std::move(options)};
  BITELINE_TRY(writer.append(k_magic));
  BITELINE_TRY(writer.append_new(Header{.profile = {}, .library = writer.options_.library}));
  return writer;
}

Result<void> Writer::failed() const {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  return fail_errno(full ? Errc::DiskFull : Errc::WriteFailed, errno, "%s", name_.c_str());
}

Result<void> Writer::append(View bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) {
    return failed();
  }
  size_ += bytes.size();
  crc_ = crc32(bytes, crc_);
  if (chained_) chain_.add(bytes);
  return {};
}

Result<void> Writer::push_out() {
  if (std::fflush(file_.get()) == 0) return {};
  return failed();
}

Result<void> Writer::flush() {
  BITELINE_TRY(close_chunk());
  return push_out();
}

template <class Record>
Result<void> Writer::append_new(const Record& record) {
  scratch_.clear();
  append_record(record, scratch_);
  return append(scratch_);
}

Result<std::uint16_t> Writer::add_schema(std::string name, std::string encoding, std::string data) {
  BITELINE_EXPECTS(schemas_.size() < std::numeric_limits<std::uint16_t>::max());
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.push_back(
      {.id = id, .name = std::move(name), .encoding = std::move(encoding), .data = std::move(data)});
  BITELINE_TRY(append_new(schemas_.back()));
  return id;
}

Result<std::uint16_t> Writer::add_channel(std::uint16_t schema_id, std::string topic,
                                          std::string message_encoding, Map metadata) {
  BITELINE_EXPECTS(schema_id <= schemas_.size());
  BITELINE_EXPECTS(channels_.size() < std::numeric_limits<std::uint16_t>::max());
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_.push_back({.id = id,
                       .schema_id = schema_id,
                       .topic = std::move(topic),
                       .message_encoding = std::move(message_encoding),
                       .metadata = std::move(metadata)});
  BITELINE_TRY(append_new(channels_.back()));
  return id;
}

Result<void> Writer::write(const Message& message) {
  BITELINE_EXPECTS(message.channel_id >= 1 && message.channel_id <= channels_.size());
  const std::uint64_t time = message.log_time_ns;
  const bool first_of_chunk = records_.empty(), first = statistics_.messages == 0;
  MessageIndex& index = indexes_[message.channel_id];
  index.channel_id = message.channel_id;
  index.entries.emplace_back(time, records_.size());
  append_record(message, records_);
  chunk_start_ns_ = first_of_chunk ? time : std::min(chunk_start_ns_, time);
  chunk_end_ns_ = first_of_chunk ? time : std::max(chunk_end_ns_, time);
  statistics_.start_time_ns = first ? time : std::min(statistics_.start_time_ns, time);
  statistics_.end_time_ns = first ? time : std::max(statistics_.end_time_ns, time);
  ++statistics_.messages;
  ++statistics_.messages_of_channel[message.channel_id];
  return records_.size() < options_.chunk_bytes ? Result<void>{} : close_chunk();
}

Result<void> Writer::close_chunk() {
  if (records_.empty()) return {};
  const bool packed = options_.compression == Compression::Zstd && pack_zstd(records_, packed_);
  const Chunk chunk{.start_time_ns = chunk_start_ns_,
                    .end_time_ns = chunk_end_ns_,
                    .uncompressed_bytes = records_.size(),
                    .uncompressed_crc = crc32(records_),
                    .compression = packed ? "zstd" : "",
                    .records = packed ? packed_ : records_};
  ChunkIndex entry{.start_time_ns = chunk.start_time_ns,
                   .end_time_ns = chunk.end_time_ns,
                   .chunk_start = size_,
                   .chunk_bytes = 0,
                   .message_index_offsets = {},
                   .message_index_bytes = 0,
                   .compression = chunk.compression,
                   .compressed_bytes = chunk.records.size(),
                   .uncompressed_bytes = chunk.uncompressed_bytes};
  BITELINE_TRY(append_new(chunk));
  entry.chunk_bytes = size_ - entry.chunk_start;
  const std::uint64_t indexes_start = size_;
  for (const auto& [channel, index] : indexes_) {
    entry.message_index_offsets[channel] = size_;
    BITELINE_TRY(append_new(index));
  }
  entry.message_index_bytes = size_ - indexes_start;
  chunks_.push_back(std::move(entry));
  ++statistics_.chunks;
  records_.clear();
  indexes_.clear();
  BITELINE_TRY(add_link());
  return {};
}

Result<void> Writer::attach(Attachment attachment) {
  BITELINE_TRY(close_chunk());
  attachment.crc = 0;
  scratch_.clear();
  append_record(attachment, scratch_);
  const View content = View{scratch_}.subspan(k_record_head_bytes);
  const std::uint32_t crc = crc32(content.first(content.size() - sizeof crc));
  for (std::size_t i = 0; i < sizeof crc; ++i)
    scratch_[scratch_.size() - sizeof crc + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  attachments_.push_back({.offset = size_,
                          .record_bytes = scratch_.size(),
                          .log_time_ns = attachment.log_time_ns,
                          .create_time_ns = attachment.create_time_ns,
                          .data_bytes = attachment.data.size(),
                          .name = std::move(attachment.name),
                          .media_type = std::move(attachment.media_type)});
  ++statistics_.attachments;
  return append(scratch_);
}

Result<void> Writer::add_metadata(const Metadata& metadata) {
  BITELINE_TRY(close_chunk());
  const std::uint64_t start = size_;
  BITELINE_TRY(append_new(metadata));
  metadata_.push_back({.offset = start, .record_bytes = size_ - start, .name = metadata.name});
  ++statistics_.metadata;
  return {};
}

Result<std::string> Writer::add_link() {
  std::string link = chain_.close_link();
  const std::uint64_t start = size_;
  chained_ = false;
  BITELINE_TRY(append_new(Metadata{.name = k_chain_name, .values = {{"sha256", link}}}));
  chained_ = true;
  metadata_.push_back({.offset = start, .record_bytes = size_ - start, .name = k_chain_name});
  ++statistics_.metadata;
  return link;
}

Result<void> Writer::append_summary() {
  const std::uint64_t summary_start = size_;
  crc_ = 0;
  std::vector<SummaryOffset> groups;
  const auto append_group = [&]<class Record>(const std::vector<Record>& records) -> Result<void> {
    const std::uint64_t start = size_;
    for (const Record& record : records) {
      BITELINE_TRY(append_new(record));
    }
    if (!records.empty()) {
      groups.push_back({.group_opcode = static_cast<std::uint8_t>(Record::k_opcode),
                        .group_start = start,
                        .group_bytes = size_ - start});
    }
    return {};
  };
  BITELINE_TRY(append_group(schemas_));
  BITELINE_TRY(append_group(channels_));
  BITELINE_TRY(append_group(std::vector{statistics_}));
  BITELINE_TRY(append_group(chunks_));
  BITELINE_TRY(append_group(attachments_));
  BITELINE_TRY(append_group(metadata_));
  const std::uint64_t offsets_start = size_;
  for (const SummaryOffset& group : groups) {
    BITELINE_TRY(append_new(group));
  }
  Footer footer{.summary_start = summary_start, .summary_offset_start = offsets_start, .summary_crc = 0};
  scratch_.clear();
  append_record(footer, scratch_);
  footer.summary_crc = crc32(View{scratch_}.first(scratch_.size() - sizeof footer.summary_crc), crc_);
  return append_new(footer);
}

Result<std::string> Writer::close() {
  BITELINE_TRY(close_chunk());
  statistics_.schemas = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channels = static_cast<std::uint32_t>(channels_.size());
  BITELINE_ASSIGN(std::string link, add_link());
  BITELINE_TRY(append_new(DataEnd{.data_crc = crc_}));
  BITELINE_TRY(append_summary());
  BITELINE_TRY(append(k_magic));
  BITELINE_TRY(push_out());
  return link;
}

}  // namespace biteline::mcap
