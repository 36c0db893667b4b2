// SPDX-License-Identifier: MIT
#pragma once
/// \file What a line is mended on: the side of the scanned shoe, and its candidates.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/led_curve.hpp"
#include "host/bite_line/edit/refused.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::edit {

/// Prepared once for all steps.  Takes as long as finding the line does.
class Surface {
 public:
  /// Of the cloud of a finished scan, base.
  [[nodiscard]] static OrRefusal<Surface> of(const cloud::PointCloud& cloud);

  [[nodiscard]] const bite_line::SideGrid& grid() const { return side_.field.grid; }
  [[nodiscard]] const SE3& T_base_shoe() const { return side_.shoe.T_base_shoe; }
  /// As the method judged them, the best first: those that report.json lists.
  [[nodiscard]] const bite_line::Decision& decision() const { return decision_; }
  [[nodiscard]] std::span<const bite_line::Candidate> candidates() const { return candidates_; }

  /// A candidate's line, counted from 1, placed in the raw points; confidence and U95 as of place().  Pre:
  /// there is such a one.
  [[nodiscard]] cloud::ClosedLine candidate(int number) const;

  /// Whether the found line passes within 1 mm of a point (base), and is on its crease with 99 % there.
  [[nodiscard]] bool sure_beside(const Vec3& point) const;

  /// Where a point (base) lies on the unrolled side: s, z; nothing when it lies beyond.
  [[nodiscard]] std::optional<Vec2> locate(const Vec3& point) const;
  [[nodiscard]] double turn_mm() const { return side_.outline.length_mm(); }  ///< of s, once round
  /// Row of a closed line per column.
  [[nodiscard]] std::vector<int> rows_of(const cloud::ClosedLine& line) const;

  /// led_curve() on this side.
  [[nodiscard]] std::optional<std::vector<Vec2>> lead(std::span<const bite_line::CurveLead> leads) const;

  /// The line along a path (row per column), placed in the raw points.  Its points' confidence and U95 take
  /// for granted that this is the crease; `of_line` is the probability that it is.
  [[nodiscard]] cloud::ClosedLine place(std::span<const double> path, double of_line) const;
  /// The same along places (s, z), see place_guide().
  [[nodiscard]] OrRefusal<cloud::ClosedLine> place_along(std::span<const Vec2> guide) const;

 private:
  Surface(std::vector<Eigen::Vector3f> points, bite_line::PointRuns runs, bite_line::Workings workings,
          std::vector<bite_line::Candidate> candidates);

  [[nodiscard]] bite_line::ScanPoints points() const;

  std::vector<Eigen::Vector3f> points_;
  bite_line::PointRuns runs_;  ///< of these points
  bite_line::Side side_;
  bite_line::Decision decision_;
  bite_line::PlacedLine placed_;  ///< of the first candidate; empty where it was not placed
  std::vector<bite_line::Candidate> candidates_;
  std::unique_ptr<bite_line::CurveGround> ground_;
};

}  // namespace biteline::edit
