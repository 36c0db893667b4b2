// SPDX-License-Identifier: MIT
#pragma once
/// \file An MCAP file's outermost records, one after the other.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "common/mcap/chunk.hpp"
#include "common/mcap/records.hpp"

namespace biteline::mcap {

/// Whole chunks and all that a recording attaches; larger records of others are refused, not read.
inline constexpr std::uint64_t k_most_record_bytes = k_most_chunk_bytes + (1U << 20U);

/// Reads a file from its beginning, one record in memory.  Move-only; thread: one owner.
class RecordFile {
 public:
  struct Record {
    std::uint8_t opcode{0};
    std::uint64_t start{0};
    View whole;    ///< with its head; valid until next()
    View content;  ///< of `whole`
  };
  /// Errc::BadFormat when it does not begin as an MCAP file.
  [[nodiscard]] static Result<RecordFile> open(const std::filesystem::path& file);

  /// Nothing: the end, as it should be.  Errc::Truncated: the file was cut; BadFormat: it is damaged here.
  [[nodiscard]] Result<std::optional<Record>> next();
  /// Behind the last record.
  [[nodiscard]] std::uint64_t position() const { return position_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  explicit RecordFile(std::FILE* file) : file_{file} {}
  [[nodiscard]] bool read(std::uint8_t* out, std::size_t count);
  [[nodiscard]] Result<std::optional<Record>> end();

  std::unique_ptr<std::FILE, FileCloser> file_;
  std::uint64_t size_{0};
  std::uint64_t position_{0};
  bool after_footer_{false};
  Bytes whole_;
};

}  // namespace biteline::mcap
