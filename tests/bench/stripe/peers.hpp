// SPDX-License-Identifier: MIT
#pragma once
/// \file What a user could put together instead: one sub-pixel row per column, -1 for none.

#include <cstdint>
#include <span>

namespace biteline::bench {

struct PeerFrame {
  const std::uint8_t* pixels{nullptr};
  int width_px{0};
  int height_px{0};
};

/// Sum of all bytes, vectorised and with software prefetch: as fast as one thread can read.
[[nodiscard]] std::uint64_t sum_of_bytes(std::span<const std::uint8_t> bytes);

/// Brightest pixel of each column (vectorised, one row-major pass), then centre of gravity of 17 rows around
/// it.
void argmax_and_gravity(const PeerFrame& frame, std::span<float> row_px);

/// OpenCV: Gaussian blur 5 x 5, brightest pixel by reduction, centre of gravity of 17 rows around it.
void opencv_gravity(const PeerFrame& frame, std::span<float> row_px);

/// Steger 1998, "An unbiased detector of curvilinear structures", on OpenCV's filters: Gaussian derivatives
/// of sigma = w / sqrt(3), eigenvectors of the Hessian, sub-pixel place along the normal; per column the
/// strongest response.
void opencv_steger(const PeerFrame& frame, double sigma_px, std::span<float> row_px);

}  // namespace biteline::bench
