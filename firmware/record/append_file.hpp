// SPDX-License-Identifier: MIT
#pragma once
/// \file A file that only grows, by whole pieces.

#include <filesystem>
#include <span>
#include <string_view>

#include "common/core/result.hpp"

namespace biteline::record {

/// Thread: one owner.
class AppendFile {
 public:
  /// Errc::WriteFailed when the file exists.
  [[nodiscard]] static Result<AppendFile> create(const std::filesystem::path& file);

  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;
  ~AppendFile();

  /// Whole or not at all: after Errc::DiskFull or WriteFailed the file ends with the piece before.
  [[nodiscard]] Result<void> append(std::span<const std::uint8_t> piece);
  [[nodiscard]] Result<void> append(std::string_view piece);

 private:
  AppendFile(std::filesystem::path file, int number) : file_{std::move(file)}, number_{number} {}

  std::filesystem::path file_;
  int number_{-1};
  std::uint64_t size_bytes_{0};
};

}  // namespace biteline::record
