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
#include "hal/sim/shoe/worked_band.hpp"

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
  // Built as soles are built; each may carry any decoy.
  Cupsole,     ///< a rubber cup: upright wall, the upper glued and stitched into it
  Vulcanised,  ///< canvas with foxing tape round it
  Midsole,     ///< a runner's foam midsole, flared, lower at the toe
  Welted,      ///< a thin sole and a welt that stands out, a heel block, the shank off the ground
  Boot,        ///< a lug sole, a welt, a shaft
  Pump,        ///< a sole of a few millimetres, a high heel, the topline low
  Wedge,       ///< a platform as high as a hand is broad
  // No shoes: no line to find, whatever runs round them.
  Box,    ///< with a base or a lid
  Tin,    ///< oval, with a bead or a lid
  Iron,   ///< its soleplate stands out
  Slide,  ///< a foot's outline, a strap over the middle
  Bowl,   ///< flared, on a foot
  Toy,    ///< a car: bumper, wheels
  Dish,   ///< with a groove all round
};

inline constexpr std::array<std::string_view, 24> k_shoe_class_names{
    "deep",  "shallow", "step",    "filled",     "faded",   "decorated", "stitched", "glossy",
    "mixed", "bare",    "cupsole", "vulcanised", "midsole", "welted",    "boot",     "pump",
    "wedge", "box",     "tin",     "iron",       "slide",   "bowl",      "toy",      "dish"};

/// The first classes have a sole drawn from a formula, the next ones a designed one, the last are no shoes.
inline constexpr std::size_t k_plain_classes = 10, k_first_designed = 10, k_first_thing = 17;

/// What a sole or an upper carries besides its bite line.  Each is a closed or long crease of its own.
enum class Decoy : std::uint8_t {
  None,
  Ledge,         ///< the sole stands out by some millimetres below a shelf, all round or about the heel
  StitchGroove,  ///< a groove for the stitches that hold the cup, deeper than the bite line, stitches in it
  Foxing,        ///< tapes and pinstripes
  ToeBumper,     ///< a ribbed strip round the toe, a cap above it
  HeelCounter,   ///< a stiff piece on the heel of the upper
  Ribs,          ///< upright ribs or level ones
  Welt,          ///< a second ledge a few millimetres below the line
  CutOuts,       ///< windows in the sole's wall
  Logo,          ///< raised letters
  MultiPart,     ///< the sole in two parts that meet on a slant
};

inline constexpr std::array<std::string_view, 11> k_decoy_names{
    "none", "ledge", "stitch_groove", "foxing", "toe_bumper", "heel_counter",
    "ribs", "welt",  "cut_outs",      "logo",   "multi_part"};

[[nodiscard]] constexpr std::string_view name_of(Decoy decoy) {
  return k_decoy_names[static_cast<std::size_t>(decoy)];
}

/// What sole and upper look like to the sensor.
enum class Materials : std::uint8_t {
  Contrast,   ///< drawn from foam, rubber, leather, cloth; sole and upper differ
  OneColour,  ///< the same on both sides of the line
};

[[nodiscard]] constexpr std::string_view name_of(ShoeClass shoe_class) {
  return k_shoe_class_names[static_cast<std::size_t>(shoe_class)];
}
[[nodiscard]] std::optional<ShoeClass> shoe_class_named(std::string_view name);
[[nodiscard]] std::optional<Decoy> decoy_named(std::string_view name);
[[nodiscard]] constexpr bool is_thing(ShoeClass shoe_class) {
  return static_cast<std::size_t>(shoe_class) >= k_first_thing;
}
[[nodiscard]] constexpr bool is_designed(ShoeClass shoe_class) {
  return static_cast<std::size_t>(shoe_class) >= k_first_designed && !is_thing(shoe_class);
}

/// The crease itself.  In the section, with u the height above the nominal line:
///   o(u) = sole(u) + (upper(u) - sole(u)) * logistic((u - lip_u) / lip_width) - depth * valley(u)
struct Groove {
  double line_height_mm{26};  ///< nominal bite line above the sole's bottom, at the waist
  double toe_rise_mm{4};      ///< it rises towards toe and heel
  double heel_rise_mm{3};
  double heel_lift_mm{0};  ///< a raised heel: the line climbs by so much from the ball to the heel
  double wave_mm{0.3};     ///< slow irregular change along the line
  double step_mm{3};       ///< how far the sole's edge stands out from the upper at the line
  double depth_mm{2.5};    ///< valley beyond the step
  double width_mm{0.8};    ///< sigma of the valley
  double lip_u_mm{-1.0};   ///< where the sole's edge falls away
  double lip_width_mm{0.3};
};

/// A part of the line where something applies, with soft ends.
struct Stretch {
  double s_mm{0};
  double half_length_mm{10};
  double soft_mm{3};
};

/// What the stripe looks like on a material.
struct Material {
  double diffuse_ratio{0.6};  ///< share of light given back
  double grain_ratio{0};      ///< how much that differs from place to place, standard deviation
  double scattering_mm{0};    ///< light that wanders inside widens the stripe, standard deviation
  double roughness_mm{0.01};  ///< within what the lens resolves, standard deviation: for speckle
  double polarised_ratio{0};  ///< share of the laser's polarisation that comes back: for speckle
};

/// A part of the surface that stands out, or lies back, along the outline: ledges, grooves, tapes, ribs.
/// Its middle runs at `u_mm` above the line, risen towards heel and toe; `where` bounds it along the outline.
struct Relief {
  enum class Kind : std::uint8_t {
    Ledge,    ///< everything below u
    Groove,   ///< a valley of sigma `half_mm`, for height below 0; a bead for height above 0
    Band,     ///< from u - half to u + half
    Periodic  ///< a band of pieces along the outline, `pitch_mm` apart, of which `duty_ratio` is there
  };
  Kind kind{Kind::Ledge};
  double u_mm{-10};
  double height_mm{1};  ///< outwards
  double half_mm{3};
  double edge_mm{0.3};  ///< softness of its edges, logistic
  double heel_rise_mm{0};
  double toe_rise_mm{0};
  double pitch_mm{5};
  double duty_ratio{0.5};
  double slant_ratio{0};  ///< of a periodic one's pieces: change of s per u
  std::optional<Stretch> where{};
  std::optional<Material> material{};  ///< of a ledge or a band; none: of what it lies on
};

/// The sole wraps up over the upper, as a guard on the toe does: the line runs up one flank and down the
/// other, and below it there is no crease.
struct Guard {
  Stretch where{};  ///< its soft ends are the flanks
  double rise_mm{15};
};

struct SoleShape {
  std::optional<Guard> guard{};
  double bulge_mm{1.2};
  double flare_ratio{0};  ///< lower means farther out, by this share of the way down
  /// Of the sole at the line, where it does not stand on the table: 0, it reaches down everywhere.
  double thickness_mm{0};
  double heel_block_ratio{0.24};  ///< where the sole is off the table, a heel stands below this share of it
  double heel_taper_ratio{0.1};   ///< the heel block goes in by this share of the way down
  std::vector<Relief> reliefs{};
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
  double waist_drop_mm{0};  ///< how much lower its top is at the waist, as a pump's topline
  double toe_drop_mm{0};    ///< and at the toe, in front of a boot's shaft
  double shaft_u_mm{1e6};   ///< from here on the wall goes straight up, as a shaft does
  /// The upper is there between these shares of the length only: a strap.
  std::optional<std::array<double, 2>> strap_ratio{};
  std::vector<Relief> reliefs{};
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
  Material upper{};
  Material sole{.diffuse_ratio = 0.7};
};

struct ShoeParameters {
  ShoeClass shoe_class{ShoeClass::Deep};
  std::uint64_t seed{1};
  OutlineShape outline{};
  bool bare{false};   ///< the same upper without its sole: the wall runs smoothly to the bottom
  bool thing{false};  ///< no shoe: sole and upper are one body's lower and upper part
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
  std::optional<WorkedBand> worked{};  ///< laid on all that
};

/// A shoe of the class, drawn by the seed: left or right, all measures varied, 150 to 330 mm long, designed
/// soles 90 to 350 mm; things, too.  A designed sole carries the decoy that the seed draws.  With a length,
/// the same shoe so long; things stay as they are drawn.
[[nodiscard]] ShoeParameters draw_shoe(ShoeClass shoe_class, std::uint64_t seed,
                                       std::optional<double> length_mm = std::nullopt);

/// Of a sole of that size: two thirds of a centimetre each, the Paris point.  36 to 47 are grown-ups'.
[[nodiscard]] constexpr double length_of_size_mm(double eu_size) {
  return 20.0 / 3 * eu_size;
}

/// The next upper of the same model: without sole, differing as one last differs from the next.
[[nodiscard]] ShoeParameters bare_upper_of(ShoeParameters sample, double last_difference_mm,
                                           std::uint64_t last_seed);

}  // namespace biteline::sim
