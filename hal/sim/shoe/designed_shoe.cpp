// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/designed_shoe.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "hal/sim/shoe/designed_parts.hpp"

namespace biteline::sim {
namespace {

void draw_upper(ShoeParameters& shoe, Random& random, double scale) {
  UpperShape& upper = shoe.upper;
  const double height_scale = std::min(1.0, shoe.outline.length_mm / 260);
  double above_mm = height_scale * random.uniform({34, 48});
  upper.lean_per_mm = random.uniform({0.005, 0.009}) / scale;
  upper.bulge_u_mm = height_scale * random.uniform({7, 13});
  upper.texture_pitch_mm = random.uniform({1.6, 2.6});
  upper.texture_mm = random.chance(0.7) ? random.uniform({0.01, 0.04}) : 0.0;
  const bool high = shoe.shoe_class == ShoeClass::Boot || random.chance(0.3);
  if (shoe.shoe_class == ShoeClass::Pump) {
    upper.waist_drop_mm = above_mm * random.uniform({0.3, 0.5});
    upper.toe_drop_mm = above_mm * random.uniform({0.2, 0.4});
  } else if (high) {
    upper.shaft_u_mm = above_mm;
    upper.toe_drop_mm = height_scale * random.uniform({25, 60});
    above_mm += upper.toe_drop_mm;
  }
  upper.top_z_mm = shoe.groove.line_height_mm + above_mm;
  if (random.chance(0.4)) {
    upper.stitch_rows.push_back({.u_mm = height_scale * random.uniform({6, 12}),
                                 .height_mm = random.uniform({0.12, 0.3}),
                                 .pitch_mm = random.uniform({2.4, 3.6})});
  }
  for (int i = random.integer(0, 3); i > 0; --i) {
    upper.seams.push_back({.s_mm = random.uniform({0, perimeter_mm(shoe)}),
                           .slope_ratio = random.uniform({-1, 1}),
                           .height_mm = random.uniform({0.2, 0.6}),
                           .width_mm = random.uniform({0.6, 1.2})});
  }
}

Reflectance draw_reflectance(Materials materials, ShoeClass shoe_class, Random random) {
  const bool foamy = shoe_class == ShoeClass::Midsole || shoe_class == ShoeClass::Wedge;
  const Material sole = foamy ? foam(random) : rubber(random);
  if (materials == Materials::OneColour) return {.upper = sole, .sole = sole};
  const bool skin = shoe_class == ShoeClass::Welted || shoe_class == ShoeClass::Pump || random.chance(0.4);
  return {.upper = skin ? leather(random) : cloth(random), .sole = sole};
}

/// As two-colour soles are, and tapes, mudguards and counters.
void paint(ShoeParameters& shoe, Random random) {
  for (std::vector<Relief>* reliefs : {&shoe.sole.reliefs, &shoe.upper.reliefs}) {
    for (Relief& relief : *reliefs) {
      if (relief.kind == Relief::Kind::Ledge || relief.kind == Relief::Kind::Band)
        relief.material = rubber(random);
    }
  }
}

}  // namespace

Material foam(Random& random) {
  return {.diffuse_ratio = random.uniform({0.6, 0.95}),
          .grain_ratio = 0.03,
          .scattering_mm = random.uniform({0.05, 0.12}),
          .roughness_mm = 0.03};
}
Material rubber(Random& random) {
  return {.diffuse_ratio = random.uniform({0.2, 0.8}),
          .grain_ratio = 0.05,
          .scattering_mm = 0.02,
          .roughness_mm = 0.005,
          .polarised_ratio = 0.3};
}
Material leather(Random& random) {
  return {.diffuse_ratio = random.uniform({0.25, 0.8}),
          .grain_ratio = 0.1,
          .scattering_mm = 0.03,
          .roughness_mm = 0.015,
          .polarised_ratio = 0.2};
}
Material cloth(Random& random) {
  return {.diffuse_ratio = random.uniform({0.3, 0.85}),
          .grain_ratio = 0.25,
          .scattering_mm = random.uniform({0.04, 0.08}),
          .roughness_mm = 0.06};
}

OutlineShape draw_foot(Random random) {
  OutlineShape outline{.length_mm = random.uniform({90, 350}),
                       .width_ratio = random.uniform({0.9, 1.08}),
                       .left_foot = random.chance(0.5)};
  for (int i = 0; i < Outline::k_control_points; ++i) outline.jitter.push_back(0.01 * random.gaussian());
  return outline;
}

ShoeParameters draw_designed_shoe(const DesignedShoe& designed, std::uint64_t seed) {
  BITELINE_EXPECTS(is_designed(designed.shoe_class));
  const Random source(seed * 32 + static_cast<std::uint64_t>(designed.shoe_class));
  ShoeParameters shoe{
      .shoe_class = designed.shoe_class, .seed = seed, .outline = draw_foot(source.fork(k_outline))};
  shoe.outline.length_mm = designed.length_mm.value_or(shoe.outline.length_mm);
  // A child's sole is lower, but not in proportion to its length.
  const double scale = std::sqrt(shoe.outline.length_mm / 290);
  Random sole = source.fork(k_sole);
  draw_sole(shoe, sole, scale);
  if (designed.heel_ratio) shoe.groove.heel_lift_mm = *designed.heel_ratio * shoe.outline.length_mm;
  // A small shoe's sole stands out by less: its ends are too tight for more.
  shoe.groove.step_mm = std::min(shoe.groove.step_mm, shoe.outline.length_mm / 55);
  Random upper = source.fork(k_upper);
  draw_upper(shoe, upper, scale);
  add_decoy(shoe, designed.decoy, source.fork(k_decoy));
  Random second = source.fork(k_second);
  if (designed.decoy != Decoy::None && second.chance(0.25)) {
    const auto also = static_cast<Decoy>(second.integer(1, static_cast<int>(k_decoy_names.size()) - 1));
    if (also != designed.decoy) add_decoy(shoe, also, second.fork(k_decoy));
  }
  if (designed.toe_guard) add_toe_guard(shoe, source.fork(k_guard));
  shoe.reflectance = draw_reflectance(designed.materials, designed.shoe_class, source.fork(k_light));
  if (designed.painted) paint(shoe, source.fork(k_paint));
  return shoe;
}

}  // namespace biteline::sim
