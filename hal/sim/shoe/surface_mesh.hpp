// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe as triangles: fine near the line, coarse elsewhere, closed by a roof.

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/core/result.hpp"
#include "hal/sim/shoe/made_shoe.hpp"

namespace biteline::sim {

/// Plain arrays, in the shoe's frame.  Triangles are anticlockwise seen from outside.
struct SurfaceMesh {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<SurfaceLook> looks;  ///< one for each vertex
};

/// The wall's facets leave the exact surface by at most spacing^2 * curvature / 8.
struct MeshFineness {
  double column_mm{0.35};    ///< along the outline
  double fine_row_mm{0.06};  ///< within fine_band_mm of the nominal line
  double fine_band_mm{4.5};
  double coarse_row_mm{0.25};
};

[[nodiscard]] SurfaceMesh mesh_of(const MadeShoe& shoe, const MeshFineness& fineness = {});

/// Places along the outline.
struct OutlinePart {
  double from_s_mm{0};
  double length_mm{0};
};
/// The columns of mesh_of() from the last before the part to the first behind it, open at both ends.
[[nodiscard]] SurfaceMesh mesh_of_part(const MadeShoe& shoe, const OutlinePart& part,
                                       const MeshFineness& fineness = {});

/// Binary PLY of vertices and triangles, moved by `T_frame_shoe`.
[[nodiscard]] Result<void> write_mesh_ply(const std::filesystem::path& file, const SurfaceMesh& mesh,
                                          const SE3& T_frame_shoe);

}  // namespace biteline::sim
