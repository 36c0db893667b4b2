// SPDX-License-Identifier: MIT
#pragma once
/// \file What a made shoe is made of, and the classes of shoes that are drawn by seed.
///
/// Heights `_u_mm` are above the nominal bite line, places `_s_mm` along the outline from the heel,
/// anticlockwise.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/sim/shoe/outline.hpp"

namespace biteline::sim {

enum class ShoeClass : std::uint8_t {
  Deep,       ///< sole stands out, deep groove
  Shallow,    ///< flush sole, groove of about 0.3 mm
  Step,       ///< the sole's edge stands out, no groove beside the corner
  Filled,     ///< deep, some stretches filled up (cement, dirt)
  Faded,      ///< groove and step fade away over some stretches
  Decorated,  ///< sole with closed parallel grooves, foxing stripe, tread lugs
  Stitched,   ///< upper with stitch rows, a parallel seam, seams running into the groove, swooshes
  Glossy,     ///< patches that the scanner cannot see
  Mixed,      ///< some of everything
  Bare,       ///< an upper on its last without a sole: one smooth wall, no bite line
};

inline constexpr std::array<std::string_view, 10> k_shoe_class_names{
    "deep", "shallow", "step", "filled", "faded", "decorated", "stitched", "glossy", "mixed", "bare"};

[[nodiscard]] constexpr std::string_view name_of(ShoeClass shoe_class) {
  return k_shoe_class_names[static_cast<std::size_t>(shoe_class)];
}
[[nodiscard]] std::optional<ShoeClass> shoe_class_named(std::string_view name);

/// The crease itself.  In the section, with u the height above the nominal line:
///   o(u) = sole(u) + (upper(u) - sole(u)) * logistic((u - lip_u) / lip_width) - depth * valley(u)
struct Groove {
  double line_height_mm{26};  ///< nominal bite line above the sole's bottom, at the waist
  double toe_rise_mm{4};      ///< it rises towards toe and heel
  double heel_rise_mm{3};
  double wave_mm{0.3};    ///< slow irregular change along the line
  double step_mm{3};      ///< how far the sole's edge stands out from the upper at the line
  double depth_mm{2.5};   ///< valley beyond the step
  double width_mm{0.8};   ///< sigma of the valley
  double lip_u_mm{-1.0};  ///< where the sole's edge falls away
  double lip_width_mm{0.3};
};

/// A part of the line where something applies, with soft ends.
struct Stretch {
  double s_mm{0};
  double half_length_mm{10};
  double soft_mm{3};
};

struct SoleShape {
  double bulge_mm{1.2};
  struct ParallelGroove {
    double u_mm{-9};
    double depth_mm{0.8};
    double width_mm{0.5};
  };
  std::vector<ParallelGroove> parallel_grooves{};
  struct Band {  ///< foxing stripe: a raised band
    double low_u_mm{-10};
    double high_u_mm{-6};
    double height_mm{0.6};
  };
  std::optional<Band> foxing{};
  double lug_depth_mm{0};  ///< tread lugs along the bottom edge, 0: none
  int lug_count{0};
  double lug_top_z_mm{5};
};

struct UpperShape {
  double top_z_mm{64};
  double lean_per_mm{0.0079};  ///< wall = lean * (2 * bulge_u * u - u^2): out to bulge_u, then in
  double bulge_u_mm{11};
  struct StitchRow {
    double u_mm{6};
    double height_mm{0.2};
    double pitch_mm{3};
  };
  std::vector<StitchRow> stitch_rows{};
  struct ParallelSeam {  ///< a closed shallow valley around the upper: a decoy
    double u_mm{9};
    double depth_mm{0.3};
    double width_mm{0.5};
  };
  std::vector<ParallelSeam> parallel_seams{};
  struct Seam {  ///< a ridge running down the upper into the groove
    double s_mm{0};
    double slope_ratio{0};  ///< change of s per u
    double height_mm{0.5};
    double width_mm{0.8};
  };
  std::vector<Seam> seams{};
  struct Swoosh {  ///< a curved raised band on one side
    double s_mm{0};
    double half_length_mm{35};
    double u_mm{6};  ///< height of its middle line at s
    double bend_per_mm{0.006};
    double half_width_mm{3};
    double height_mm{0.45};
  };
  std::vector<Swoosh> swooshes{};
  double texture_mm{0};  ///< weave, amplitude
  double texture_pitch_mm{2};
};

/// An ellipse on the surface that throws the laser's light away from the camera.
struct GlossPatch {
  double s_mm{0};
  double u_mm{0};
  double half_length_mm{10};
  double half_height_mm{4};
};

struct Reflectance {
  double upper_ratio{0.6};  ///< diffuse share of light given back
  double sole_ratio{0.7};
};

struct ShoeParameters {
  ShoeClass shoe_class{ShoeClass::Deep};
  std::uint64_t seed{1};
  OutlineShape outline{};
  bool bare{false};  ///< the same upper without its sole: the wall runs smoothly to the bottom
  /// One last differs from the next: a slow change of the whole wall, sum of a few waves of this amplitude.
  double last_difference_mm{0};
  std::uint64_t last_seed{0};
  Groove groove{};
  std::vector<Stretch> filled{};
  std::vector<Stretch> faded{};
  SoleShape sole{};
  UpperShape upper{};
  std::vector<GlossPatch> gloss{};
  Reflectance reflectance{};
};

/// A shoe of the class, drawn by the seed: size 150 to 330 mm, left or right, all measures varied.
[[nodiscard]] ShoeParameters draw_shoe(ShoeClass shoe_class, std::uint64_t seed);

/// The next upper of the same model: without sole, differing as one last differs from the next.
[[nodiscard]] ShoeParameters bare_upper_of(ShoeParameters sample, double last_difference_mm,
                                           std::uint64_t last_seed);

}  // namespace biteline::sim
