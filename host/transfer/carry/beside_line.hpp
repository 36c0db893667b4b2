// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a scan a line that is carried on to it can meet.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "host/transfer/carry/carried_line.hpp"

namespace biteline::transfer {

/// The points, in their order, that any ray of carry_line() can come near: of a whole upper some tenth.
[[nodiscard]] std::vector<Eigen::Vector3f> points_beside(std::span<const Eigen::Vector3f> points,
                                                         const std::vector<PlacedPoint>& placed,
                                                         const CarryOptions& options);

}  // namespace biteline::transfer
