// SPDX-License-Identifier: MIT
#pragma once
/// \file Clouds as rows of numbers: xyz, csv, txt, asc, pts.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::cloud {

/// One point a row: x y z first, in the file's unit; what follows is not read.  Fields stand apart by comma,
/// semicolon, tab or blanks.  Rows that begin with # or // are comments; one head line of names (which
/// may place x, y and z elsewhere) and one count of points may stand first.  Points that are not finite or
/// beyond 1e5 are left out and counted.  Fails naming row and field; a decimal comma is named as such.
[[nodiscard]] Result<std::vector<Eigen::Vector3f>> read_text_cloud(const std::filesystem::path& file,
                                                                   std::size_t& dropped);

}  // namespace biteline::cloud
