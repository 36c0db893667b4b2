// SPDX-License-Identifier: MIT
#pragma once
/// \file Clouds from other people's programs: any format that is read, any unit, as one point cloud in mm.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "host/cloud/length_unit.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/report/refusal.hpp"

namespace biteline::cloud {

/// The axis of a file that points up.
enum class Up : std::uint8_t { Z, MinusZ, Y, MinusY, X, MinusX };

/// "z", "-y": as --up takes it.
[[nodiscard]] const char* up_word(Up up);
/// From the file's axes to ours, z up.
[[nodiscard]] Eigen::Matrix3d turn_of(Up up);

/// What a person says of a file.
struct Reading {
  std::optional<Unit> unit{};
  Up up{Up::Z};
};

/// Points of the file that are none of the cloud, and why.
struct LeftOut {
  std::string why;  ///< "no number", "0 0 0 stands for nothing", "beyond 100 m"
  std::size_t points{0};
};

/// What is read of a file.
struct CloudFile {
  PointCloud cloud;  ///< mm, z up, whatever the file's unit and axes were
  Vec3 origin{
      Vec3::Zero()};       ///< where the cloud's origin lies in the file, mm, z up: far away for a map's grid
  std::size_t dropped{0};  ///< points, or triangles of a mesh, left out
  std::vector<LeftOut> left_out;  ///< the same, by reason
  double size_mm{0};  ///< longest side of the box that holds 98 % of the points, before any was too far away
  std::optional<Unit> unit;  ///< as given, or as the file's head says; none: mm was taken
  std::string understood;    ///< in one line, for people
};

/// Reads .ply .xyz .txt .asc .csv .pts (text) .pcd .stl .obj.  Only ply carries more than places.  A mesh is
/// sampled at 0.35 mm, whatever its file; values that stand for nothing are left out.  Fails naming file, row
/// and field: an unknown end of the name, damaged contents, no point at all, a unit that the file's head
/// contradicts.
[[nodiscard]] Result<CloudFile> read_cloud_file(const std::filesystem::path& file,
                                                const Reading& reading = {});

enum class UnitRefused { OtherUnit };
[[nodiscard]] std::span<const report::RefusalRow<UnitRefused>> refusal_table(UnitRefused);

/// The units that make a shoe of `size_mm`, a length read as mm, the likeliest first: a shoe alone, or one on
/// a table.
[[nodiscard]] std::vector<Unit> units_of_a_shoe(double size_mm);

/// A cloud that nobody gave a unit for, not of a shoe's size in mm, and of one in another unit.
[[nodiscard]] std::optional<report::Refusal<UnitRefused>> unit_refusal(const CloudFile& file);

}  // namespace biteline::cloud
