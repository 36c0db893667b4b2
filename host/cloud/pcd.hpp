// SPDX-License-Identifier: MIT
#pragma once
/// \file PCD files of the Point Cloud Library, version 0.7 and older.

#include <filesystem>
#include <string_view>

#include "common/core/result.hpp"
#include "host/cloud/file_content.hpp"

namespace biteline::cloud {

/// The fields x y z, of any type and size, in the file's unit and frame (the viewpoint moves nothing);
/// ascii, binary or binary_compressed.  Without a row POINTS there are WIDTH times HEIGHT.  Fails naming the
/// head's entry, the row, or how many bytes are missing.
[[nodiscard]] Result<FileContent> read_pcd(std::string_view bytes, const std::filesystem::path& file);

}  // namespace biteline::cloud
