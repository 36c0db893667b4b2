// SPDX-License-Identifier: MIT
#pragma once
/// \file A closed, ordered line on a shoe, with normals: the product's result.

#include <filesystem>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::cloud {

struct LinePoint {
  Vec3 position;         ///< base, mm
  Vec3 normal;           ///< outward unit normal of the upper beside the line
  Vec3 tangent;          ///< unit, in the order of the points
  double confidence{0};  ///< probability that the point is within 0.3 mm of the bite line
};

/// The last point is joined to the first; anticlockwise seen from +z of the shoe; evenly spaced.
struct ClosedLine {
  std::vector<LinePoint> points;
};

[[nodiscard]] double length_mm(const ClosedLine& line);

/// line.csv.  Numbers must be finite, normals and tangents of unit length (to 1e-3), at least 3 rows.
[[nodiscard]] Result<ClosedLine> read_line(const std::filesystem::path& file);
[[nodiscard]] Result<void> write_line(const std::filesystem::path& file, const ClosedLine& line);

/// Only x, y, z are needed (a truth file): normals, tangents and confidence are zero.
[[nodiscard]] Result<ClosedLine> read_positions(const std::filesystem::path& file);

}  // namespace biteline::cloud
