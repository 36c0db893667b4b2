// SPDX-License-Identifier: MIT
#pragma once
/// \file PLY files as they are, without a meaning yet.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/cloud/file_content.hpp"

namespace biteline::cloud {

/// Ascii or binary PLY of either byte order: x y z of any type, optional nx ny nz profile column sigma_mm
/// flags mean_curvature amplitude width_px, and faces (polygons are cut into fans, strips into triangles),
/// before the vertices or behind them.  Other properties and elements are skipped.  Fails naming the file and
/// the line or byte: no x, truncated, a corner that is no vertex.
[[nodiscard]] Result<FileContent> read_ply(const std::string& bytes, const std::filesystem::path& file);

/// As write_cloud(), with `origin` [mm] added to each place; places are doubles.
[[nodiscard]] Result<void> write_far_cloud(const std::filesystem::path& file, const PointCloud& cloud,
                                           const Eigen::Vector3d& origin);

}  // namespace biteline::cloud
