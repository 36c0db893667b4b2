// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/shoe_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sim/shoe/designed_shoe.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

/// Streams of random numbers, one per part of the shoe.
enum Purpose : std::uint64_t { k_outline = 1, k_groove, k_stretches, k_sole, k_upper, k_gloss, k_light };

/// Perimeter of a shoe of length 1, for placing things before the outline exists; only their spread depends
/// on it.
constexpr double k_perimeter_ratio = 2.13;

OutlineShape draw_outline(Random random) {
  OutlineShape outline{.length_mm = random.uniform({150, 330}),
                       .width_ratio = random.uniform({0.92, 1.08}),
                       .left_foot = random.chance(0.5),
                       .jitter = {}};
  for (int i = 0; i < Outline::k_control_points; ++i) outline.jitter.push_back(0.012 * random.gaussian());
  return outline;
}

Groove draw_groove(ShoeClass shoe_class, Random random, double scale) {
  Groove groove{.line_height_mm = scale * random.uniform({22, 30}),
                .toe_rise_mm = scale * random.uniform({2, 6}),
                .heel_rise_mm = scale * random.uniform({1, 5}),
                .wave_mm = random.uniform({0.1, 0.4}),
                .step_mm = random.uniform({2.5, 4.5}),
                .depth_mm = random.uniform({2.0, 3.2}),
                .width_mm = random.uniform({0.7, 1.1}),
                .lip_u_mm = random.uniform({-1.3, -0.9}),
                .lip_width_mm = random.uniform({0.25, 0.38})};
  if (shoe_class == ShoeClass::Shallow) {
    groove.step_mm = random.uniform({0.1, 0.4});
    groove.depth_mm = random.uniform({0.27, 0.40});
    groove.width_mm = random.uniform({0.45, 0.65});
    groove.lip_u_mm = -groove.width_mm;
  } else if (shoe_class == ShoeClass::Step) {
    groove.step_mm = random.uniform({1.2, 3.0});
    groove.depth_mm = 0;
    groove.lip_u_mm = random.uniform({-0.9, -0.6});
  } else if (shoe_class == ShoeClass::Faded || shoe_class == ShoeClass::Decorated) {
    groove.step_mm = random.uniform({1.2, 3.0});
    groove.depth_mm = random.uniform({1.0, 2.2});
  } else if (shoe_class == ShoeClass::Mixed) {
    groove.step_mm = random.uniform({0.6, 4.0});
    groove.depth_mm = random.chance(0.25) ? 0.0 : random.uniform({0.4, 2.8});
    groove.width_mm = random.uniform({0.55, 1.1});
  }
  return groove;
}

/// `count` stretches that keep away from each other: one in each of `count` equal parts of the outline.
std::vector<Stretch> draw_stretches(Random& random, double perimeter_mm, int count,
                                    Random::Interval half_length_mm) {
  std::vector<Stretch> stretches;
  const double part_mm = perimeter_mm / count;
  for (int i = 0; i < count; ++i) {
    stretches.push_back({.s_mm = part_mm * (i + random.uniform({0.25, 0.75})),
                         .half_length_mm = std::min(random.uniform(half_length_mm), 0.2 * part_mm),
                         .soft_mm = random.uniform({2, 4})});
  }
  return stretches;
}

void decorate_sole(SoleShape& sole, Random& random, double perimeter_mm, double line_height_mm) {
  const double deepest_u_mm = -(line_height_mm - 7);  // stay above the lugs
  double u_mm = -random.uniform({7.5, 9.5});
  for (int i = random.integer(1, 3); i > 0 && u_mm > deepest_u_mm; --i) {
    sole.parallel_grooves.push_back(
        {.u_mm = u_mm, .depth_mm = random.uniform({0.4, 1.2}), .width_mm = random.uniform({0.4, 0.7})});
    u_mm -= random.uniform({2.5, 4.0});
  }
  if (random.chance(0.6)) {
    const double high_u_mm = -random.uniform({4.5, 6.0});
    sole.foxing = SoleShape::Band{.low_u_mm = high_u_mm - random.uniform({4, 8}),
                                  .high_u_mm = high_u_mm,
                                  .height_mm = random.uniform({0.3, 0.8})};
  }
  if (random.chance(0.7)) {
    sole.lug_depth_mm = random.uniform({0.8, 1.8});
    sole.lug_count = static_cast<int>(perimeter_mm / random.uniform({8, 13}));
    sole.lug_top_z_mm = random.uniform({3.5, 5.5});
  }
}

void stitch_upper(UpperShape& upper, Random& random, double perimeter_mm) {
  double u_mm = random.uniform({5.0, 7.0});
  for (int i = random.integer(1, 3); i > 0; --i) {
    upper.stitch_rows.push_back(
        {.u_mm = u_mm, .height_mm = random.uniform({0.12, 0.3}), .pitch_mm = random.uniform({2.4, 3.6})});
    u_mm += random.uniform({1.8, 4.0});
  }
  if (random.chance(0.5)) {
    upper.parallel_seams.push_back({.u_mm = u_mm + random.uniform({1.5, 5}),
                                    .depth_mm = random.uniform({0.15, 0.4}),
                                    .width_mm = random.uniform({0.4, 0.7})});
  }
  const int seam_count = random.integer(1, 4);
  for (int i = 0; i < seam_count; ++i) {
    upper.seams.push_back({.s_mm = perimeter_mm * (i + random.uniform({0.2, 0.8})) / seam_count,
                           .slope_ratio = random.uniform({-1, 1}),
                           .height_mm = random.uniform({0.25, 0.6}),
                           .width_mm = random.uniform({0.6, 1.2})});
  }
  for (const double side : {0.25, 0.75}) {
    if (!random.chance(0.7)) continue;
    upper.swooshes.push_back({.s_mm = perimeter_mm * (side + random.uniform({-0.05, 0.05})),
                              .half_length_mm = perimeter_mm * random.uniform({0.05, 0.09}),
                              .u_mm = random.uniform({8, 12}),
                              .bend_per_mm = random.uniform({0.004, 0.01}),
                              .half_width_mm = random.uniform({2, 3.5}),
                              .height_mm = random.uniform({0.25, 0.5})});
  }
}

}  // namespace

std::optional<ShoeClass> shoe_class_named(std::string_view name) {
  const auto* found = std::find(k_shoe_class_names.begin(), k_shoe_class_names.end(), name);
  if (found == k_shoe_class_names.end()) return std::nullopt;
  return static_cast<ShoeClass>(found - k_shoe_class_names.begin());
}

std::optional<Decoy> decoy_named(std::string_view name) {
  const auto* found = std::find(k_decoy_names.begin(), k_decoy_names.end(), name);
  if (found == k_decoy_names.end()) return std::nullopt;
  return static_cast<Decoy>(found - k_decoy_names.begin());
}

ShoeParameters draw_shoe(ShoeClass shoe_class, std::uint64_t seed, std::optional<double> length_mm) {
  if (is_thing(shoe_class)) return draw_thing(shoe_class, seed);
  if (is_designed(shoe_class)) {
    Random drawn(seed);
    const auto decoy = static_cast<Decoy>(drawn.integer(0, static_cast<int>(k_decoy_names.size()) - 1));
    return draw_designed_shoe({.shoe_class = shoe_class, .decoy = decoy, .length_mm = length_mm}, seed);
  }
  const Random source(seed * 16 + static_cast<std::uint64_t>(shoe_class));
  const bool mixed = shoe_class == ShoeClass::Mixed;
  ShoeParameters shoe{.shoe_class = shoe_class, .seed = seed, .bare = shoe_class == ShoeClass::Bare};

  shoe.outline = draw_outline(source.fork(k_outline));
  shoe.outline.length_mm = length_mm.value_or(shoe.outline.length_mm);
  const double perimeter_mm = k_perimeter_ratio * shoe.outline.length_mm;
  // A child's sole is lower, but not in proportion to its length.
  const double scale = std::sqrt(shoe.outline.length_mm / 290);
  shoe.groove = draw_groove(shoe_class, source.fork(k_groove), scale);

  Random stretches = source.fork(k_stretches);
  if (shoe_class == ShoeClass::Filled || (mixed && stretches.chance(0.4))) {
    shoe.filled = draw_stretches(stretches, perimeter_mm, stretches.integer(1, 4), {4, 14});
  }
  if (shoe_class == ShoeClass::Faded || (mixed && stretches.chance(0.3))) {
    shoe.faded = draw_stretches(stretches, perimeter_mm, stretches.integer(1, 2), {15, 30});
    for (auto& stretch : shoe.faded) stretch.soft_mm = stretches.uniform({10, 20});
  }

  Random sole = source.fork(k_sole);
  shoe.sole.bulge_mm = sole.uniform({0.3, 1.6});
  if (shoe_class == ShoeClass::Decorated || (mixed && sole.chance(0.5))) {
    decorate_sole(shoe.sole, sole, perimeter_mm, shoe.groove.line_height_mm);
  }

  Random upper = source.fork(k_upper);
  shoe.upper.top_z_mm = shoe.groove.line_height_mm + scale * upper.uniform({32, 46});
  shoe.upper.lean_per_mm = upper.uniform({0.005, 0.009}) / scale;
  shoe.upper.bulge_u_mm = upper.uniform({7, 13});
  shoe.upper.texture_pitch_mm = upper.uniform({1.6, 2.6});
  shoe.upper.texture_mm = upper.chance(0.7) ? upper.uniform({0.01, 0.04}) : 0.0;
  // Texture as strong as the groove is one surface, not a shoe: keep the weave below the crease.
  if (shoe_class == ShoeClass::Shallow) shoe.upper.texture_mm *= 0.4;
  if (shoe_class == ShoeClass::Stitched || (mixed && upper.chance(0.5)))
    stitch_upper(shoe.upper, upper, perimeter_mm);

  Random gloss = source.fork(k_gloss);
  if (shoe_class == ShoeClass::Glossy || (mixed && gloss.chance(0.4))) {
    for (int i = gloss.integer(3, 7); i > 0; --i) {
      shoe.gloss.push_back({.s_mm = gloss.uniform({0, perimeter_mm}),
                            .u_mm = gloss.uniform({-10, 18}),
                            .half_length_mm = gloss.uniform({3, 14}),
                            .half_height_mm = gloss.uniform({2, 8})});
    }
  }

  Random light = source.fork(k_light);
  shoe.reflectance.upper.diffuse_ratio = light.uniform({0.35, 0.85});
  shoe.reflectance.sole.diffuse_ratio = light.uniform({0.45, 0.95});
  return shoe;
}

ShoeParameters bare_upper_of(ShoeParameters sample, double last_difference_mm, std::uint64_t last_seed) {
  sample.bare = true;
  sample.last_difference_mm = last_difference_mm;
  sample.last_seed = last_seed;
  return sample;
}

}  // namespace biteline::sim
