// SPDX-License-Identifier: MIT
#include <algorithm>

#include "firmware/pipeline/triangulation_table.hpp"

namespace biteline::pipeline {

TriangulationTable::Point TriangulationTable::rt_point(int column, float row_px) const noexcept BITELINE_RT {
  const float position = std::clamp(row_px / static_cast<float>(k_rows_per_node), 0.0F,
                                    static_cast<float>(nodes_per_column_ - 1));
  const int node = std::min(static_cast<int>(position), nodes_per_column_ - 2);
  const Node* nodes = nodes_.data() +
                      static_cast<std::size_t>(column) * static_cast<std::size_t>(nodes_per_column_) +
                      static_cast<std::size_t>(node);
  // Cubic Hermite on [0, 1], written from the nearer node so that rounding stays that of small steps.
  const float t = position - static_cast<float>(node), s = 1 - t;
  const Eigen::Vector3f chord = nodes[1].point_cam - nodes[0].point_cam;
  const Eigen::Vector3f bend = s * (nodes[0].slope_mm - chord) - t * (nodes[1].slope_mm - chord);
  const Eigen::Vector3f point_cam = nodes[0].point_cam + t * (chord + s * bend);
  // d/dt of the same cubic, to first order: what sigma_row_px needs is good to a few percent.
  const Eigen::Vector3f slope = nodes[0].slope_mm + t * (nodes[1].slope_mm - nodes[0].slope_mm);
  return {.point_cam = point_cam, .mm_per_row = slope.norm() / static_cast<float>(k_rows_per_node)};
}

}  // namespace biteline::pipeline
