// SPDX-License-Identifier: MIT
#pragma once
/// \file From points in plan to their feet on a closed curve: done for each point of a cloud, hence in single
/// precision and in vector lanes.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace biteline::bite_line {

/// A point in the coordinates of an outline.
struct OutlinePlace {
  float s_mm;  ///< negative: out of reach
  float o_mm;
  float z_mm;
};

class OutlineLookup {
 public:
  /// One place of the curve.
  struct Sample {
    float x_mm, y_mm;
    float normal_x, normal_y;
    float bend_per_mm;
  };
  /// What the vector code works on.
  struct Table {
    static constexpr float k_cell_mm = 2.0F;
    std::vector<Sample> samples;  ///< evenly spaced
    float length_mm{0};
    Eigen::Vector2f origin{Eigen::Vector2f::Zero()};
    int cols{0};
    int rows{0};
    std::vector<std::int32_t> nearest;  ///< sample nearest to each cell of the plan, -1 out of reach
  };

  OutlineLookup() = default;
  /// `samples` evenly spaced on a closed curve; `reach_mm`: how far inwards and outwards places are found.
  OutlineLookup(std::vector<Sample> samples, float length_mm, float reach_mm);

  /// The nearest cell's sample, then Newton steps to the foot of the perpendicular.
  void locate(std::span<const Eigen::Vector3f> points, std::span<OutlinePlace> places) const;

 private:
  Table table_;
};

}  // namespace biteline::bite_line
