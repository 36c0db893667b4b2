// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/designed_shoe.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

using Kind = Relief::Kind;

/// Streams of random numbers, one per part.
enum Purpose : std::uint64_t { k_outline = 21, k_sole, k_upper, k_decoy, k_second, k_light };

/// A decoy's crease keeps so far below the line, and above the bottom.
constexpr double k_clear_mm = 4.0;
constexpr double k_foot_mm = 2.0;
/// Perimeter of a shoe of length 1; only the spread of things along it depends on it.
constexpr double k_perimeter_ratio = 2.13;

double perimeter_mm(const ShoeParameters& shoe) {
  return k_perimeter_ratio * shoe.outline.length_mm;
}

/// How far below the line the sole's wall goes down everywhere.
double room_mm(const ShoeParameters& shoe) {
  const double depth_mm =
      shoe.sole.thickness_mm > 0 ? shoe.sole.thickness_mm : shoe.groove.line_height_mm - shoe.groove.wave_mm;
  return depth_mm - k_foot_mm;
}

void draw_cupsole(ShoeParameters& shoe, Random& random, double scale) {
  shoe.groove = {.line_height_mm = scale * random.uniform({22, 34}),
                 .toe_rise_mm = scale * random.uniform({1, 4}),
                 .heel_rise_mm = scale * random.uniform({0, 4}),
                 .wave_mm = random.uniform({0.1, 0.4}),
                 .step_mm = random.uniform({0.8, 2.2}),
                 .depth_mm = random.uniform({0.3, 1.2}),
                 .width_mm = random.uniform({0.45, 0.8}),
                 .lip_u_mm = random.uniform({-0.9, -0.5}),
                 .lip_width_mm = random.uniform({0.25, 0.5})};
  shoe.sole.bulge_mm = random.uniform({0, 0.5});
  shoe.sole.flare_ratio = random.uniform({0, 0.08});
}

void draw_vulcanised(ShoeParameters& shoe, Random& random, double scale) {
  shoe.groove = {.line_height_mm = scale * random.uniform({24, 36}),
                 .toe_rise_mm = scale * random.uniform({3, 8}),
                 .heel_rise_mm = scale * random.uniform({0, 3}),
                 .wave_mm = random.uniform({0.1, 0.6}),
                 .step_mm = random.uniform({1.2, 3.0}),
                 .depth_mm = random.uniform({0, 0.8}),
                 .width_mm = random.uniform({0.5, 0.7}),
                 .lip_u_mm = random.uniform({-0.8, -0.5}),
                 .lip_width_mm = random.uniform({0.25, 0.5})};
  shoe.sole.bulge_mm = random.uniform({0, 0.3});
}

void draw_midsole(ShoeParameters& shoe, Random& random, double scale) {
  shoe.groove = {.line_height_mm = scale * random.uniform({20, 28}),
                 .toe_rise_mm = scale * random.uniform({2, 8}),
                 .heel_rise_mm = scale * random.uniform({6, 14}),
                 .wave_mm = random.uniform({0.3, 1.0}),
                 .step_mm = random.uniform({0.8, 3.5}),
                 .depth_mm = random.uniform({0.1, 1.5}),
                 .width_mm = random.uniform({0.5, 1.0}),
                 .lip_u_mm = random.uniform({-1.3, -0.8}),
                 .lip_width_mm = random.uniform({0.4, 0.8})};
  shoe.sole.bulge_mm = random.uniform({0.5, 2.0});
  shoe.sole.flare_ratio = random.uniform({0.08, 0.3});
}

void draw_welted(ShoeParameters& shoe, Random& random, double scale) {
  shoe.groove = {.line_height_mm = std::max(7.0, scale * random.uniform({8, 13})),
                 .toe_rise_mm = scale * random.uniform({1, 4}),
                 .heel_rise_mm = 0,
                 .heel_lift_mm = scale * random.uniform({10, 24}),
                 .wave_mm = random.uniform({0.1, 0.3}),
                 .step_mm = random.uniform({2.0, 5.0}),
                 .depth_mm = random.uniform({0, 0.8}),
                 .width_mm = random.uniform({0.5, 0.8}),
                 .lip_u_mm = random.uniform({-0.9, -0.6}),
                 .lip_width_mm = random.uniform({0.2, 0.4})};
  shoe.sole.bulge_mm = random.uniform({0, 0.3});
  shoe.sole.thickness_mm = shoe.groove.line_height_mm;
  shoe.sole.heel_block_ratio = random.uniform({0.22, 0.3});
  shoe.sole.heel_taper_ratio = random.uniform({0, 0.15});
  shoe.outline.waist_ratio = random.uniform({0.85, 1.0});
  shoe.outline.toe_ratio = random.uniform({0.8, 1.1});
}

void draw_boot(ShoeParameters& shoe, Random& random, double scale) {
  draw_cupsole(shoe, random, scale);
  shoe.groove.heel_lift_mm = random.chance(0.5) ? scale * random.uniform({3, 12}) : 0.0;
  shoe.groove.step_mm = random.uniform({1.5, 4.5});
  shoe.sole.lug_depth_mm = random.uniform({1.5, 4});
  shoe.sole.lug_count = static_cast<int>(perimeter_mm(shoe) / random.uniform({10, 22}));
  shoe.sole.lug_top_z_mm = random.uniform({5, 9}) * scale;
}

void draw_pump(ShoeParameters& shoe, Random& random, double scale) {
  shoe.groove = {.line_height_mm = random.uniform({5.5, 8}),
                 .toe_rise_mm = scale * random.uniform({0.5, 3}),
                 .heel_rise_mm = 0,
                 .heel_lift_mm = scale * random.uniform({25, 70}),
                 .wave_mm = random.uniform({0.05, 0.2}),
                 .step_mm = random.uniform({0.8, 2.0}),
                 .depth_mm = random.uniform({0.2, 0.7}),
                 .width_mm = random.uniform({0.45, 0.65}),
                 .lip_u_mm = random.uniform({-0.8, -0.6}),
                 .lip_width_mm = random.uniform({0.2, 0.35})};
  shoe.sole.bulge_mm = random.uniform({0, 0.2});
  shoe.sole.thickness_mm = shoe.groove.line_height_mm - random.uniform({0, 0.6});
  shoe.sole.heel_block_ratio = random.uniform({0.15, 0.24});
  shoe.sole.heel_taper_ratio = random.uniform({0.02, 0.2});
  shoe.outline.width_ratio *= random.uniform({0.84, 0.95});
  shoe.outline.waist_ratio = random.uniform({0.65, 0.85});
  shoe.outline.toe_ratio = random.uniform({0.7, 1.0});
}

void draw_wedge(ShoeParameters& shoe, Random& random, double scale) {
  draw_cupsole(shoe, random, scale);
  shoe.groove.line_height_mm = scale * random.uniform({32, 48});
  shoe.groove.heel_lift_mm = random.chance(0.6) ? scale * random.uniform({5, 28}) : 0.0;
  shoe.groove.step_mm = random.uniform({0.6, 2.0});
}

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

/// A piece laid on the upper from below the line, as mudguards and toe caps are, or above it.  What reaches
/// under the sole's edge takes from its step.
Relief overlay(const ShoeParameters& shoe, Random& random, double high_u_mm, Stretch where) {
  const bool tucked = random.chance(0.5);
  const double low_u_mm = tucked ? -8.0 : random.uniform({4.5, 7});
  const double most_mm = tucked ? 0.5 * shoe.groove.step_mm : 1.8;
  return {.kind = Kind::Band,
          .u_mm = 0.5 * (low_u_mm + high_u_mm),
          .height_mm = std::min(most_mm, random.uniform({0.8, 1.8})),
          .half_mm = 0.5 * (high_u_mm - low_u_mm),
          .edge_mm = random.uniform({0.15, 0.4}),
          .where = where};
}

void add_ledge(ShoeParameters& shoe, Random& random) {
  const double room = std::min(room_mm(shoe), 22.0);
  if (room < 7) return;
  Relief ledge{.kind = Kind::Ledge,
               .u_mm = -random.uniform({6, room}),
               .height_mm = random.uniform({1.5, 5}),
               .edge_mm = random.uniform({0.25, 0.8})};
  ledge.heel_rise_mm = random.uniform({0, std::min(4.0, -ledge.u_mm - k_clear_mm - 1)});
  if (random.chance(0.5)) {
    ledge.where = Stretch{.s_mm = 0,
                          .half_length_mm = perimeter_mm(shoe) * random.uniform({0.12, 0.3}),
                          .soft_mm = random.uniform({6, 20})};
  }
  shoe.sole.reliefs.push_back(ledge);
}

void add_stitch_groove(ShoeParameters& shoe, Random& random) {
  const double room = std::min(room_mm(shoe), 8.0);
  if (room < k_clear_mm) return;
  const Relief groove{.kind = Kind::Groove,
                      .u_mm = -random.uniform({k_clear_mm, room}),
                      .height_mm = -random.uniform({0.8, 2.2}),
                      .half_mm = random.uniform({0.5, 1.0})};
  shoe.sole.reliefs.push_back(groove);
  shoe.sole.reliefs.push_back({.kind = Kind::Periodic,
                               .u_mm = groove.u_mm,
                               .height_mm = -0.6 * groove.height_mm,
                               .half_mm = 0.6,
                               .edge_mm = 0.2,
                               .pitch_mm = random.uniform({4, 7}),
                               .duty_ratio = 0.6});
}

void add_foxing(ShoeParameters& shoe, Random& random) {
  const double room = room_mm(shoe);
  for (int i = random.integer(1, 3); i > 0; --i) {
    const double half = random.uniform({0.6, 2.0});
    if (room < k_clear_mm + 2 * half) continue;
    shoe.sole.reliefs.push_back({.kind = Kind::Band,
                                 .u_mm = -random.uniform({k_clear_mm + half, room - half}),
                                 .height_mm = random.uniform({0.2, 0.6}),
                                 .half_mm = half,
                                 .edge_mm = random.uniform({0.12, 0.25})});
  }
  const double half = random.uniform({3, 6});
  if (room < k_clear_mm + 2 * half + 1) return;
  shoe.sole.reliefs.push_back({.kind = Kind::Band,
                               .u_mm = -random.uniform({k_clear_mm + half, room - half}),
                               .height_mm = random.uniform({0.8, 1.6}),
                               .half_mm = half,
                               .edge_mm = random.uniform({0.15, 0.4})});
}

void add_toe_bumper(ShoeParameters& shoe, Random& random) {
  const Stretch toe{.s_mm = 0.5 * perimeter_mm(shoe),
                    .half_length_mm = perimeter_mm(shoe) * random.uniform({0.08, 0.18}),
                    .soft_mm = random.uniform({4, 10})};
  const double room = room_mm(shoe);
  if (room > 9) {
    const double high = -random.uniform({k_clear_mm, 7});
    const Relief bumper{.kind = Kind::Band,
                        .u_mm = 0.5 * (high - room),
                        .height_mm = random.uniform({1, 3}),
                        .half_mm = 0.5 * (high + room),
                        .edge_mm = random.uniform({0.2, 0.5}),
                        .where = toe};
    shoe.sole.reliefs.push_back(bumper);
    shoe.sole.reliefs.push_back({.kind = Kind::Periodic,
                                 .u_mm = bumper.u_mm,
                                 .height_mm = random.uniform({0.3, 0.7}),
                                 .half_mm = 0.8 * bumper.half_mm,
                                 .edge_mm = 0.25,
                                 .pitch_mm = random.uniform({3, 5}),
                                 .slant_ratio = random.uniform({-1, 1}),
                                 .where = toe});
  }
  const double scale = std::min(1.0, shoe.outline.length_mm / 260);
  if (room <= 9 || random.chance(0.6))
    shoe.upper.reliefs.push_back(overlay(shoe, random, scale * random.uniform({14, 26}), toe));
}

void add_heel_counter(ShoeParameters& shoe, Random& random) {
  const double scale = std::min(1.0, shoe.outline.length_mm / 260);
  const Stretch heel{.s_mm = 0,
                     .half_length_mm = perimeter_mm(shoe) * random.uniform({0.08, 0.2}),
                     .soft_mm = random.uniform({2, 8})};
  shoe.upper.reliefs.push_back(overlay(shoe, random, scale * random.uniform({16, 32}), heel));
}

void add_ribs(ShoeParameters& shoe, Random& random) {
  const double room = room_mm(shoe);
  if (room < k_clear_mm + 3) return;
  if (random.chance(0.5)) {
    const double half = 0.5 * (room - k_clear_mm);
    shoe.sole.reliefs.push_back({.kind = Kind::Periodic,
                                 .u_mm = -k_clear_mm - half,
                                 .height_mm = random.uniform({0.4, 1.5}) * (random.chance(0.5) ? 1.0 : -1.0),
                                 .half_mm = half,
                                 .edge_mm = random.uniform({0.2, 0.4}),
                                 .pitch_mm = random.uniform({3.5, 9}),
                                 .duty_ratio = random.uniform({0.35, 0.65}),
                                 .slant_ratio = random.chance(0.5) ? random.uniform({-0.7, 0.7}) : 0.0});
    return;
  }
  const double pitch = random.uniform({2.4, 4.5});
  const double depth = random.uniform({0.4, 1.1});
  const double half = random.uniform({0.4, 0.65});
  for (double u = -random.uniform({k_clear_mm, 6}); u > -room; u -= pitch)
    shoe.sole.reliefs.push_back({.kind = Kind::Groove, .u_mm = u, .height_mm = -depth, .half_mm = half});
}

void add_welt(ShoeParameters& shoe, Random& random) {
  const double room = std::min(room_mm(shoe), 6.0);
  if (room < k_clear_mm) return;
  shoe.sole.reliefs.push_back({.kind = Kind::Ledge,
                               .u_mm = -random.uniform({k_clear_mm, room}),
                               .height_mm = random.uniform({1.5, 4}),
                               .edge_mm = random.uniform({0.2, 0.5})});
}

void add_cut_outs(ShoeParameters& shoe, Random& random) {
  const double half = random.uniform({2.5, 5});
  const double room = room_mm(shoe);
  if (room < k_clear_mm + 2 * half) return;
  const double side = random.integer(0, 3) * 0.25;
  shoe.sole.reliefs.push_back(
      {.kind = Kind::Periodic,
       .u_mm = -random.uniform({k_clear_mm + half, room - half + 0.01}),
       .height_mm = -random.uniform({1.5, 5}),
       .half_mm = half,
       .edge_mm = random.uniform({0.3, 0.5}),
       .pitch_mm = random.uniform({14, 40}),
       .duty_ratio = random.uniform({0.3, 0.6}),
       .where = Stretch{.s_mm = side * perimeter_mm(shoe),
                        .half_length_mm = perimeter_mm(shoe) * random.uniform({0.1, 0.3}),
                        .soft_mm = 4}});
}

void add_logo(ShoeParameters& shoe, Random& random) {
  const double side = random.chance(0.5) ? 0.25 : 0.75;
  const double half = random.uniform({2.5, 4});
  const bool on_sole = room_mm(shoe) > k_clear_mm + 2 * half && random.chance(0.6);
  const double u_mm = on_sole ? -random.uniform({k_clear_mm + half, room_mm(shoe) - half})
                              : random.uniform({half + 5, half + 12});
  double s_mm = side * perimeter_mm(shoe);
  const double height_mm = random.uniform({0.4, 1.0});
  for (int letter = random.integer(3, 7); letter > 0; --letter) {
    const double half_letter = random.uniform({1.5, 3.5});
    s_mm += half_letter;
    (on_sole ? shoe.sole.reliefs : shoe.upper.reliefs)
        .push_back({.kind = Kind::Band,
                    .u_mm = u_mm + random.uniform({-0.5, 0.5}),
                    .height_mm = height_mm,
                    .half_mm = half * random.uniform({0.8, 1.0}),
                    .edge_mm = 0.2,
                    .where = Stretch{.s_mm = s_mm, .half_length_mm = half_letter, .soft_mm = 0.8}});
    s_mm += half_letter + random.uniform({1, 2});
  }
}

void add_multi_part(ShoeParameters& shoe, Random& random) {
  const double room = room_mm(shoe);
  if (room < 9) return;
  const double u_mm = -random.uniform({8, room});
  const double most_rise_mm = -u_mm - k_clear_mm - 0.5;
  const double heel_rise_mm = random.uniform({0, most_rise_mm});
  const double toe_rise_mm = random.uniform({0, most_rise_mm});
  shoe.sole.reliefs.push_back({.kind = Kind::Groove,
                               .u_mm = u_mm,
                               .height_mm = -random.uniform({0.5, 1.6}),
                               .half_mm = random.uniform({0.4, 0.8}),
                               .heel_rise_mm = heel_rise_mm,
                               .toe_rise_mm = toe_rise_mm});
  shoe.sole.reliefs.push_back({.kind = Kind::Ledge,
                               .u_mm = u_mm,
                               .height_mm = random.uniform({0.3, 2}),
                               .edge_mm = random.uniform({0.25, 0.6}),
                               .heel_rise_mm = heel_rise_mm,
                               .toe_rise_mm = toe_rise_mm});
}

void add_decoy(ShoeParameters& shoe, Decoy decoy, Random random) {
  switch (decoy) {
    case Decoy::None:
      return;
    case Decoy::Ledge:
      return add_ledge(shoe, random);
    case Decoy::StitchGroove:
      return add_stitch_groove(shoe, random);
    case Decoy::Foxing:
      return add_foxing(shoe, random);
    case Decoy::ToeBumper:
      return add_toe_bumper(shoe, random);
    case Decoy::HeelCounter:
      return add_heel_counter(shoe, random);
    case Decoy::Ribs:
      return add_ribs(shoe, random);
    case Decoy::Welt:
      return add_welt(shoe, random);
    case Decoy::CutOuts:
      return add_cut_outs(shoe, random);
    case Decoy::Logo:
      return add_logo(shoe, random);
    case Decoy::MultiPart:
      return add_multi_part(shoe, random);
  }
}

Material foam(Random& random) {
  return {.diffuse_ratio = random.uniform({0.6, 0.95}),
          .grain_ratio = 0.03,
          .scattering_mm = random.uniform({0.05, 0.12})};
}
Material rubber(Random& random) {
  return {.diffuse_ratio = random.uniform({0.2, 0.8}), .grain_ratio = 0.05, .scattering_mm = 0.02};
}
Material leather(Random& random) {
  return {.diffuse_ratio = random.uniform({0.25, 0.8}), .grain_ratio = 0.1, .scattering_mm = 0.03};
}
Material cloth(Random& random) {
  return {.diffuse_ratio = random.uniform({0.3, 0.85}),
          .grain_ratio = 0.25,
          .scattering_mm = random.uniform({0.04, 0.08})};
}

Reflectance draw_reflectance(Materials materials, ShoeClass shoe_class, Random random) {
  const bool foamy = shoe_class == ShoeClass::Midsole || shoe_class == ShoeClass::Wedge;
  const Material sole = foamy ? foam(random) : rubber(random);
  if (materials == Materials::OneColour) return {.upper = sole, .sole = sole};
  const bool skin = shoe_class == ShoeClass::Welted || shoe_class == ShoeClass::Pump || random.chance(0.4);
  return {.upper = skin ? leather(random) : cloth(random), .sole = sole};
}

OutlineShape draw_foot(Random random) {
  OutlineShape outline{.length_mm = random.uniform({90, 350}),
                       .width_ratio = random.uniform({0.9, 1.08}),
                       .left_foot = random.chance(0.5)};
  for (int i = 0; i < Outline::k_control_points; ++i) outline.jitter.push_back(0.01 * random.gaussian());
  return outline;
}

/// Body of a thing in a form: wall above and below a crease, all round.
void shape_thing(ShoeParameters& thing, OutlineForm form, Random::Interval breadth, Random& random) {
  thing.outline.form = form;
  thing.outline.width_ratio = random.uniform(breadth);
  thing.upper.lean_per_mm = 0;
}

}  // namespace

ShoeParameters draw_designed_shoe(const DesignedShoe& designed, std::uint64_t seed) {
  BITELINE_EXPECTS(is_designed(designed.shoe_class));
  const Random source(seed * 32 + static_cast<std::uint64_t>(designed.shoe_class));
  ShoeParameters shoe{
      .shoe_class = designed.shoe_class, .seed = seed, .outline = draw_foot(source.fork(k_outline))};
  shoe.outline.length_mm = designed.length_mm.value_or(shoe.outline.length_mm);
  // A child's sole is lower, but not in proportion to its length.
  const double scale = std::sqrt(shoe.outline.length_mm / 290);
  Random sole = source.fork(k_sole);
  switch (designed.shoe_class) {
    case ShoeClass::Vulcanised:
      draw_vulcanised(shoe, sole, scale);
      break;
    case ShoeClass::Midsole:
      draw_midsole(shoe, sole, scale);
      break;
    case ShoeClass::Welted:
      draw_welted(shoe, sole, scale);
      break;
    case ShoeClass::Boot:
      draw_boot(shoe, sole, scale);
      break;
    case ShoeClass::Pump:
      draw_pump(shoe, sole, scale);
      break;
    case ShoeClass::Wedge:
      draw_wedge(shoe, sole, scale);
      break;
    default:
      draw_cupsole(shoe, sole, scale);
      break;
  }
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
  shoe.reflectance = draw_reflectance(designed.materials, designed.shoe_class, source.fork(k_light));
  return shoe;
}

ShoeParameters draw_thing(ShoeClass shoe_class, std::uint64_t seed) {
  BITELINE_EXPECTS(is_thing(shoe_class));
  const Random source(seed * 32 + static_cast<std::uint64_t>(shoe_class));
  Random random = source.fork(k_sole);
  ShoeParameters thing{.shoe_class = shoe_class, .seed = seed, .outline = draw_foot(source.fork(k_outline))};
  thing.thing = true;
  thing.outline.jitter.clear();
  thing.sole.bulge_mm = 0;
  thing.groove = {.line_height_mm = random.uniform({8, 36}),
                  .toe_rise_mm = 0,
                  .heel_rise_mm = 0,
                  .wave_mm = 0,
                  .step_mm = random.uniform({0.5, 5}),
                  .depth_mm = random.chance(0.5) ? random.uniform({0.3, 2}) : 0.0,
                  .width_mm = random.uniform({0.5, 1}),
                  .lip_u_mm = random.uniform({-1, -0.6}),
                  .lip_width_mm = random.uniform({0.2, 0.6})};
  const bool lid = random.chance(0.4);
  switch (shoe_class) {
    case ShoeClass::Box:
      shape_thing(thing, OutlineForm::Box, {0.28, 0.6}, random);
      if (lid) thing.groove.step_mm = -random.uniform({0.5, 3});
      break;
    case ShoeClass::Tin:
      shape_thing(thing, OutlineForm::Oval, {0.3, 0.62}, random);
      if (lid) thing.groove.step_mm = -random.uniform({0.5, 2});
      thing.sole.reliefs.push_back(
          {.kind = Kind::Groove, .u_mm = -5, .height_mm = random.uniform({0.5, 1.5}), .half_mm = 0.8});
      break;
    case ShoeClass::Iron:
      shape_thing(thing, OutlineForm::Iron, {0.4, 0.55}, random);
      thing.groove.line_height_mm = random.uniform({7, 15});
      thing.upper.lean_per_mm = random.uniform({0.002, 0.006});
      thing.upper.bulge_u_mm = 0;
      break;
    case ShoeClass::Slide:
      thing.groove.line_height_mm = random.uniform({20, 34});
      thing.upper.strap_ratio = std::array{random.uniform({0.35, 0.5}), random.uniform({0.65, 0.8})};
      break;
    case ShoeClass::Bowl:
      shape_thing(thing, OutlineForm::Oval, {0.45, 0.62}, random);
      thing.groove.line_height_mm = random.uniform({7, 14});
      thing.upper.lean_per_mm = random.uniform({0.003, 0.006});
      thing.upper.bulge_u_mm = 50;
      break;
    case ShoeClass::Toy:
      shape_thing(thing, OutlineForm::Box, {0.35, 0.5}, random);
      thing.upper.lean_per_mm = random.uniform({0, 0.006});
      thing.sole.reliefs.push_back({.kind = Kind::Periodic,
                                    .u_mm = -thing.groove.line_height_mm,
                                    .height_mm = -random.uniform({2, 6}),
                                    .half_mm = 0.7 * thing.groove.line_height_mm,
                                    .pitch_mm = 0.5 * perimeter_mm(thing),
                                    .duty_ratio = 0.3});
      break;
    default:
      shape_thing(thing, random.chance(0.5) ? OutlineForm::Oval : OutlineForm::Box, {0.35, 0.62}, random);
      thing.groove.step_mm = random.uniform({0, 0.6});
      thing.groove.depth_mm = random.uniform({1, 3});
      break;
  }
  thing.upper.top_z_mm = thing.groove.line_height_mm + random.uniform({22, 60});
  thing.reflectance.upper = rubber(random);
  thing.reflectance.sole = random.chance(0.5) ? thing.reflectance.upper : rubber(random);
  return thing;
}

}  // namespace biteline::sim
