// SPDX-License-Identifier: MIT
#pragma once
/// \file Several files as one: a tar file (POSIX ustar) whose last entry, biteline.json, names them all.
///
/// Any tar program lists and unpacks one.  biteline.json holds kind, format, program, time, and for each file
/// its name, size and CRC-32C: what is cut short, changed or of another kind is found before it is used.

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "common/core/result.hpp"

namespace biteline::archive {

struct Entry {
  std::string name;  ///< within the archive: parts of letters, digits, '.', '_', '-', none begins with '.'
  std::filesystem::path file;  ///< a regular file
};

struct About {
  std::string kind;  ///< "model", "backup"
  std::string program, time;
  std::map<std::string, std::string> more{};  ///< what else the kind tells
};

/// Written beside and renamed, readable by its owner only.
[[nodiscard]] Result<void> write(const std::filesystem::path& target, const About& about,
                                 std::span<const Entry> entries);

/// Unpacks into `folder`, which is empty or missing.  Errc::BadFormat, BadValue or SizeMismatch names what is
/// wrong; `folder` then holds nothing that may be used.
[[nodiscard]] Result<About> unpack(const std::filesystem::path& file, const std::string& kind,
                                   const std::filesystem::path& folder);

}  // namespace biteline::archive
