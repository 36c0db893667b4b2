// SPDX-License-Identifier: MIT
#pragma once
/// \file What a process leaves on a made shoe: a band of film, or of ground surface, with its faults.
///
/// Ways across are along the surface and square to the true line, upwards > 0; straight up within 2 mm of it.
/// Ways along are the outline's, as in shoe_parameters.hpp.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace biteline::sim {

class MadeShoe;
class Section;
struct TrueLinePoint;

enum class Work : std::uint8_t {
  WetGlue,       ///< clear: darker, light wanders in it
  DryGlue,       ///< clear and thin
  ColouredGlue,  ///< covers what is below it
  Ground,        ///< taken off, brighter
  Roughed,       ///< taken off a little, rough
  Unseen,        ///< leaves nothing that a stripe shows
};
inline constexpr std::array<std::string_view, 6> k_work_names{"wet_glue", "dry_glue", "coloured_glue",
                                                              "ground",   "roughed",  "unseen"};

/// What a layer makes of the surface below it.
struct Film {
  double diffuse_factor{1};  ///< of the share of light given back
  double cover_ratio{0};     ///< of what is below, hidden by the layer's own colour
  double own_diffuse_ratio{0.5};
  double scattering_by_mm{0};  ///< added to the light's wandering
  double roughness_mm{0.01};
  double height_mm{0};  ///< as a stripe sees it; below 0: taken off
};

/// As the seed draws it, 0.05 to 0.3 mm high; dried glue 0.03 to 0.1 mm.
[[nodiscard]] Film draw_film(Work work, std::uint64_t seed);

/// One fault, at a place of the outline.
struct WorkFault {
  enum class Kind : std::uint8_t {
    Gap,     ///< nothing over the length
    Narrow,  ///< `by_mm` less at either edge that `low` and `high` name
    Wide,    ///< as much more
    Double,  ///< two layers over the length
    Drop     ///< round, `length_mm` across, its middle `by_mm` above the line
  };
  Kind kind{Kind::Gap};
  double s_mm{0};  ///< its middle
  double length_mm{5};
  double by_mm{0};
  bool low{true}, high{true};
};

struct BandPlan {
  double offset_mm{4};  ///< its middle, from the true line
  double width_mm{8};
  std::vector<WorkFault> faults{};
};

/// What lies where.
struct WorkedBand {
  struct Edges {
    double low_z_mm, high_z_mm;
  };
  struct Piece {
    double s_mm, half_mm;
  };
  struct Drop {
    double s_mm, z_mm, half_s_mm, half_z_mm;
  };
  Film film{};
  double perimeter_mm{1};
  std::vector<Edges> edges{};  ///< evenly spaced along the outline, from s = 0
  std::vector<float> laid{};   ///< layers at each of them; empty: one everywhere
  std::vector<Piece> gaps{}, doubled{};
  std::vector<Drop> drops{};
};

/// The band at one place of the outline.
struct BandHere {
  WorkedBand::Edges edges{};
  double layers{0};  ///< between the edges: 0 in a gap, 2 where doubled; in between over 0.2 mm
  std::vector<WorkedBand::Drop> drops{};  ///< with `half_z_mm` as high as they are here

  /// At a height of the section.
  [[nodiscard]] double layers_at(double z_mm) const;
};
[[nodiscard]] BandHere band_at(const WorkedBand& band, double s_mm);

/// Where the surface lies so far to either side of a height of this section, along the surface.
[[nodiscard]] WorkedBand::Edges edges_about(const Section& section, double z_mm, double half_width_mm);

/// The band of this plan.  `line` is the unworked shoe's, evenly spaced along the outline from s = 0.
[[nodiscard]] WorkedBand lay_band(const MadeShoe& unworked, std::span<const TrueLinePoint> line,
                                  const BandPlan& plan, const Film& film);

}  // namespace biteline::sim
