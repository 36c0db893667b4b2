// SPDX-License-Identifier: MIT
#pragma once
/// \file From a shoe's side to its line, by either method: what a finished cloud and a running scan share.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/bite_line/extract.hpp"
#include "host/bite_line/large.hpp"
#include "host/bite_line/side/side.hpp"
#include "host/bite_line/stage_clock.hpp"

namespace biteline::bite_line {

/// Points for the line's place, in shoe; how many there are for each point of the side.
struct RawPoints {
  Large<Eigen::Vector3f> points;
  double per_side_point{1};
};
/// The raw points behind points of the side, given by their indices.
using RawNear = std::function<RawPoints(std::span<const std::uint32_t>)>;

/// Fills `extraction`, whose T_base_shoe is set.  `cloud`: what the side was made of.
void find_line(const Side& side, const cloud::PointCloud& cloud, const ExtractConfig& config,
               const RawNear& raw_near, StageClock& clock, Extraction& extraction);

}  // namespace biteline::bite_line
