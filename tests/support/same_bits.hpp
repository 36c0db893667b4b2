// SPDX-License-Identifier: MIT
#pragma once
/// \file Profile points compared bit by bit.

#include <bit>
#include <cstdint>

#include "common/profile/profile.hpp"

namespace biteline::test {

/// All of a point that no clock enters, bit by bit; sigma_mm also holds the pose's scatter.
[[nodiscard]] inline bool same_bits(const profile::ProfilePoint& a, const profile::ProfilePoint& b) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return bits(a.point_cam.x()) == bits(b.point_cam.x()) && bits(a.point_cam.y()) == bits(b.point_cam.y()) &&
         bits(a.point_cam.z()) == bits(b.point_cam.z()) && bits(a.row_px) == bits(b.row_px) &&
         bits(a.sigma_row_px) == bits(b.sigma_row_px) && bits(a.amplitude) == bits(b.amplitude) &&
         bits(a.width_px) == bits(b.width_px) && a.column == b.column && a.flags == b.flags &&
         a.peak_count == b.peak_count;
}

}  // namespace biteline::test
