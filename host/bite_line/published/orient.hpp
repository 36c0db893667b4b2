// SPDX-License-Identifier: MIT
#pragma once
/// \file One outside for all normals of a cloud.

#include <span>

#include <Eigen/Core>

#include "host/bite_line/published/neighbour_grid.hpp"

namespace biteline::published {

/// Flips normals (in grid order) so that neighbours agree: they spread from the outermost point over the
/// flattest connections first (Hoppe et al. 1992, "Surface reconstruction from unorganized points", 3.3, with
/// a grid's neighbours in place of the Riemannian graph).  In each connected part the outermost point's
/// normal points away from the cloud's middle. Single thread; about 1 us per point.
void orient_consistently(const NeighbourGrid& grid, std::span<Eigen::Vector3f> normals);

}  // namespace biteline::published
