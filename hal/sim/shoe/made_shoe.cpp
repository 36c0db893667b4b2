// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/made_shoe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

constexpr double k_two_pi = 2 * std::numbers::pi;

/// exp(-40) is below 1e-17: beyond it a tail counts for nothing, and cutting it avoids denormal numbers.
constexpr double k_tail = 40;

double square(double x) {
  return x * x;
}

double bell(double x_over_sigma) {
  const double exponent = 0.5 * square(x_over_sigma);
  return exponent > k_tail ? 0.0 : std::exp(-exponent);
}

double logistic(double x) {
  if (x < -k_tail) return 0;
  return x > k_tail ? 1.0 : 1 / (1 + std::exp(-x));
}

/// 1 between low and high, 0 outside, soft ends.
double band(double x, double low, double high, double soft) {
  return logistic((x - low) / soft) * logistic((high - x) / soft);
}

/// 1 inside the stretch.
double inside(const Stretch& stretch, double way_mm) {
  return band(way_mm, -stretch.half_length_mm, stretch.half_length_mm, 0.25 * stretch.soft_mm);
}

/// Valley of unit depth: steeper towards the sole than towards the upper, as pressing on a sole leaves it.
double valley(double u_mm, double width_mm) {
  return 0.65 * bell(u_mm / width_mm) + 0.35 * bell((u_mm - width_mm) / (1.7 * width_mm));
}

/// Below the line a bare upper's wall turns upright, as lasts do towards the feather edge: heights are drawn
/// together smoothly (tanh bends by nothing at 0).
double bare_height_mm(double u_mm) {
  constexpr double k_reach_mm = 14;
  return u_mm >= 0 ? u_mm : k_reach_mm * std::tanh(u_mm / k_reach_mm);
}

double smooth_step(double x, double low, double high) {
  const double part = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return part * part * (3 - 2 * part);
}

/// 1 at the middle, 0 from half_width on.
double hump(double x, double middle, double half_width) {
  return 0.5 * (1 + std::cos(std::numbers::pi * std::min(std::abs(x - middle) / half_width, 1.0)));
}

/// Standard normal deviate that belongs to a place: grain does not move with the scan.
double grain(double s_mm, double z_mm) {
  constexpr double k_grain_mm = 0.5;
  const auto at = [](double mm) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(mm / k_grain_mm));
  };
  Random random(at(s_mm) * 0x9E3779B97F4A7C15ULL + at(z_mm));
  return random.gaussian();
}

/// Where the line begins to climb to a raised heel, and where it is up, from heel to toe.
constexpr double k_lift_from_ratio = 0.66, k_lift_to_ratio = 0.2;
/// How softly a shaft turns upright.
constexpr double k_shaft_soft_mm = 12;
/// A sole nearer to the table than this stands on it.
constexpr double k_off_table_mm = 0.8;

/// What layers of a film make of what is below them.
void lay_film(const Film& film, double layers, SurfaceLook& look) {
  if (layers <= 0) return;
  const double below = std::pow(1 - film.cover_ratio, layers);
  look.diffuse_ratio = below * look.diffuse_ratio * std::pow(film.diffuse_factor, layers) +
                       (1 - below) * film.own_diffuse_ratio;
  look.scattering_mm += layers * film.scattering_by_mm;
  look.roughness_mm += std::min(layers, 1.0) * (film.roughness_mm - look.roughness_mm);
}

/// What a filled groove keeps: hardly a valley, a wide fillet.
constexpr double k_filled_depth_ratio = 0.05;
constexpr double k_filled_lip_width_mm = 1.3;
/// No two places of a real groove are equal: root mean square change of its depth and step along the line.
constexpr double k_strength_variation_ratio = 0.1;
/// What a faded groove keeps.
constexpr double k_faded_strength_ratio = 0.15;
/// A faded step closes by the upper swelling outwards over this height.
constexpr double k_fade_height_mm = 10;
/// Where the weave begins above the line, and how softly.
constexpr double k_texture_begin_u_mm = 2.5;
/// Edges of bands that are stuck on.
constexpr double k_band_edge_mm = 0.15;

}  // namespace

MadeShoe::MadeShoe(ShoeParameters parameters)
    : parameters_(std::move(parameters)), outline_(parameters_.outline) {
  Random line(parameters_.seed * 2 + 1);
  for (int count = 2; count <= 5; ++count) {
    line_waves_.push_back({line.uniform({0.3, 1}) / count, count, line.uniform({0, k_two_pi})});
  }
  Random strength(parameters_.seed * 2 + 2);
  for (int count = 1; count <= 9; count += 2) {
    strength_waves_.push_back({strength.uniform({0.3, 1}), count, strength.uniform({0, k_two_pi})});
  }
  Random last(parameters_.last_seed);
  for (int count = 1; count <= 6; ++count) {
    last_waves_.push_back({last.uniform({0.3, 1}) / std::sqrt(count), count, last.uniform({0, k_two_pi})});
  }
  // Unit root mean square: sum of amplitude^2 / 2.
  for (auto* waves : {&line_waves_, &strength_waves_, &last_waves_}) {
    double power = 0;
    for (const auto& wave : *waves) power += square(wave.amplitude) / 2;
    for (auto& wave : *waves) wave.amplitude /= std::sqrt(power);
  }
}

double MadeShoe::waves(const std::vector<Wave>& list, double s_mm) const {
  double sum = 0;
  for (const auto& wave : list) {
    sum += wave.amplitude * std::sin(k_two_pi * wave.count * s_mm / perimeter_mm() + wave.phase_rad);
  }
  return sum;
}

Section MadeShoe::section(double s_mm) const {
  const ShoeParameters& p = parameters_;
  Section section(*this);
  section.s_mm_ = s_mm;
  section.place_ = outline_.at(s_mm);
  const double along_ratio = section.place_.point.x() / outline_.length_mm();

  section.line_height_mm_ =
      p.groove.line_height_mm + p.groove.toe_rise_mm * square(std::max(0.0, along_ratio - 0.3) / 0.7) +
      p.groove.heel_rise_mm * square(std::max(0.0, 0.5 - along_ratio) / 0.5) +
      p.groove.wave_mm * waves(line_waves_, s_mm) +
      p.groove.heel_lift_mm * (1 - smooth_step(along_ratio, k_lift_to_ratio, k_lift_from_ratio));
  section.top_z_mm_ = p.upper.top_z_mm + (section.line_height_mm_ - p.groove.line_height_mm) -
                      p.upper.waist_drop_mm * hump(along_ratio, 0.5, 0.35) -
                      p.upper.toe_drop_mm * smooth_step(along_ratio, 0.55, 0.75);
  if (p.upper.strap_ratio &&
      (along_ratio < p.upper.strap_ratio->front() || along_ratio > p.upper.strap_ratio->back()))
    section.top_z_mm_ = section.line_height_mm_;
  if (p.sole.thickness_mm > 0) {
    const double under_mm = section.line_height_mm_ - p.sole.thickness_mm;
    const bool off_table = under_mm > k_off_table_mm;
    if (off_table && along_ratio < p.sole.heel_block_ratio)
      section.heel_top_z_mm_ = under_mm;
    else if (off_table)
      section.bottom_z_mm_ = under_mm;
  }

  if (p.sole.guard) {
    constexpr double k_step_mm = 0.05;
    const Guard& guard = *p.sole.guard;
    const double way_mm = outline_.way_mm(guard.where.s_mm, s_mm);
    section.guard_ratio_ = inside(guard.where, way_mm);
    section.guard_rise_mm_ = guard.rise_mm * section.guard_ratio_;
    section.guard_slope_ =
        guard.rise_mm * (inside(guard.where, way_mm + k_step_mm) - inside(guard.where, way_mm - k_step_mm)) /
        (2 * k_step_mm);
    section.line_height_mm_ += section.guard_rise_mm_;
  }

  section.strength_ratio_ = 1 + k_strength_variation_ratio * waves(strength_waves_, s_mm);
  for (const auto& stretch : p.filled)
    section.open_ratio_ *= 1 - inside(stretch, outline_.way_mm(stretch.s_mm, s_mm));
  for (const auto& stretch : p.faded) {
    section.strength_ratio_ *=
        1 - (1 - k_faded_strength_ratio) * inside(stretch, outline_.way_mm(stretch.s_mm, s_mm));
  }
  if (p.sole.lug_count > 0) {
    section.lug_ratio_ = logistic(6 * std::sin(k_two_pi * p.sole.lug_count * s_mm / perimeter_mm()));
  }
  if (p.last_difference_mm > 0) section.last_difference_mm_ = p.last_difference_mm * waves(last_waves_, s_mm);

  // Whole numbers of stitches and threads around the shoe, so that they meet themselves.
  const double threads = std::round(perimeter_mm() / p.upper.texture_pitch_mm);
  section.texture_phase_ratio_ = std::sin(k_two_pi * threads * s_mm / perimeter_mm());
  for (const auto& row : p.upper.stitch_rows) {
    const double pitch_mm = perimeter_mm() / std::round(perimeter_mm() / row.pitch_mm);
    section.stitch_ratio_.push_back(bell(std::remainder(s_mm, pitch_mm) / (0.2 * pitch_mm)));
  }
  for (const auto& seam : p.upper.seams) section.seam_way_mm_.push_back(outline_.way_mm(seam.s_mm, s_mm));
  for (const auto& swoosh : p.upper.swooshes)
    section.swoosh_way_mm_.push_back(outline_.way_mm(swoosh.s_mm, s_mm));
  const auto meet = [&](const std::vector<Relief>& reliefs, std::vector<Section::LocalRelief>& met) {
    for (const Relief& relief : reliefs) {
      const double rise_mm = relief.heel_rise_mm * square(std::max(0.0, 0.5 - along_ratio) / 0.5) +
                             relief.toe_rise_mm * square(std::max(0.0, along_ratio - 0.3) / 0.7);
      met.push_back(
          {.relief = &relief,
           .middle_u_mm = relief.u_mm + rise_mm,
           .here_ratio =
               relief.where ? inside(*relief.where, outline_.way_mm(relief.where->s_mm, s_mm)) : 1.0,
           .pitch_mm = perimeter_mm() / std::max(1.0, std::round(perimeter_mm() / relief.pitch_mm))});
    }
  };
  meet(p.sole.reliefs, section.sole_reliefs_);
  meet(p.upper.reliefs, section.upper_reliefs_);
  if (p.worked) section.worked_ = band_at(*p.worked, s_mm);
  return section;
}

Vec3 MadeShoe::normal(double s_mm, double z_mm) const {
  constexpr double k_step_mm = 0.01;  // finest detail is some 0.15 mm wide: error below 1e-3 rad
  const Section middle = section(s_mm);
  const double slope_z =
      (middle.offset_mm(z_mm + k_step_mm) - middle.offset_mm(z_mm - k_step_mm)) / (2 * k_step_mm);
  const double slope_s =
      (section(s_mm + k_step_mm).offset_mm(z_mm) - section(s_mm - k_step_mm).offset_mm(z_mm)) /
      (2 * k_step_mm);
  // P = C(s) + N(s) o + z e_z with N' = curvature T, so P_s x P_z = stretch (N - o_z e_z) - o_s T.
  const auto& place = middle.place();
  const double stretch = 1 + place.curvature_per_mm * middle.offset_mm(z_mm);
  const Vec2 horizontal = stretch * place.normal - slope_s * place.tangent;
  return Vec3{horizontal.x(), horizontal.y(), -stretch * slope_z}.normalized();
}

double Section::side_of_sole_mm(double u_mm, double z_mm) const {
  const SoleShape& sole = shoe_->parameters_.sole;
  const UpperShape& upper = shoe_->parameters_.upper;
  const double foot_mm = line_height_mm_ - guard_rise_mm_;
  // A guard lies on the wall of the upper, and goes straight on below that.
  if (guard_ratio_ > 0 && u_mm > 0) return upper.lean_per_mm * u_mm * (2 * upper.bulge_u_mm - u_mm);
  const double plain =
      sole.bulge_mm * std::sin(std::numbers::pi * (z_mm - bottom_z_mm_) / (foot_mm - bottom_z_mm_)) -
      sole.flare_ratio * u_mm;
  return guard_ratio_ > 0
             ? (1 - guard_ratio_) * plain + guard_ratio_ * 2 * upper.lean_per_mm * upper.bulge_u_mm * u_mm
             : plain;
}

double Section::sole_mm(double u_mm, double z_mm) const {
  const SoleShape& sole = shoe_->parameters_.sole;
  double offset_mm = side_of_sole_mm(u_mm, z_mm) + reliefs_mm(sole_reliefs_, u_mm);
  if (z_mm < heel_top_z_mm_) offset_mm -= sole.heel_taper_ratio * (heel_top_z_mm_ - z_mm);
  for (const auto& groove : sole.parallel_grooves) {
    offset_mm -= groove.depth_mm * bell((u_mm - groove.u_mm) / groove.width_mm);
  }
  if (sole.foxing) {
    offset_mm +=
        sole.foxing->height_mm * band(u_mm, sole.foxing->low_u_mm, sole.foxing->high_u_mm, k_band_edge_mm);
  }
  if (sole.lug_count > 0) {
    offset_mm -= sole.lug_depth_mm * lug_ratio_ * logistic((sole.lug_top_z_mm - z_mm) / k_band_edge_mm);
  }
  return offset_mm;
}

double Section::reliefs_mm(const std::vector<LocalRelief>& reliefs, double u_mm) const {
  double offset_mm = 0;
  for (const LocalRelief& local : reliefs) {
    if (local.here_ratio < 1e-9) continue;
    const Relief& relief = *local.relief;
    const double from_middle_mm = u_mm - local.middle_u_mm;
    double across = 0;
    switch (relief.kind) {
      case Relief::Kind::Ledge:
        across = logistic(-from_middle_mm / relief.edge_mm);
        break;
      case Relief::Kind::Groove:
        across = bell(from_middle_mm / relief.half_mm);
        break;
      case Relief::Kind::Band:
      case Relief::Kind::Periodic:
        across = band(from_middle_mm, -relief.half_mm, relief.half_mm, relief.edge_mm);
        break;
    }
    if (relief.kind == Relief::Kind::Periodic && across > 1e-9) {
      const double half_piece_mm = 0.5 * relief.duty_ratio * local.pitch_mm;
      const double way_mm = std::remainder(s_mm_ - relief.slant_ratio * u_mm, local.pitch_mm);
      across *= band(way_mm, -half_piece_mm, half_piece_mm, relief.edge_mm);
    }
    offset_mm += relief.height_mm * local.here_ratio * across;
  }
  return offset_mm;
}

double Section::decoration_of_upper_mm(double u_mm) const {
  const UpperShape& upper = shoe_->parameters_.upper;
  double offset_mm = reliefs_mm(upper_reliefs_, u_mm);
  for (std::size_t i = 0; i < upper.stitch_rows.size(); ++i) {
    const auto& row = upper.stitch_rows[i];
    offset_mm += row.height_mm * stitch_ratio_[i] * bell((u_mm - row.u_mm) / 0.3);
  }
  for (const auto& seam : upper.parallel_seams) {
    offset_mm -= seam.depth_mm * bell((u_mm - seam.u_mm) / seam.width_mm);
  }
  for (std::size_t i = 0; i < upper.seams.size(); ++i) {
    const auto& seam = upper.seams[i];
    const double across_mm = (seam_way_mm_[i] - seam.slope_ratio * u_mm) / std::hypot(1.0, seam.slope_ratio);
    offset_mm += seam.height_mm * bell(across_mm / seam.width_mm);
  }
  for (std::size_t i = 0; i < upper.swooshes.size(); ++i) {
    const auto& swoosh = upper.swooshes[i];
    const double way_mm = swoosh_way_mm_[i];
    if (std::abs(way_mm) > swoosh.half_length_mm + 2) continue;
    const double middle_u_mm = swoosh.u_mm + swoosh.bend_per_mm * square(way_mm);
    offset_mm +=
        swoosh.height_mm *
        band(u_mm, middle_u_mm - swoosh.half_width_mm, middle_u_mm + swoosh.half_width_mm, k_band_edge_mm) *
        band(way_mm, -swoosh.half_length_mm, swoosh.half_length_mm, k_band_edge_mm / 2);
  }
  if (upper.texture_mm > 0) {
    offset_mm += upper.texture_mm * texture_phase_ratio_ *
                 std::sin(k_two_pi * u_mm / upper.texture_pitch_mm) *
                 logistic((u_mm - k_texture_begin_u_mm) / 0.4);
  }
  return offset_mm;
}

double Section::upper_mm(double u_mm) const {
  const ShoeParameters& p = shoe_->parameters_;
  // A shaft goes on as it was where it begins.
  const double over_mm = u_mm - p.upper.shaft_u_mm;
  const double wall_u_mm =
      over_mm > 0 ? p.upper.shaft_u_mm + k_shaft_soft_mm * std::tanh(over_mm / k_shaft_soft_mm) : u_mm;
  double offset_mm = -p.groove.step_mm +
                     p.upper.lean_per_mm * wall_u_mm * (2 * p.upper.bulge_u_mm - wall_u_mm) +
                     last_difference_mm_ + decoration_of_upper_mm(u_mm);
  offset_mm += (1 - strength_ratio_) * p.groove.step_mm * bell(u_mm / k_fade_height_mm);
  return offset_mm;
}

double Section::offset_mm(double z_mm) const {
  const double unworked = unworked_mm(z_mm);
  if (!worked_) return unworked;
  return unworked + shoe_->parameters_.worked->film.height_mm * worked_->layers_at(z_mm);
}

double Section::unworked_mm(double z_mm) const {
  const ShoeParameters& p = shoe_->parameters_;
  const Groove& groove = p.groove;
  const double u_mm = z_mm - line_height_mm_;
  if (p.bare) return upper_mm(bare_height_mm(u_mm));
  // The crease is as wide on a guard's flank as elsewhere; sole and upper are what they are without one.
  const double across_mm = u_mm / std::hypot(1.0, guard_slope_);
  const double own_u_mm = u_mm + guard_rise_mm_;
  // Far from the lip one side alone is left, to 1e-17 of the step.
  const double open_lip = (across_mm - groove.lip_u_mm) / groove.lip_width_mm;
  const double filled_lip = (across_mm - groove.lip_u_mm) / k_filled_lip_width_mm;
  const bool only_sole = open_lip < -k_tail && (open_ratio_ > 0.999999 || filled_lip < -k_tail);
  const bool only_upper = open_lip > k_tail && (open_ratio_ > 0.999999 || filled_lip > k_tail);
  const double sole = only_upper ? 0.0 : sole_mm(own_u_mm, z_mm);
  const double upper = only_sole ? 0.0 : upper_mm(own_u_mm);
  const double groove_valley = strength_ratio_ * groove.depth_mm * valley(across_mm, groove.width_mm);
  const double open = sole + (upper - sole) * logistic(open_lip) - groove_valley;
  if (open_ratio_ > 0.999999) return open;
  const double filled = sole + (upper - sole) * logistic(filled_lip) - k_filled_depth_ratio * groove_valley;
  return open_ratio_ * open + (1 - open_ratio_) * filled;
}

Vec3 Section::point(double z_mm) const {
  const Vec2 horizontal = place_.point + offset_mm(z_mm) * place_.normal;
  return {horizontal.x(), horizontal.y(), z_mm};
}

const Material& Section::material_at(bool on_sole, double u_mm) const {
  const Reflectance& reflectance = shoe_->parameters_.reflectance;
  const Material* material = on_sole ? &reflectance.sole : &reflectance.upper;
  for (const LocalRelief& local : on_sole ? sole_reliefs_ : upper_reliefs_) {
    const Relief& relief = *local.relief;
    if (!relief.material || local.here_ratio < 0.5) continue;
    const double above_mm = u_mm - local.middle_u_mm;
    const bool in = relief.kind == Relief::Kind::Ledge  ? above_mm < 0
                    : relief.kind == Relief::Kind::Band ? std::abs(above_mm) < relief.half_mm
                                                        : false;
    if (in) material = &*relief.material;
  }
  return *material;
}

SurfaceLook Section::look(double z_mm) const {
  const ShoeParameters& p = shoe_->parameters_;
  const double u_mm = z_mm - line_height_mm_;
  const bool on_sole = !p.bare && u_mm < p.groove.lip_u_mm;
  const Material& material = material_at(on_sole, u_mm + guard_rise_mm_);
  SurfaceLook look{.diffuse_ratio = material.diffuse_ratio,
                   .glossy = false,
                   .scattering_mm = material.scattering_mm,
                   .roughness_mm = material.roughness_mm,
                   .polarised_ratio = material.polarised_ratio};
  if (material.grain_ratio > 0)
    look.diffuse_ratio *= std::max(0.1, 1 + material.grain_ratio * grain(s_mm_, z_mm));
  for (const auto& patch : p.gloss) {
    const double way_mm = shoe_->outline_.way_mm(patch.s_mm, s_mm_);
    if (square(way_mm / patch.half_length_mm) + square((u_mm - patch.u_mm) / patch.half_height_mm) < 1)
      look.glossy = true;
  }
  if (worked_) lay_film(p.worked->film, worked_->layers_at(z_mm), look);
  return look;
}

}  // namespace biteline::sim
