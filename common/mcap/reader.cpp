// SPDX-License-Identifier: MIT
#include "common/mcap/reader.hpp"

#include <optional>

#include "common/core/text.hpp"
#include "common/mcap/chunk.hpp"
#include "common/mcap/record_file.hpp"

namespace biteline::mcap {
namespace {

class Walk {
 public:
  explicit Walk(const Handlers& handlers) : handlers_{handlers} {}

  /// A record of the data section or of a chunk.
  Result<void> take(std::uint8_t opcode, View content) {
    switch (static_cast<Opcode>(opcode)) {
      case Opcode::Schema: {
        BITELINE_ASSIGN(const Schema schema, parse<Schema>(content));
        return directory_.add(schema);
      }
      case Opcode::Channel: {
        BITELINE_ASSIGN(const Channel channel, parse<Channel>(content));
        return directory_.add(channel);
      }
      case Opcode::Message:
        return take_message(content);
      case Opcode::Chunk: {
        BITELINE_ASSIGN(const Chunk chunk, parse<Chunk>(content));
        BITELINE_ASSIGN(const Bytes records, unpack(chunk));
        return for_each_record(records, [&](std::uint8_t inner, View bytes, std::uint64_t) -> Result<void> {
          // Nothing else stands in a chunk; a chunk in a chunk would be a way to unpack without end.
          const auto kind = static_cast<Opcode>(inner);
          if (kind == Opcode::Schema || kind == Opcode::Channel || kind == Opcode::Message)
            return take(inner, bytes);
          return fail(Errc::BadFormat, "a %s in a chunk", name_of(inner).c_str());
        });
      }
      case Opcode::Attachment: {
        BITELINE_ASSIGN(const Attachment attachment, parse<Attachment>(content));
        if (attachment.crc != 0 && crc32(summed_bytes(content, attachment)) != attachment.crc)
          return fail(Errc::BadFormat, "an attachment whose check sum differs");
        return handlers_.on_attachment ? tell(handlers_.on_attachment(attachment)) : Result<void>{};
      }
      case Opcode::Metadata: {
        BITELINE_ASSIGN(const Metadata metadata, parse<Metadata>(content));
        return handlers_.on_metadata ? tell(handlers_.on_metadata(metadata)) : Result<void>{};
      }
      default:
        return {};  // indexes, and what later versions add
    }
  }

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  /// The handler's, if one ended the reading.
  [[nodiscard]] const std::optional<Error>& refusal() const { return refusal_; }

 private:
  Result<void> tell(Result<void> told) {
    if (!told) refusal_ = told.error();
    return told;
  }
  Result<void> take_message(View content) {
    BITELINE_ASSIGN(const Message message, parse<Message>(content));
    const Channel* const channel = directory_.channel(message.channel_id);
    if (channel == nullptr) {
      return fail(Errc::BadFormat, "a message of channel %d, which nobody told", int{message.channel_id});
    }
    ++messages_;
    if (!handlers_.on_message) return {};
    return tell(handlers_.on_message(*channel, directory_.schema_of(*channel), message));
  }

  const Handlers& handlers_;
  Directory directory_;
  std::uint64_t messages_{0};
  std::optional<Error> refusal_;
};

}  // namespace

Result<void> Directory::add(const Schema& schema) {
  if (schema.id == 0) return fail(Errc::BadFormat, "a schema with the number 0");
  if (schemas_.emplace(schema.id, schema).first->second == schema) return {};
  return fail(Errc::BadFormat, "two schemas with the number %d", int{schema.id});
}

Result<void> Directory::add(const Channel& channel) {
  if (channel.schema_id != 0 && !schemas_.contains(channel.schema_id)) {
    return fail(Errc::BadFormat, "channel %d has schema %d, which nobody told", int{channel.id},
                int{channel.schema_id});
  }
  if (channels_.emplace(channel.id, channel).first->second == channel) return {};
  return fail(Errc::BadFormat, "two channels with the number %d", int{channel.id});
}

const Channel* Directory::channel(std::uint16_t id) const {
  const auto found = channels_.find(id);
  return found == channels_.end() ? nullptr : &found->second;
}

const Schema* Directory::schema_of(const Channel& channel) const {
  const auto found = schemas_.find(channel.schema_id);
  return found == schemas_.end() ? nullptr : &found->second;
}

Result<FileEnd> read_messages(const std::filesystem::path& file, const Handlers& handlers) {
  BITELINE_ASSIGN(RecordFile records, RecordFile::open(file));
  Walk walk{handlers};
  FileEnd end;
  std::uint32_t crc = crc32(k_magic);
  bool data = true;
  const auto note = [&](const Error& error) { end.damage = clean_text(error.where.view()); };
  for (;;) {
    end.good_bytes = records.position();
    const Result<std::optional<RecordFile::Record>> record = records.next();
    if (!record) {
      note(record.error());
      break;
    }
    if (!*record) {
      end.good_bytes = records.position();
      break;
    }
    if (!data) continue;  // the summary repeats what was there
    if ((*record)->opcode == static_cast<std::uint8_t>(Opcode::DataEnd)) {
      data = false;
      const Result<DataEnd> last = parse<DataEnd>((*record)->content);
      if (last && (last->data_crc == 0 || last->data_crc == crc)) continue;
      end.damage = "the data section's check sum differs";
      break;
    }
    crc = crc32((*record)->whole, crc);
    if (const Result<void> taken = walk.take((*record)->opcode, (*record)->content); !taken) {
      if (walk.refusal()) return tl::unexpected<Error>{*walk.refusal()};
      note(taken.error());
      break;
    }
  }
  end.messages = walk.messages();
  return end;
}

}  // namespace biteline::mcap
