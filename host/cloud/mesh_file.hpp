// SPDX-License-Identifier: MIT
#pragma once
/// \file Triangle meshes of CAD and scan programs: STL and OBJ.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/cloud/ply.hpp"

namespace biteline::cloud {

/// Binary or text STL, in the file's unit; each triangle has three vertices of its own.  Normals are not
/// read: the order of the vertices tells the outside.  Fails naming triangle, row or missing bytes.
[[nodiscard]] Result<TriangleMesh> read_stl(const std::filesystem::path& file);

/// `v` and `f` of an OBJ, in the file's unit; polygons are cut into fans, numbers below zero count from the
/// end.  No face is no fault: a cloud.  Fails naming row and field.
[[nodiscard]] Result<TriangleMesh> read_obj(const std::filesystem::path& file);

}  // namespace biteline::cloud
