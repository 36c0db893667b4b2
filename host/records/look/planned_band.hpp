// SPDX-License-Identifier: MIT
#pragma once
/// \file The band that a process plans on a line, as a second look asks for it.

#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/robot/path/checks/checked_path.hpp"
#include "host/robot/path/process.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::look {

/// What replaces the process's own; ways across on the surface, as in second_look.hpp.
struct BandWish {
  std::optional<double> offset_mm{};     ///< of the band's middle above the line; none: placement.up_mm
  std::optional<double> width_mm{};      ///< none: what the process's coverage tells
  std::optional<double> tolerance_mm{};  ///< none: look_tolerance_mm
};

/// `process` as it lies on the shoe's foot.  Errc::InvalidArgument names why it cannot be compared: a zone
/// moves the band, or no width is told.
[[nodiscard]] Result<second_look::PlannedBand> planned_band(const cloud::ClosedLine& line,
                                                            const path::Process& process,
                                                            const BandWish& wish);

/// Where the path's tool goes along the line, in base: its tip, or so far before it as it stands off.
[[nodiscard]] std::vector<Vec3> middle_of(const path::PlannedPath& path);

/// Where the path ends its round and meets its begin, along the line, mm; nothing: it stays open.
[[nodiscard]] std::optional<double> end_of(const path::PlannedPath& path, const cloud::ClosedLine& line);

/// Where the path's first run meets itself, on the line; none: it stays open, or nothing is laid there twice.
[[nodiscard]] std::optional<second_look::Arc> seam_of(const path::PlannedPath& path,
                                                      const cloud::ClosedLine& line);

}  // namespace biteline::look
