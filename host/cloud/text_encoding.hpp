// SPDX-License-Identifier: MIT
#pragma once
/// \file Texts of any program as plain UTF-8.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::cloud {

/// Takes a byte mark off and turns UTF-16 of either order, with a mark or without one, into UTF-8.  Refuses
/// what is no text: packed files and other binary data, by their own name where it is known.
[[nodiscard]] Result<std::string> as_plain_text(std::string bytes, const std::filesystem::path& file);

}  // namespace biteline::cloud
