// SPDX-License-Identifier: MIT
#pragma once
/// \file Files from outside: looked at before they are opened, and never read without bound.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline {

/// Far above any settings file; far below what hurts.
inline constexpr std::uint64_t k_most_settings_bytes = 4U << 20U;
/// Some ten million rows of a table.
inline constexpr std::uint64_t k_most_table_bytes = 1U << 30U;
/// A hundred million points with all their properties.
inline constexpr std::uint64_t k_most_cloud_bytes = 4ULL << 30U;

/// Fails when `file` is missing, a folder, a pipe, a device or larger than `most_bytes`.  Opens nothing:
/// opening a pipe waits for its other end, and opening a device may do something.
[[nodiscard]] Result<void> check_regular_file(const std::filesystem::path& file, std::uint64_t most_bytes);

/// The whole of a regular file of at most `most_bytes`.
[[nodiscard]] Result<std::string> read_regular_file(const std::filesystem::path& file,
                                                    std::uint64_t most_bytes);

}  // namespace biteline
