// SPDX-License-Identifier: MIT
#include <algorithm>

#include "hal/sim/shoe/designed_parts.hpp"

namespace biteline::sim {
namespace {

using Kind = Relief::Kind;

/// A decoy's crease keeps so far below the line, and above the bottom.
constexpr double k_clear_mm = 4.0;
constexpr double k_foot_mm = 2.0;

/// How far below the line the sole's wall goes down everywhere.
double room_mm(const ShoeParameters& shoe) {
  const double depth_mm =
      shoe.sole.thickness_mm > 0 ? shoe.sole.thickness_mm : shoe.groove.line_height_mm - shoe.groove.wave_mm;
  return depth_mm - k_foot_mm;
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

}  // namespace

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

}  // namespace biteline::sim
