// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoe's side surface as one picture: eight planes side by side, closed left to right.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/se3.hpp"

namespace biteline::published {

/// Row 0 is the top.  Left and right end are the same place of the shoe.
struct Unrolled {
  int rows{0};
  int cols{0};
  double row_mm{0};                  ///< height of a pixel
  double col_mm{0};                  ///< its length along the perimeter
  double top_mm{0};                  ///< height in shoe of the upper edge of row 0
  std::array<int, 8> section_col{};  ///< first column of the sections AB, BC, ... HA
  std::vector<float> value;          ///< mean curvature, 1/mm, row-major; 0 where unknown
  std::vector<unsigned char> known;  ///< 1 where the surface was seen

  [[nodiscard]] std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

/// The virtual cylinder: an octagon ABCDEFGH round the plan.  AB and EF are the long sides (left and right),
/// BC CD DE the heel, FG GH HA the toe; anticlockwise seen from above.
class EightSections {
 public:
  struct Config {
    double length_mm;
    double half_width_mm;
    double end_ratio{
        0.15};  ///< lambda: from heel and toe to the end sections, in shoe lengths; published 0.1 to 0.2
  };
  explicit EightSections(const Config& config);

  /// Place along the perimeter, 0 to perimeter_mm().  Points beside the long sides are projected square to
  /// them, those at the ends along rays from the end's middle, so that neighbouring sections meet without a
  /// jump.
  [[nodiscard]] double along_mm(double x_mm, double y_mm) const;
  [[nodiscard]] double perimeter_mm() const { return start_mm_.back(); }
  [[nodiscard]] double start_mm(std::size_t section) const { return start_mm_[section]; }

 private:
  std::array<Vec2, 9> corner_;  ///< A to H and A again
  std::array<double, 9> start_mm_{};
  double low_x_mm_;
  double high_x_mm_;
};

struct PixelPlace {
  int row{-1};
  int col{-1};
};

/// Which pixel a point in shoe falls on; row -1 outside the picture.
[[nodiscard]] PixelPlace pixel_of(const Unrolled& picture, const EightSections& sections,
                                  const Eigen::Vector3f& point);

struct UnrollConfig {
  double row_mm{0.5};
  double col_mm{1.0};
};

/// The picture of `feature` (one value per point in shoe): each pixel the mean of its points.  Pixels of
/// points keep their way back through pixel_of().
[[nodiscard]] Unrolled unroll(std::span<const Eigen::Vector3f> points, std::span<const float> feature,
                              const EightSections& sections, const UnrollConfig& config);

}  // namespace biteline::published
