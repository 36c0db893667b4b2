// SPDX-License-Identifier: MIT
#pragma once
/// \file What a line is mended on: the side of the scanned shoe, and its candidates.

#include <span>
#include <vector>

#include "host/bite_line/extraction.hpp"
#include "host/bite_line/layers/layers.hpp"
#include "host/bite_line/mend/refused.hpp"
#include "host/bite_line/path/decide.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side.hpp"
#include "host/bite_line/workings.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::mend {

/// A place of the side's grid; fractions of a cell.
struct GridPlace {
  double row{0};
  double col{0};
};

/// Prepared once for all steps.  Takes as long as finding the line does.
class Surface {
 public:
  /// Of the cloud of a finished scan, base.
  [[nodiscard]] static OrRefusal<Surface> of(const cloud::PointCloud& cloud);

  [[nodiscard]] const bite_line::SideGrid& grid() const { return side_.field.grid; }
  [[nodiscard]] const SE3& T_base_shoe() const { return side_.shoe.T_base_shoe; }
  /// Of a course per cell, column after column.
  [[nodiscard]] std::span<const float> cost() const { return {cost_.data(), cost_.size()}; }
  /// As the method judged them, the best first: those that report.json lists.
  [[nodiscard]] const bite_line::Decision& decision() const { return decision_; }
  [[nodiscard]] std::span<const bite_line::Candidate> candidates() const { return candidates_; }

  /// A candidate's line, counted from 1, placed in the raw points; confidence and U95 as of place().  Pre:
  /// there is such a one.
  [[nodiscard]] cloud::ClosedLine candidate(int number) const;

  /// Where a point (base) lies on the unrolled side; nothing when it lies beyond.
  [[nodiscard]] std::optional<GridPlace> locate(const Vec3& point) const;
  /// Row of a closed line per column.
  [[nodiscard]] std::vector<int> rows_of(const cloud::ClosedLine& line) const;

  /// The line along a path (row per column), placed in the raw points.  Its points' confidence and U95 take
  /// for granted that this is the crease; `of_line` is the probability that it is.
  [[nodiscard]] cloud::ClosedLine place(std::span<const int> path, double of_line) const;
  [[nodiscard]] cloud::ClosedLine place(std::span<const double> path, double of_line) const;

 private:
  Surface(std::vector<Eigen::Vector3f> points, bite_line::PointRuns runs, bite_line::Workings workings,
          std::vector<bite_line::Candidate> candidates);

  [[nodiscard]] bite_line::ScanPoints points() const;

  std::vector<Eigen::Vector3f> points_;
  bite_line::PointRuns runs_;  ///< of these points
  bite_line::Side side_;
  bite_line::Large<float> likeness_, cost_;
  bite_line::Decision decision_;
  bite_line::PlacedLine placed_;  ///< of the first candidate; empty where it was not placed
  std::vector<bite_line::Candidate> candidates_;
};

}  // namespace biteline::mend
