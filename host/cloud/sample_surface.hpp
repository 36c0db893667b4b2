// SPDX-License-Identifier: MIT
#pragma once
/// \file Points on a mesh, as a scan would have taken them.

#include <Eigen/Core>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/ply.hpp"

namespace biteline::cloud {

/// One point for each `spacing`² of the surface, spread evenly: the triangles' areas are walked along, and
/// within a triangle the points follow the R2 sequence (Roberts 2018), so that they neither clump nor line
/// up.  The same mesh gives the same points.  `spacing` > 0, in the mesh's unit.  Refuses a surface that
/// takes more than 50 million points, which no shoe does.
[[nodiscard]] Result<std::vector<Eigen::Vector3f>> sample_surface(const TriangleMesh& mesh, double spacing);

}  // namespace biteline::cloud
