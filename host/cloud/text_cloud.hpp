// SPDX-License-Identifier: MIT
#pragma once
/// \file Clouds as rows of numbers: xyz, csv, txt, asc, pts.

#include <string>

#include "common/core/result.hpp"
#include "host/cloud/file_content.hpp"

namespace biteline::cloud {

/// One point a row, in the file's unit.  `text_layout()` finds how the file is written; each row is then read
/// strictly so.  A row whose x, y or z is empty or a word is a point without number.  Rows that begin with #,
/// //, % or ! are comments.  Fails naming row and field: digits that are no number, another number of fields
/// than before, fewer points than the file itself says.
[[nodiscard]] Result<FileContent> read_text_cloud(std::string bytes, const std::filesystem::path& file);

}  // namespace biteline::cloud
