// SPDX-License-Identifier: MIT
#pragma once
/// \file Triangle meshes of CAD and scan programs: STL and OBJ.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/cloud/file_content.hpp"

namespace biteline::cloud {

/// Binary or text STL, in the file's unit; each triangle has three vertices of its own.  The size tells a
/// binary one, 84 bytes and 50 a triangle; its first word does not.  Normals are not read: the order of the
/// vertices tells the outside.  Fails naming triangle, row or missing bytes.
[[nodiscard]] Result<FileContent> read_stl(std::string bytes, const std::filesystem::path& file);

/// `v` and `f` of an OBJ, in the file's unit; polygons are cut into fans, numbers below zero count from the
/// end.  A face may stand before its vertices, a row goes on behind a backslash.  No face is no fault: a
/// cloud. Fails naming row and field.
[[nodiscard]] Result<FileContent> read_obj(std::string bytes, const std::filesystem::path& file);

}  // namespace biteline::cloud
