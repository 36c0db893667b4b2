// SPDX-License-Identifier: MIT
#pragma once
/// \file Writes an MCAP file: chunks with check sums and indexes, a summary, and a hash chain.

#include <cstdio>
#include <filesystem>
#include <memory>

#include "common/mcap/chain.hpp"
#include "common/mcap/chunk.hpp"
#include "common/mcap/records.hpp"

namespace biteline::mcap {

/// Appends only: what was written before a cut can be read.  Memory: one chunk, and an index entry for each.
/// Move-only; thread: one owner.  After an Error nothing more may be written.
class Writer {
 public:
  struct Options {
    std::string library;  ///< who writes, with its version
    Compression compression{Compression::Zstd};
    std::size_t chunk_bytes{1U << 20U};  ///< a chunk is closed when it has as many
  };
  /// Errc::WriteFailed when the file exists.
  [[nodiscard]] static Result<Writer> create(const std::filesystem::path& file, Options options);

  [[nodiscard]] Result<std::uint16_t> add_schema(std::string name, std::string encoding, std::string data);
  /// `schema_id`: 0 for none.
  [[nodiscard]] Result<std::uint16_t> add_channel(std::uint16_t schema_id, std::string topic,
                                                  std::string message_encoding, Map metadata = {});
  /// Pre: add_channel() gave its channel_id.
  [[nodiscard]] Result<void> write(const Message& message);
  /// The crc is made here.
  [[nodiscard]] Result<void> attach(Attachment attachment);
  [[nodiscard]] Result<void> add_metadata(const Metadata& metadata);
  /// What was written so far survives the program's end, whatever ends it.
  [[nodiscard]] Result<void> flush();
  /// Without the chunk that is being filled.
  [[nodiscard]] std::uint64_t bytes_written() const { return size_; }
  /// Writes summary and end.  The chain's last link: who keeps it elsewhere sees any later change.
  [[nodiscard]] Result<std::string> close();

 private:
  struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  Writer(std::filesystem::path name, std::FILE* file, Options options)
      : name_{std::move(name)}, file_{file}, options_{std::move(options)} {}
  [[nodiscard]] Result<void> append(View bytes);
  [[nodiscard]] Result<void> push_out();
  /// As errno says.
  [[nodiscard]] Result<void> failed() const;
  template <class Record>
  [[nodiscard]] Result<void> append_new(const Record& record);
  [[nodiscard]] Result<void> close_chunk();
  [[nodiscard]] Result<std::string> add_link();
  [[nodiscard]] Result<void> append_summary();

  std::filesystem::path name_;
  std::unique_ptr<std::FILE, FileCloser> file_;
  Options options_;
  std::uint64_t size_{0};
  std::uint32_t crc_{0};
  Chain chain_;
  bool chained_{true};  ///< what is appended belongs to the next link
  Bytes scratch_;

  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  Statistics statistics_;
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::vector<MetadataIndex> metadata_;

  Bytes records_, packed_;  ///< of the open chunk
  std::map<std::uint16_t, MessageIndex> indexes_;
  std::uint64_t chunk_start_ns_{0}, chunk_end_ns_{0};
};

}  // namespace biteline::mcap
