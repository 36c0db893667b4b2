// SPDX-License-Identifier: MIT
#include <array>

#include "common/core/contracts.hpp"
#include "hal/sim/shoe/designed_parts.hpp"
#include "hal/sim/shoe/designed_shoe.hpp"

namespace biteline::sim {
namespace {

using Kind = Relief::Kind;

/// Body of a thing in a form: wall above and below a crease, all round.
void shape_thing(ShoeParameters& thing, OutlineForm form, Random::Interval breadth, Random& random) {
  thing.outline.form = form;
  thing.outline.width_ratio = random.uniform(breadth);
  thing.upper.lean_per_mm = 0;
}

}  // namespace

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
