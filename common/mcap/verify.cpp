// SPDX-License-Identifier: MIT
#include "common/mcap/verify.hpp"

#include <algorithm>
#include <cinttypes>
#include <optional>

#include "common/core/text.hpp"
#include "common/mcap/chain.hpp"
#include "common/mcap/chunk.hpp"
#include "common/mcap/reader.hpp"
#include "common/mcap/record_file.hpp"

namespace biteline::mcap {
namespace {

using Record = RecordFile::Record;

/// What is wrong, without the words for whoever would repair a settings file.
std::string words(const Error& error) {
  return std::string{error.where.view()};
}

class Verifier {
 public:
  void take(const Record& record) {
    if (section_ == Section::Data) {
      take_data(record);
    } else {
      take_summary(record);
    }
  }
  void note(std::uint64_t at, const std::string& told) {
    // Names in it are the file's.
    std::string what = clean_text(told);
    if (verdict_.faults.size() < k_most_faults) {
      verdict_.faults.push_back({.at = at, .what = std::move(what)});
    } else {
      ++verdict_.more_faults;
    }
  }
  Verdict finish(std::uint64_t end) {
    if (section_ == Section::Data) note(end, "the data section has no end");
    verdict_.messages = expected_.messages;
    verdict_.chunks = expected_.chunks;
    verdict_.attachments = expected_.attachments;
    verdict_.metadata = expected_.metadata;
    for (auto& [id, hash] : hashes_) {
      auto& [count, sha] = hash;
      TopicCount& topic = verdict_.topics[clean_text(directory_.channel(id)->topic)];
      // Two channels of one topic: one after the other, by number.
      if (topic.messages > 0) topic.sha256 += ' ';
      topic.sha256 += hex(sha.take());
      topic.messages += count;
    }
    return std::move(verdict_);
  }

 private:
  enum class Section : std::uint8_t { Data, Summary };

  /// Notes what parse() refuses.
  template <class R>
  std::optional<R> read(const Record& record) {
    Result<R> parsed = parse<R>(record.content);
    if (parsed) return std::move(*parsed);
    note(record.start, words(parsed.error()));
    return std::nullopt;
  }
  void note_failed(std::uint64_t at, const Result<void>& result) {
    if (!result) note(at, words(result.error()));
  }

  void take_data(const Record& record) {
    const auto opcode = static_cast<Opcode>(record.opcode);
    if (first_ && opcode != Opcode::Header) note(record.start, "a header expected");
    first_ = false;
    if (opcode == Opcode::DataEnd) return take_data_end(record);
    if (opcode == Opcode::Metadata) {
      take_metadata(record);
    } else {
      chain_.add(record.whole);
    }
    crc_ = crc32(record.whole, crc_);
    switch (opcode) {
      case Opcode::Header:
        if (const auto header = read<Header>(record)) verdict_.library = clean_text(header->library);
        break;
      case Opcode::Schema:
      case Opcode::Channel:
      case Opcode::Message:
        note_failed(record.start, take_content(record.opcode, record.content, 0));
        break;
      case Opcode::Chunk:
        take_chunk(record);
        break;
      case Opcode::MessageIndex:
        take_message_index(record);
        break;
      case Opcode::Attachment:
        take_attachment(record);
        break;
      case Opcode::Metadata:
        break;
      default:
        if (record.opcode <= static_cast<std::uint8_t>(Opcode::DataEnd))
          note(record.start, "a " + name_of(record.opcode) + " in the data section");
    }
  }

  /// Of the data section, or of a chunk, where it begins `at`.
  Result<void> take_content(std::uint8_t opcode, View content, std::uint64_t at) {
    switch (static_cast<Opcode>(opcode)) {
      case Opcode::Schema: {
        BITELINE_ASSIGN(const Schema schema, parse<Schema>(content));
        return directory_.add(schema);
      }
      case Opcode::Channel: {
        BITELINE_ASSIGN(const Channel channel, parse<Channel>(content));
        return directory_.add(channel);
      }
      case Opcode::Message: {
        BITELINE_ASSIGN(const Message message, parse<Message>(content));
        if (directory_.channel(message.channel_id) == nullptr)
          return fail(Errc::BadFormat, "a message of channel %d, which nobody told", int{message.channel_id});
        count(message);
        MessageIndex& index = indexes_[message.channel_id];
        index.channel_id = message.channel_id;
        index.entries.emplace_back(message.log_time_ns, at);
        return {};
      }
      default:
        return fail(Errc::BadFormat, "a %s in a chunk", name_of(opcode).c_str());
    }
  }

  void count(const Message& message) {
    const std::uint64_t time = message.log_time_ns;
    const bool first = expected_.messages == 0;
    expected_.start_time_ns = first ? time : std::min(expected_.start_time_ns, time);
    expected_.end_time_ns = first ? time : std::max(expected_.end_time_ns, time);
    ++expected_.messages;
    ++expected_.messages_of_channel[message.channel_id];
    auto& [messages, sha] = hashes_[message.channel_id];
    ++messages;
    sha.add(message.data);
  }

  void take_chunk(const Record& record) {
    indexes_.clear();
    chunk_name_ = "chunk " + std::to_string(++expected_.chunks);
    const auto chunk = read<Chunk>(record);
    if (!chunk) return broken_chunks_.push_back(record.start);
    check_sum_told(chunk->uncompressed_crc);
    const Result<Bytes> records = unpack(*chunk);
    if (!records) {
      broken_chunks_.push_back(record.start);
      return note(record.start, chunk_name_ + ": " + words(records.error()));
    }
    if (has_chain_ && chunk->uncompressed_crc == 0 && crc32(*records) != 0)
      note(record.start, chunk_name_ + ": its check sum is missing");
    const Result<void> walked =
        for_each_record(*records, [&](std::uint8_t opcode, View content, std::uint64_t at) {
          return take_content(opcode, content, at);
        });
    if (!walked) note(record.start, chunk_name_ + ": " + words(walked.error()));
    std::uint64_t start = 0, end = 0;
    bool any = false;
    for (const auto& [channel, index] : indexes_) {
      for (const auto& [time, at] : index.entries) {
        start = any ? std::min(start, time) : time;
        end = any ? std::max(end, time) : time;
        any = true;
      }
    }
    if (chunk->start_time_ns != start || chunk->end_time_ns != end)
      note(record.start, chunk_name_ + ": its times are not those of its messages");
    chunks_.push_back({.start_time_ns = start,
                       .end_time_ns = end,
                       .chunk_start = record.start,
                       .chunk_bytes = record.whole.size(),
                       .message_index_offsets = {},
                       .message_index_bytes = 0,
                       .compression = chunk->compression,
                       .compressed_bytes = chunk->records.size(),
                       .uncompressed_bytes = records->size()});
  }

  void take_message_index(const Record& record) {
    auto index = read<MessageIndex>(record);
    if (!index || (!broken_chunks_.empty() && chunks_broken_last())) return;
    std::ranges::sort(index->entries);
    const auto expected = indexes_.find(index->channel_id);
    if (chunks_.empty() || expected == indexes_.end()) {
      if (!index->entries.empty()) note(record.start, "a message index of nothing");
      return;
    }
    std::ranges::sort(expected->second.entries);
    if (expected->second.entries != index->entries)
      note(record.start, chunk_name_ + ": its message index leads elsewhere");
    chunks_.back().message_index_offsets[index->channel_id] = record.start;
    chunks_.back().message_index_bytes += record.whole.size();
  }

  void take_attachment(const Record& record) {
    ++expected_.attachments;
    const auto attachment = read<Attachment>(record);
    if (!attachment) return;
    check_sum_told(attachment->crc);
    const std::uint32_t crc = crc32(summed_bytes(record.content, *attachment));
    if (crc != attachment->crc && (attachment->crc != 0 || has_chain_))
      note(record.start, "attachment '" + attachment->name + "': its check sum differs");
    attachments_.push_back({.offset = record.start,
                            .record_bytes = record.whole.size(),
                            .log_time_ns = attachment->log_time_ns,
                            .create_time_ns = attachment->create_time_ns,
                            .data_bytes = attachment->data.size(),
                            .name = attachment->name,
                            .media_type = attachment->media_type});
  }

  void take_metadata(const Record& record) {
    ++expected_.metadata;
    const auto metadata = read<Metadata>(record);
    if (!metadata) return chain_.add(record.whole);
    metadata_.push_back(
        {.offset = record.start, .record_bytes = record.whole.size(), .name = metadata->name});
    if (metadata->name != k_chain_name) return chain_.add(record.whole);
    has_chain_ = true;
    ++verdict_.links;
    const auto told = metadata->values.find("sha256");
    const std::string link = chain_.close_link();
    if (told == metadata->values.end() || told->second != link)
      note(record.start, "link " + std::to_string(verdict_.links) + " of the hash chain does not fit");
    verdict_.last_link = told == metadata->values.end() ? "" : clean_text(told->second);
  }

  void take_data_end(const Record& record) {
    section_ = Section::Summary;
    const auto end = read<DataEnd>(record);
    if (!end) return;
    check_sum_told(end->data_crc);
    if (end->data_crc != crc_ && (end->data_crc != 0 || has_chain_))
      note(record.start, "the data section's check sum differs");
    summary_start_ = record.start + record.whole.size();
    crc_ = 0;
  }

  void take_summary(const Record& record) {
    const auto opcode = static_cast<Opcode>(record.opcode);
    if (opcode == Opcode::Footer) return take_footer(record);
    crc_ = crc32(record.whole, crc_);
    if (opcode == Opcode::SummaryOffset) {
      if (offsets_start_ == 0) offsets_start_ = record.start;
      const auto offset = read<SummaryOffset>(record);
      if (offset && std::ranges::find(groups_, *offset) == groups_.end())
        note(record.start, "a summary offset that leads elsewhere");
      return;
    }
    if (groups_.empty() || groups_.back().group_opcode != record.opcode)
      groups_.push_back({.group_opcode = record.opcode, .group_start = record.start, .group_bytes = 0});
    groups_.back().group_bytes += record.whole.size();
    switch (opcode) {
      case Opcode::Schema:
        if (const auto schema = read<Schema>(record)) note_failed(record.start, directory_.add(*schema));
        break;
      case Opcode::Channel:
        if (const auto channel = read<Channel>(record)) note_failed(record.start, directory_.add(*channel));
        break;
      case Opcode::Statistics:
        statistics_start_ = record.start;
        statistics_ = read<Statistics>(record);
        break;
      case Opcode::ChunkIndex:
        if (const auto told = parse<ChunkIndex>(record.content);
            told && std::ranges::find(broken_chunks_, told->chunk_start) != broken_chunks_.end())
          break;
        expect_one_of(record, read<ChunkIndex>(record), chunks_);
        break;
      case Opcode::AttachmentIndex:
        expect_one_of(record, read<AttachmentIndex>(record), attachments_);
        break;
      case Opcode::MetadataIndex:
        expect_one_of(record, read<MetadataIndex>(record), metadata_);
        break;
      default:
        if (record.opcode <= static_cast<std::uint8_t>(Opcode::DataEnd))
          note(record.start, "a " + name_of(record.opcode) + " in the summary");
    }
  }

  template <class Index>
  void expect_one_of(const Record& record, const std::optional<Index>& told,
                     const std::vector<Index>& expected) {
    if (told && std::ranges::find(expected, *told) == expected.end())
      note(record.start, "a " + name_of(record.opcode) + " that leads elsewhere");
  }

  void take_footer(const Record& record) {
    const auto footer = read<Footer>(record);
    if (!footer) return;
    check_sum_told(footer->summary_crc);
    check_statistics();
    // Up to the sum itself; behind it a later version's fields may stand.
    constexpr std::size_t k_before_sum =
        k_record_head_bytes + sizeof footer->summary_start + sizeof footer->summary_offset_start;
    const std::uint32_t crc = crc32(record.whole.first(k_before_sum), crc_);
    if (footer->summary_crc != crc && (footer->summary_crc != 0 || has_chain_))
      note(record.start, "the summary's check sum differs");
    const std::uint64_t start = groups_.empty() ? 0 : summary_start_;
    if (footer->summary_start != start) note(record.start, "its footer leads elsewhere");
    if (footer->summary_offset_start != offsets_start_ && footer->summary_offset_start != 0)
      note(record.start, "its footer's summary offsets lead elsewhere");
  }

  /// Once all schemas and channels are known: writers tell those without messages in the summary only, or
  /// nowhere.
  void check_statistics() {
    if (!statistics_ || !broken_chunks_.empty()) return;
    std::erase_if(statistics_->messages_of_channel, [](const auto& entry) { return entry.second == 0; });
    const auto schemas = static_cast<std::uint16_t>(directory_.schemas().size());
    const auto channels = static_cast<std::uint32_t>(directory_.channels().size());
    expected_.schemas = has_chain_ ? schemas : std::max(schemas, statistics_->schemas);
    expected_.channels = has_chain_ ? channels : std::max(channels, statistics_->channels);
    if (*statistics_ != expected_) note(statistics_start_, "its statistics do not fit its messages");
  }

  [[nodiscard]] bool chunks_broken_last() const {
    return chunks_.empty() || chunks_.back().chunk_start < broken_chunks_.back();
  }

  void check_sum_told(std::uint32_t sum) { verdict_.check_sums = verdict_.check_sums && sum != 0; }

  Verdict verdict_;
  Section section_{Section::Data};
  bool first_{true};
  bool has_chain_{false};
  std::uint32_t crc_{crc32(k_magic)};
  Chain chain_ = [] {
    Chain chain;
    chain.add(k_magic);
    return chain;
  }();
  Directory directory_;
  std::map<std::uint16_t, std::pair<std::uint64_t, Sha256>> hashes_;
  // What the summary must say.
  Statistics expected_;
  std::vector<ChunkIndex> chunks_;
  std::vector<std::uint64_t> broken_chunks_;  ///< where they begin
  std::optional<Statistics> statistics_;      ///< as the file says
  std::uint64_t statistics_start_{0};
  std::vector<AttachmentIndex> attachments_;
  std::vector<MetadataIndex> metadata_;
  std::vector<SummaryOffset> groups_;
  std::uint64_t summary_start_{0}, offsets_start_{0};
  // Of the last chunk.
  std::string chunk_name_;
  std::map<std::uint16_t, MessageIndex> indexes_;
};

}  // namespace

Result<Verdict> verify(const std::filesystem::path& file) {
  BITELINE_ASSIGN(RecordFile records, RecordFile::open(file));
  Verifier verifier;
  for (;;) {
    const Result<std::optional<Record>> record = records.next();
    if (!record) {
      verifier.note(records.position(), to_line(record.error()));
      break;
    }
    if (!*record) break;
    verifier.take(**record);
  }
  return verifier.finish(records.position());
}

}  // namespace biteline::mcap
