// SPDX-License-Identifier: MIT
#pragma once
/// \file The bite line: found in a cloud, read and written.

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "biteline/cloud.hpp"
#include "biteline/export.hpp"

namespace biteline::sdk {

/// Where a point's place comes from: seen on the shoe's crease, bridged between two seen stretches, carried
/// over from a sample, or mended by hand.
enum class Source { Seen, Bridged, Carried, Mended };

struct LinePoint {
  Eigen::Vector3d position_mm;
  Eigen::Vector3d normal;          ///< outward, unit, of the upper beside the line
  Eigen::Vector3d tangent;         ///< unit, in the order of the points
  double confidence{0};            ///< probability that it is within 0.3 mm of the bite line
  std::optional<double> u95_mm{};  ///< radius across the line that holds the true line with 95 %, if known
  bool unsure{false};              ///< a person should look
  Source source{Source::Seen};
};

/// Closed: the last point is joined to the first; anticlockwise seen from above; evenly spaced.
struct Line {
  std::vector<LinePoint> points;
};

[[nodiscard]] BITELINE_API double length_mm(const Line& line);

/// line.csv.  Throws Error naming file, row and field.
[[nodiscard]] BITELINE_API Line read_line(const std::filesystem::path& file);
BITELINE_API void write_line(const std::filesystem::path& file, const Line& line);

struct FoundLine {
  Line line;
  double confidence{0};  ///< that the line as a whole is the bite line
  double bridged_mm{0};  ///< length without a visible crease
  /// Why a person must settle the unsure points before anything is done along the line; empty: nobody must.
  std::string review;
};

/// Finds the line of the shoe in the cloud, on all cores.  Throws Refused where there is none to trust.
[[nodiscard]] BITELINE_API FoundLine find_line(const Cloud& cloud);

}  // namespace biteline::sdk
