// SPDX-License-Identifier: MIT
#include <algorithm>

#include "hal/sim/shoe/designed_parts.hpp"

namespace biteline::sim {
namespace {

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

}  // namespace

void add_toe_guard(ShoeParameters& shoe, Random random) {
  constexpr double k_least_rise_mm = 6, k_upper_left_mm = 10;
  const double room_mm =
      shoe.upper.top_z_mm - shoe.upper.toe_drop_mm - shoe.groove.line_height_mm - k_upper_left_mm;
  const double rise_mm = std::min(random.uniform({k_least_rise_mm, 22}), room_mm);
  const double slope = random.uniform({0.8, 6});  // up to 80 degrees
  const double half_ratio = random.uniform({0.025, 0.09});
  if (rise_mm < k_least_rise_mm) return;
  shoe.sole.guard = Guard{.where = {.s_mm = 0.5 * perimeter_mm(shoe),
                                    .half_length_mm = half_ratio * perimeter_mm(shoe),
                                    .soft_mm = rise_mm / slope},
                          .rise_mm = rise_mm};
}

void draw_sole(ShoeParameters& shoe, Random& random, double scale) {
  switch (shoe.shoe_class) {
    case ShoeClass::Vulcanised:
      return draw_vulcanised(shoe, random, scale);
    case ShoeClass::Midsole:
      return draw_midsole(shoe, random, scale);
    case ShoeClass::Welted:
      return draw_welted(shoe, random, scale);
    case ShoeClass::Boot:
      return draw_boot(shoe, random, scale);
    case ShoeClass::Pump:
      return draw_pump(shoe, random, scale);
    case ShoeClass::Wedge:
      return draw_wedge(shoe, random, scale);
    default:
      return draw_cupsole(shoe, random, scale);
  }
}

}  // namespace biteline::sim
