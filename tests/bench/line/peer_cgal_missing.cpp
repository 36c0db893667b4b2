// SPDX-License-Identifier: MIT
#include "tests/bench/line/peers.hpp"

namespace biteline::bench::peers {

bool has_cgal() {
  return false;
}
Values cgal_curvature(std::span<const Eigen::Vector3f>, std::size_t, float,
                      std::span<const Eigen::Vector3f>) {
  return {};
}

}  // namespace biteline::bench::peers
