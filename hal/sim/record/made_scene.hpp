// SPDX-License-Identifier: MIT
#pragma once
/// \file One made shoe on a table in front of one made head, ready to be looked at.

#include <filesystem>
#include <memory>

#include "hal/sim/motion/scan_path.hpp"
#include "hal/sim/render/stripe_renderer.hpp"
#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

struct SceneSettings {
  ShoeParameters shoe{};
  std::uint64_t place_seed{1};   ///< where the shoe stands
  std::uint64_t head_seed{21};
  double scan_speed_mm_s{100};
  double rate_hz{100};
  MeshFineness fineness{};
};

struct MadeScene {
  SceneSettings settings;
  MadeShoe shoe;
  SE3 T_base_shoe;
  MadeHead head;
  SurfaceMesh mesh;
  Scene scene;              ///< in the shoe's frame
  ScanPath path;
  std::vector<TrueLinePoint> line;  ///< empty: there is none
};

/// Half a millimetre between the points of the true line.
inline constexpr double k_true_line_spacing_mm = 0.5;

/// On the heap: renderers keep references into it.
[[nodiscard]] Result<std::unique_ptr<MadeScene>> make_scene(const SceneSettings& settings);

/// A place on the table in front of the arm, any yaw that the place's seed draws.
[[nodiscard]] SE3 draw_place(std::uint64_t seed);

/// truth/groove.csv (none for a shoe without line), truth/T_base_shoe.txt, truth/reference.ply.
[[nodiscard]] Result<void> write_truth(const std::filesystem::path& folder, const MadeScene& scene);

}  // namespace biteline::sim
