// SPDX-License-Identifier: MIT
#pragma once
/// \file A mesh as a scanner would see it: points on what is visible from outside, with noise.

#include <cstdint>

#include "host/cloud/ply.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

struct MeshScan {
  std::size_t points{300'000};
  double noise_mm{0.02};  ///< standard deviation along each axis
  std::uint32_t seed{1};
};

/// Points spread evenly over the surface; a point is seen when nothing lies in front of it, by more than half
/// a millimetre, from some direction all round and at 0 or 25 degrees from above.
[[nodiscard]] cloud::PointCloud scan_mesh(const cloud::TriangleMesh& mesh, const MeshScan& scan);

}  // namespace biteline::test
