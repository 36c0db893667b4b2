// SPDX-License-Identifier: MIT
#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {

bool has_small_gicp() {
  return false;
}
Eigen::Isometry3d small_gicp_align(const Problem&) {
  return Eigen::Isometry3d::Identity();
}

}  // namespace biteline::bench::peers
