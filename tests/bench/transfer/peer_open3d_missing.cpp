// SPDX-License-Identifier: MIT
#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {

bool has_open3d() {
  return false;
}
Eigen::Isometry3d open3d_align(const Problem&) {
  return Eigen::Isometry3d::Identity();
}

}  // namespace biteline::bench::peers
