// SPDX-License-Identifier: MIT
#pragma once
/// \file A file that comes in pieces: written at its place, made safe, and renamed when it is whole.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

namespace biteline::fleet {

/// 0 where there is none.
[[nodiscard]] std::int64_t part_bytes(const std::filesystem::path& file);
/// What stood behind `at` goes.  Errc::DiskFull or WriteFailed; Errc::SizeMismatch: the file is shorter than
/// `at`.
[[nodiscard]] Result<void> write_part(const std::filesystem::path& file, std::int64_t at,
                                      std::string_view bytes);
/// At most `most` bytes; none at the end.
[[nodiscard]] Result<std::string> read_part_bytes(const std::filesystem::path& file, std::int64_t at,
                                                  std::size_t most);
/// On the disk as `whole` once this returns.  Errc::SizeMismatch: it has not so many bytes.
[[nodiscard]] Result<void> finish_part(const std::filesystem::path& file, std::int64_t bytes,
                                       const std::filesystem::path& whole);

}  // namespace biteline::fleet
