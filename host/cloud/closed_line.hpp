// SPDX-License-Identifier: MIT
#pragma once
/// \file A closed, ordered line on a shoe, with normals: the product's result.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::cloud {

/// Where a point's place comes from.
enum class PointSource : std::uint8_t {
  Seen,     ///< on this shoe's own crease
  Bridged,  ///< between two seen stretches
  Carried,  ///< from a sample's line, on this shoe's own surface
  Mended,   ///< put right by hand
};

/// What a reader should know of a point: bits of LinePoint::flags.
enum LineFlag : std::uint32_t {
  k_line_unsure = 1U << 0,  ///< confidence below 0.5, or U95 above 1 mm
};

struct LinePoint {
  Vec3 position;         ///< base, mm
  Vec3 normal;           ///< outward unit normal of the upper beside the line
  Vec3 tangent;          ///< unit, in the order of the points
  double confidence{0};  ///< probability that the point is within 0.3 mm of the bite line
  /// Radius about the point, in the plane across the line, that holds the true line with 95 %; none: unknown.
  std::optional<double> u95_mm{};
  std::uint32_t flags{0};  ///< of LineFlag
  PointSource source{PointSource::Seen};
};

/// A point is within this of the bite line with its confidence.
inline constexpr double k_right_mm = 0.3;
/// A point of less confidence, or of more U95 than the second, is flagged.
inline constexpr double k_sure_ratio = 0.5;
inline constexpr double k_sure_mm = 1.0;
/// Sets k_line_unsure where the point is.  One without a U95 is judged by its confidence.
void flag_unsure(LinePoint& point);

/// The last point is joined to the first; anticlockwise seen from +z of the shoe; evenly spaced.
struct ClosedLine {
  std::vector<LinePoint> points;
};

[[nodiscard]] double length_mm(const ClosedLine& line);

/// line.csv.  Numbers must be finite, normals and tangents of unit length (to 1e-3), at least 3 rows.
/// Behind the confidence may stand u95 [mm] (empty: unknown), flags and source, in this order.  They are
/// written where any point has one of them.
[[nodiscard]] Result<ClosedLine> read_line(const std::filesystem::path& file);
[[nodiscard]] Result<void> write_line(const std::filesystem::path& file, const ClosedLine& line);

/// Only x, y, z are needed (a truth file): normals, tangents and confidence are zero.
[[nodiscard]] Result<ClosedLine> read_positions(const std::filesystem::path& file);

}  // namespace biteline::cloud
