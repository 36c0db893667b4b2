// SPDX-License-Identifier: MIT
#pragma once
/// \file Whose shoe a scan is of: its part number, foot and size, on disk and in words.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::service {

/// Texts as of a memory::Scan; empty: nobody knows.
struct ShoeWords {
  std::string part{}, foot{}, size{};
};

/// Beside the recording while the scan comes in: a service after this one has no other way to know it.
[[nodiscard]] Result<void> mark_part(const std::filesystem::path& folder, const std::string& part);
/// Empty: none was told.
[[nodiscard]] std::string marked_part(const std::filesystem::path& folder);

/// `part`, `foot` and `size` of report.json, null where nobody knows; nothing where there is no report.  Call
/// it before the report's SHA-256 is taken.
[[nodiscard]] Result<void> tell_shoe(const std::filesystem::path& folder, const ShoeWords& shoe);

/// Why a person has to look: a path was sent for a shoe of this part number before.  Empty: none was, or
/// `part` is empty.  A memory that cannot be read is a reason, too.
[[nodiscard]] std::string worked_before(const memory::Memory& memory, const std::string& scan,
                                        const std::string& part);
/// A scan of this part number has begun since it was said.
[[nodiscard]] bool is_used_up(const memory::Memory& memory, const std::string& part, memory::UnixMs said);

}  // namespace biteline::service
