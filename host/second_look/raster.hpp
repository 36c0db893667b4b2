// SPDX-License-Identifier: MIT
#pragma once
/// \file Two scans on one raster: along the line, and across it on the first scan's surface.

#include <array>
#include <cstddef>
#include <vector>

#include "host/cloud/point_cloud.hpp"
#include "host/second_look/line_frame.hpp"

namespace biteline::second_look {

/// What of a stripe is compared.  Logarithms: another light is a constant then.
enum Channel : std::size_t { k_height, k_log_amplitude, k_log_width, k_channels };
using Values = std::array<double, k_channels>;

/// Profiles farther apart could hide a gap of 2 mm between them.
inline constexpr double k_most_apart_mm = 2;
inline constexpr double k_cell_mm = 0.1;  ///< points of a profile 0.07 mm

/// Ways across, from `low_mm` up.
struct Across {
  double low_mm{0};
  std::size_t cells{0};
  [[nodiscard]] double mm(double cell) const { return low_mm + cell * k_cell_mm; }
};

/// Sums of the points of one scan, row by row.  A row is a station of the line, or a profile of the scan:
/// what a profile is off by is alike all across it.
struct Raster {
  std::vector<double> along_mm{};  ///< of each row on the line, rising
  Across across{};
  std::vector<float> count{};
  std::vector<std::array<float, k_channels>> sum{}, square_sum{};
  std::vector<float> clipped{};  ///< points as bright as the scan's brightest: how bright, nobody knows
  std::vector<float> across_sum_mm{}, along_sum_mm{};  ///< from the cell's middle, from the row's place

  [[nodiscard]] std::size_t rows() const { return along_mm.size(); }
  [[nodiscard]] std::size_t at(std::size_t row, std::size_t cell) const { return row * across.cells + cell; }
};

/// Points without an amplitude are left out where `stripe` counts.
struct RasterWish {
  double reach_mm{0};
  Across across{};
  bool stripe{false};
  bool by_profile{false};  ///< rows are profiles, else stations
};
/// Pre: `by_profile` only for a cloud that knows its profiles.
[[nodiscard]] Raster raster_of(const cloud::PointCloud& cloud, const LineFrame& frame,
                               const SurfaceWays& ways, const RasterWish& wish);

}  // namespace biteline::second_look
