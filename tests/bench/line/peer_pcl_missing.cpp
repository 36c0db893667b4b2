// SPDX-License-Identifier: MIT
#include "tests/bench/line/peers.hpp"

namespace biteline::bench::peers {

bool has_pcl() {
  return false;
}
Values pcl_curvature(std::span<const Eigen::Vector3f>, std::size_t, float) {
  return {};
}

}  // namespace biteline::bench::peers
