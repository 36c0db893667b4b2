// SPDX-License-Identifier: MIT
#pragma once
/// \file PCD files of the Point Cloud Library, version 0.7 and older.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::cloud {

/// The fields x y z, of any type and size, in the file's unit and frame (the viewpoint moves nothing);
/// ascii, binary or binary_compressed.  Points that are not finite or beyond 1e5 are left out and counted.
/// Fails naming the head's entry, the row, or how many bytes are missing.
[[nodiscard]] Result<std::vector<Eigen::Vector3f>> read_pcd(const std::filesystem::path& file,
                                                            std::size_t& dropped);

}  // namespace biteline::cloud
