// SPDX-License-Identifier: MIT
#pragma once
/// \file PLY files: clouds, and triangle meshes (reference surfaces).

#include <array>
#include <filesystem>

#include "common/core/result.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::cloud {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;            ///< mm
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< anticlockwise seen from outside
};

/// Reads ascii or binary PLY of either byte order: x y z of any numeric type, optional nx ny nz profile
/// column sigma_mm flags mean_curvature amplitude width_px; other properties and elements are skipped.
/// Non-finite points are left out and counted in `dropped` when given.  Fails naming the file and the line or
/// byte: no x, truncated, no finite point.
[[nodiscard]] Result<PointCloud> read_cloud(const std::filesystem::path& file,
                                            std::size_t* dropped = nullptr);

/// Binary little-endian; writes beside and renames, so that a reader never sees half a file.
[[nodiscard]] Result<void> write_cloud(const std::filesystem::path& file, const PointCloud& cloud);

/// Polygons are cut into fans.
[[nodiscard]] Result<TriangleMesh> read_mesh(const std::filesystem::path& file);

}  // namespace biteline::cloud
