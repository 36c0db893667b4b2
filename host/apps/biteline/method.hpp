// SPDX-License-Identifier: MIT
#pragma once
/// \file --method: how the line is found, for every command that looks for one.

#include "common/options/command.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/records/results/line_result.hpp"

namespace biteline::app {

enum class Method {
  Default,    ///< the cheapest closed curve in any direction, then placed in the raw points
  Published,  ///< greedy tracing of curvature pixels, joining, back-projection and thinning
};

void add_method_option(options::Command& command, Method& method);

struct FoundLine {
  bite_line::Extraction extraction;
  results::StageSource stages;
};
[[nodiscard]] FoundLine find_line(const cloud::PointCloud& cloud, Method method);

}  // namespace biteline::app
