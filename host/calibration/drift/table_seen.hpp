// SPDX-License-Identifier: MIT
#pragma once
/// \file The table under the shoe, seen all the way round and from every side: one plane, and the same one at
/// every shoe.

#include <optional>

#include "host/calibration/drift/quantities.hpp"
#include "host/calibration/drift/scan_view.hpp"

namespace biteline::drift {

/// z = height + slope_x (x - middle.x) + slope_y (y - middle.y), in base.
struct TablePlane {
  Vec2 middle{Vec2::Zero()};
  double height_mm{0}, slope_x{0}, slope_y{0};

  [[nodiscard]] double above_mm(const Vec3& point_base) const {
    const Vec2 d = point_base.head<2>() - middle;
    return point_base.z() - height_mm - slope_x * d.x() - slope_y * d.y();
  }
};

/// What the table says about the head.  The table's own three quantities count from `plane`.
struct TableEvidence {
  Matrix information{Matrix::Zero()};
  Vector pull{Vector::Zero()};
  TablePlane plane{};
  double scatter_mm{0};  ///< of a profile's middle against its neighbours'
  std::size_t profiles{0};

  /// The same, the table's quantities counted from another plane: the one that was usual.
  [[nodiscard]] TableEvidence counted_from(const TablePlane& usual) const;
  /// The usual table and this one are so far apart that they are two.
  [[nodiscard]] bool is_another(const TablePlane& usual) const;
};

/// None where less than half of the profiles that show anything show a level surface below it.
[[nodiscard]] std::optional<TableEvidence> see_table(const ScanView& scan, const geometry::SensorModel& head);

}  // namespace biteline::drift
