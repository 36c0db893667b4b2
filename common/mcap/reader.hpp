// SPDX-License-Identifier: MIT
#pragma once
/// \file Reads an MCAP file of anybody, in file order.

#include <filesystem>
#include <functional>
#include <map>

#include "common/mcap/records.hpp"

namespace biteline::mcap {

/// The schemas and channels that a file has told so far.
class Directory {
 public:
  /// Errc::BadFormat when the number is taken by another, or is 0.
  [[nodiscard]] Result<void> add(const Schema& schema);
  /// Errc::BadFormat when the number is taken by another, or its schema is not there.
  [[nodiscard]] Result<void> add(const Channel& channel);
  /// Null: not there.
  [[nodiscard]] const Channel* channel(std::uint16_t id) const;
  [[nodiscard]] const Schema* schema_of(const Channel& channel) const;
  [[nodiscard]] const std::map<std::uint16_t, Schema>& schemas() const { return schemas_; }
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return channels_; }

 private:
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

/// Each may be empty.  An Error of theirs ends the reading.
struct Handlers {
  /// `schema`: null when the channel has none.
  std::function<Result<void>(const Channel& channel, const Schema* schema, const Message& message)>
      on_message;
  std::function<Result<void>(const Attachment& attachment)> on_attachment;
  std::function<Result<void>(const Metadata& metadata)> on_metadata;
};

struct FileEnd {
  std::uint64_t messages{0};
  std::uint64_t good_bytes{0};  ///< before the damage, or all
  std::string damage;           ///< what is wrong at `good_bytes`; empty: the file is whole
};

/// Hands out everything before the file's end, its first damage or its cut.  A chunk is checked before its
/// first message is handed out; check sums that the file tells are checked.  Memory: one record and one
/// unpacked chunk.  Errc::BadFormat when it is no MCAP file.
[[nodiscard]] Result<FileEnd> read_messages(const std::filesystem::path& file, const Handlers& handlers);

}  // namespace biteline::mcap
