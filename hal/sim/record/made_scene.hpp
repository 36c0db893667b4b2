// SPDX-License-Identifier: MIT
#pragma once
/// \file One made shoe on a table in front of one made head, ready to be looked at.

#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>

#include "hal/sim/motion/scan_path.hpp"
#include "hal/sim/render/stripe_renderer.hpp"
#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

/// Where on the table shoes may stand: the middle of the sole, and the way the toe points.
struct PlaceRange {
  Random::Interval x_mm{450, 550};
  Random::Interval y_mm{-100, 100};
  Random::Interval z_mm{20, 60};
  Random::Interval yaw_rad{-std::numbers::pi, std::numbers::pi};
};

/// Places where the arm (ur3e, ur5e, ur10e) gets its tool all the way round a common shoe.  Found by planning
/// with the grinding process over a grid of places: beside the arm, toe to the side; the UR3e is too short
/// for a grown-up's shoe.
[[nodiscard]] PlaceRange places_within_reach_of(std::string_view arm);

/// What a process did to the shoe before it is scanned.
struct WorkDone {
  Work work{Work::WetGlue};
  std::uint64_t film_seed{1};
  BandPlan plan{};
};

struct SceneSettings {
  ShoeParameters shoe{};  ///< as it was before any work
  std::optional<WorkDone> work{};
  bool will_be_worked{false};   ///< its mesh is as fine as a film's edges from the beginning
  std::uint64_t place_seed{1};  ///< where the shoe stands
  PlaceRange places{};
  std::uint64_t head_seed{21};
  Holder holder{Holder::Straight};
  double scan_speed_mm_s{100};
  double scan_begin_ratio{0};  ///< of the way round, from the heel, anticlockwise: where the scan begins
  bool scan_clockwise{false};  ///< on the arm: the other way round, so that a path turns the wrist back
  double rate_hz{100};
  double ambient_grey{0};  ///< of the room's light, at the head's own exposure
  HeadLight light{};
  CheckLap check{};          ///< the scan's ends overlap, differently held
  bool surroundings{false};  ///< table, plate and pins; else the shoe hangs in the dark
  MeshFineness fineness{};
};

/// Shoe, place and line of a scene: what needs no light.
struct PlacedShoe {
  MadeShoe shoe;
  SE3 T_base_shoe;
  std::vector<TrueLinePoint> line;  ///< empty: there is none; of the shoe before it was worked
};
[[nodiscard]] PlacedShoe place_shoe(const SceneSettings& settings);
/// What rays meet of a shoe, with what it stands on where the settings have that; first the shoe alone.
struct SceneMeshes {
  SurfaceMesh shoe, all;
};
[[nodiscard]] SceneMeshes meshes_of(const MadeShoe& shoe, const SceneSettings& settings);

struct MadeScene : PlacedShoe {
  SceneSettings settings;
  MadeHead head;
  SurfaceMesh mesh;  ///< of the shoe alone
  Scene scene;       ///< in the shoe's frame
  ScanPath path;
};

/// Half a millimetre between the points of the true line.
inline constexpr double k_true_line_spacing_mm = 0.5;

/// On the heap: renderers keep references into it.
[[nodiscard]] Result<std::unique_ptr<MadeScene>> make_scene(const SceneSettings& settings);

[[nodiscard]] SE3 draw_place(std::uint64_t seed, const PlaceRange& range, double shoe_length_mm);

/// truth/groove.csv (none for a shoe without line), truth/T_base_shoe.txt, truth/worked.csv (of a worked one:
/// both edges beside each point of the line, and whether anything lies between them).
[[nodiscard]] Result<void> write_line_truth(const std::filesystem::path& folder, const PlacedShoe& placed);
/// These and truth/reference.ply: the whole surface, or that part of it.
[[nodiscard]] Result<void> write_truth(const std::filesystem::path& folder, const MadeScene& scene,
                                       const std::optional<OutlinePart>& part = std::nullopt);

}  // namespace biteline::sim
