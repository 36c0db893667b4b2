// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a line lies on the cloud that it is said to come from.

#include "host/robot/path/checks/line_check.hpp"

namespace biteline::path {

/// A line that was shifted, bent or found in another scan leaves the surface.  What no camera saw has no
/// points: so a share of the line may be away from all of them, where it bridges a gap.  Pre: check_line()
/// passed. Cost: one look-up for each point of the cloud.
[[nodiscard]] Check check_on_cloud(const cloud::ClosedLine& line, const std::vector<Eigen::Vector3f>& cloud);

}  // namespace biteline::path
