// SPDX-License-Identifier: MIT
#include "common/mcap/records.hpp"

#include <zlib.h>

#include <concepts>
#include <limits>

namespace biteline::mcap {
namespace {

// Each record's fields in their order, once for both ways.
template <class A>
void fields(A& a, Header& r) {
  a(r.profile), a(r.library);
}
template <class A>
void fields(A& a, Footer& r) {
  a(r.summary_start), a(r.summary_offset_start), a(r.summary_crc);
}
template <class A>
void fields(A& a, Schema& r) {
  a(r.id), a(r.name), a(r.encoding), a(r.data);
}
template <class A>
void fields(A& a, Channel& r) {
  a(r.id), a(r.schema_id), a(r.topic), a(r.message_encoding), a(r.metadata);
}
template <class A>
void fields(A& a, Message& r) {
  a(r.channel_id), a(r.sequence), a(r.log_time_ns), a(r.publish_time_ns), a.rest(r.data);
}
template <class A>
void fields(A& a, Chunk& r) {
  a(r.start_time_ns), a(r.end_time_ns), a(r.uncompressed_bytes), a(r.uncompressed_crc), a(r.compression),
      a.blob(r.records);
}
template <class A>
void fields(A& a, MessageIndex& r) {
  a(r.channel_id), a(r.entries);
}
template <class A>
void fields(A& a, ChunkIndex& r) {
  a(r.start_time_ns), a(r.end_time_ns), a(r.chunk_start), a(r.chunk_bytes), a(r.message_index_offsets),
      a(r.message_index_bytes), a(r.compression), a(r.compressed_bytes), a(r.uncompressed_bytes);
}
template <class A>
void fields(A& a, Attachment& r) {
  a(r.log_time_ns), a(r.create_time_ns), a(r.name), a(r.media_type), a.blob(r.data), a(r.crc);
}
template <class A>
void fields(A& a, AttachmentIndex& r) {
  a(r.offset), a(r.record_bytes), a(r.log_time_ns), a(r.create_time_ns), a(r.data_bytes), a(r.name),
      a(r.media_type);
}
template <class A>
void fields(A& a, Statistics& r) {
  a(r.messages), a(r.schemas), a(r.channels), a(r.attachments), a(r.metadata), a(r.chunks),
      a(r.start_time_ns), a(r.end_time_ns), a(r.messages_of_channel);
}
template <class A>
void fields(A& a, Metadata& r) {
  a(r.name), a(r.values);
}
template <class A>
void fields(A& a, MetadataIndex& r) {
  a(r.offset), a(r.record_bytes), a(r.name);
}
template <class A>
void fields(A& a, SummaryOffset& r) {
  a(r.group_opcode), a(r.group_start), a(r.group_bytes);
}
template <class A>
void fields(A& a, DataEnd& r) {
  a(r.data_crc);
}

class Put {
 public:
  explicit Put(Bytes& out) : out_{out} {}

  void operator()(std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      out_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size()));
    out_.insert(out_.end(), text.begin(), text.end());
  }
  /// Maps and lists: their length in bytes, then pairs.
  template <class Pairs>
  requires requires(Pairs pairs) { pairs.begin()->second; }
  void operator()(const Pairs& pairs) {
    const std::size_t at = out_.size();
    (*this)(std::uint32_t{0});
    for (const auto& [first, second] : pairs) (*this)(first), (*this)(second);
    set(at, static_cast<std::uint32_t>(out_.size() - at - sizeof(std::uint32_t)));
  }
  void blob(View bytes) {
    (*this)(std::uint64_t{bytes.size()});
    rest(bytes);
  }
  void rest(View bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  void set(std::size_t at, std::unsigned_integral auto value) {
    for (std::size_t i = 0; i < sizeof value; ++i) out_[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }

 private:
  Bytes& out_;
};

/// Fails for good with the first field that is not there.
class Take {
 public:
  explicit Take(View bytes) : bytes_{bytes} {}

  template <std::unsigned_integral Value>
  void operator()(Value& value) {
    const View raw = next(sizeof value);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) sum |= std::uint64_t{raw[i]} << (8 * i);
    value = static_cast<Value>(sum);
  }
  void operator()(std::string& text) {
    std::uint32_t size = 0;
    (*this)(size);
    const View raw = next(size);
    text.assign(raw.begin(), raw.end());
  }
  template <class Pairs>
  requires requires(Pairs pairs) { pairs.begin()->second; }
  void operator()(Pairs& pairs) {
    std::uint32_t size = 0;
    (*this)(size);
    Take inner{next(size)};
    while (inner.good_ && !inner.bytes_.empty()) {
      std::remove_const_t<decltype(pairs.begin()->first)> first{};
      decltype(pairs.begin()->second) second{};
      inner(first), inner(second);
      if (inner.good_) pairs.insert(pairs.end(), {std::move(first), std::move(second)});
    }
    good_ = good_ && inner.good_;
  }
  void blob(View& bytes) {
    std::uint64_t size = 0;
    (*this)(size);
    bytes = next(size);
  }
  void rest(View& bytes) { bytes = next(bytes_.size()); }
  [[nodiscard]] bool good() const { return good_; }

 private:
  View next(std::uint64_t count) {
    good_ = good_ && count <= bytes_.size();
    if (!good_) return {};
    const View taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(count));
    return taken;
  }

  View bytes_;
  bool good_{true};
};

constexpr std::array k_names{
    "header",     "footer",        "schema",         "channel",        "message",
    "chunk",      "message index", "chunk index",    "attachment",     "attachment index",
    "statistics", "metadata",      "metadata index", "summary offset", "data end"};

}  // namespace

template <class Record>
void append_record(const Record& record, Bytes& out) {
  Put put{out};
  put(static_cast<std::uint8_t>(Record::k_opcode));
  const std::size_t at = out.size();
  put(std::uint64_t{0});
  // The fields are listed for both ways; a writer changes none.
  fields(put, const_cast<Record&>(record));
  put.set(at, std::uint64_t{out.size() - at - sizeof(std::uint64_t)});
}

template <class Record>
Result<Record> parse(View content) {
  Take take{content};
  Record record;
  fields(take, record);
  if (!take.good()) {
    return fail(Errc::BadFormat, "a %s that does not hold its fields",
                name_of(static_cast<std::uint8_t>(Record::k_opcode)).c_str());
  }
  return record;
}

View summed_bytes(View content, const Attachment& attachment) {
  // The data are the last field before the sum, and borrowed from `content`.
  const auto* const end = attachment.data.data() + attachment.data.size();
  return content.first(static_cast<std::size_t>(end - content.data()));
}

std::string name_of(std::uint8_t opcode) {
  if (opcode >= 1 && opcode <= k_names.size()) return k_names.at(opcode - 1U);
  return "record " + std::to_string(opcode);
}

std::uint32_t crc32(View bytes, std::uint32_t sum) {
  return static_cast<std::uint32_t>(::crc32_z(sum, bytes.data(), bytes.size()));
}

#define BITELINE_MCAP_RECORD(Record)                          \
  template void append_record<Record>(const Record&, Bytes&); \
  template Result<Record> parse<Record>(View);
BITELINE_MCAP_RECORD(Header)
BITELINE_MCAP_RECORD(Footer)
BITELINE_MCAP_RECORD(Schema)
BITELINE_MCAP_RECORD(Channel)
BITELINE_MCAP_RECORD(Message)
BITELINE_MCAP_RECORD(Chunk)
BITELINE_MCAP_RECORD(MessageIndex)
BITELINE_MCAP_RECORD(ChunkIndex)
BITELINE_MCAP_RECORD(Attachment)
BITELINE_MCAP_RECORD(AttachmentIndex)
BITELINE_MCAP_RECORD(Statistics)
BITELINE_MCAP_RECORD(Metadata)
BITELINE_MCAP_RECORD(MetadataIndex)
BITELINE_MCAP_RECORD(SummaryOffset)
BITELINE_MCAP_RECORD(DataEnd)
#undef BITELINE_MCAP_RECORD

}  // namespace biteline::mcap
