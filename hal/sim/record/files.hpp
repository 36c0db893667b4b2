// SPDX-License-Identifier: MIT
#pragma once
/// \file Folders and small texts of what is recorded.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::sim {

[[nodiscard]] Result<void> make_folder(const std::filesystem::path& folder);
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, const std::string& text);

}  // namespace biteline::sim
