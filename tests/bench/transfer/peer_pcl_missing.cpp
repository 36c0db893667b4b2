// SPDX-License-Identifier: MIT
#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {

bool has_pcl() {
  return false;
}
Eigen::Isometry3d pcl_align(const Problem&) {
  return Eigen::Isometry3d::Identity();
}

}  // namespace biteline::bench::peers
