// SPDX-License-Identifier: MIT
#pragma once
/// \file Clouds from other people's programs: any format that is read, any unit, as one point cloud in mm.

#include <filesystem>
#include <optional>
#include <span>

#include "common/core/result.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/records/report/refusal.hpp"

namespace biteline::cloud {

enum class Unit { Millimetre, Metre, Inch };

[[nodiscard]] double mm_per(Unit unit);

/// What is read of a file, told by the end of its name.
struct CloudFile {
  PointCloud cloud;        ///< mm, whatever the file's unit was
  std::size_t dropped{0};  ///< points left out: not finite
};

/// Reads .ply, .xyz .txt .asc .csv .pts (text), .pcd, .stl and .obj.  Only ply carries more than places.
/// A mesh without enough vertices of its own (.stl, .obj with faces) is sampled at k_mesh_spacing_mm.
/// No unit means mm.  Fails naming file, row and field: an unknown end of the name, damaged contents, a
/// place beyond 100 m after the unit was applied.
[[nodiscard]] Result<CloudFile> read_cloud_file(const std::filesystem::path& file,
                                                std::optional<Unit> unit = std::nullopt);

enum class UnitRefused { OtherUnit };
[[nodiscard]] std::span<const report::RefusalRow<UnitRefused>> refusal_table(UnitRefused);

/// A cloud that nobody gave a unit for, too small for a shoe in mm, of a shoe's size in metres or inches.
[[nodiscard]] std::optional<report::Refusal<UnitRefused>> unit_refusal(const PointCloud& cloud,
                                                                       std::optional<Unit> given);

}  // namespace biteline::cloud
