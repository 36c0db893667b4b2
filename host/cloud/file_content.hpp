// SPDX-License-Identifier: MIT
#pragma once
/// \file What a file of points or triangles holds, before anybody knows what it means.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cloud/length_unit.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::cloud {

/// In the file's own unit, axes and origin: double, since a place may lie far from the origin.
struct FileContent {
  std::vector<Eigen::Vector3d>
      places;  ///< of points: with numbers; of a mesh's vertices: NaN where there are none
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< anticlockwise seen from outside; corners are vertices
  /// Beside the places, each array empty or as long as they; `points` is not used.
  PointCloud beside;
  std::size_t without_number{0};              ///< points, or triangles, that were left out
  std::string layout;                         ///< how it was understood, in words
  std::array<std::optional<Unit>, 3> unit{};  ///< of x, y, z, as the file says
};

/// Leaves out the triangles with a corner that has no numbers, and counts them; then the vertices of none.
void leave_out_broken_faces(FileContent& content);

/// The places where `keep` is not 0, with what stands beside them; takes the memory of `content`.
[[nodiscard]] PointCloud kept_of(FileContent& content, const std::vector<std::uint8_t>& keep);

}  // namespace biteline::cloud
