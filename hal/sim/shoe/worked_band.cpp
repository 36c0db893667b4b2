// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/worked_band.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

namespace {

/// A film ends over this width, a brush's mark too.
constexpr double k_film_end_mm = 0.1;
/// A narrower or wider part begins and ends over this length.
constexpr double k_part_ramp_mm = 1;

double ramp(double inside_mm, double over_mm) {
  return std::clamp(inside_mm / over_mm + 0.5, 0.0, 1.0);
}

double way_mm(double from_mm, double to_mm, double perimeter_mm) {
  return std::remainder(to_mm - from_mm, perimeter_mm);
}

/// So near to the line ways are straight up, beyond along the surface.
constexpr double k_groove_mm = 2;

/// A section's heights against the way from the line.
class WayUp {
 public:
  WayUp(const Section& section, const TrueLinePoint& line, const Vec3& along) {
    constexpr double k_chord_mm = 0.25, k_reach_mm = 30;
    const Vec3 out = (line.normal_shoe - line.normal_shoe.dot(along) * along).normalized();
    const Vec3 up = out.cross(along);
    for (const int side : {-1, 1}) {
      std::vector<Vec2>& rows = side < 0 ? down_ : up_;
      double way = 0, z = line.point_shoe.z();
      Vec2 last{0, 0};  // up, out
      rows.emplace_back(0, z);
      while (std::abs(z - line.point_shoe.z()) < k_reach_mm) {
        z += side * k_chord_mm;
        if (z < section.bottom_z_mm() || z > section.top_z_mm()) break;
        const Vec3 from_line = section.point(z) - line.point_shoe;
        const Vec2 here{from_line.dot(up), from_line.dot(out)};
        way = std::abs(here.x()) < k_groove_mm ? std::abs(here.x()) : way + (here - last).norm();
        last = here;
        rows.emplace_back(way, z);
      }
    }
  }
  [[nodiscard]] double z_mm(double way) const {
    const std::vector<Vec2>& rows = way < 0 ? down_ : up_;
    const double target = std::abs(way);
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (rows[i].x() < target) continue;
      const double share = (target - rows[i - 1].x()) / (rows[i].x() - rows[i - 1].x());
      return rows[i - 1].y() + share * (rows[i].y() - rows[i - 1].y());
    }
    return rows.back().y();
  }

 private:
  std::vector<Vec2> down_, up_;
};

struct PlannedWays {
  double low_mm, high_mm;
};

PlannedWays ways_at(const BandPlan& plan, double s_mm, double perimeter_mm) {
  PlannedWays ways{plan.offset_mm - plan.width_mm / 2, plan.offset_mm + plan.width_mm / 2};
  for (const WorkFault& fault : plan.faults) {
    if (fault.kind != WorkFault::Kind::Narrow && fault.kind != WorkFault::Kind::Wide) continue;
    const double in_mm = fault.length_mm / 2 - std::abs(way_mm(fault.s_mm, s_mm, perimeter_mm));
    const double by_mm =
        (fault.kind == WorkFault::Kind::Wide ? 1 : -1) * fault.by_mm * ramp(in_mm, k_part_ramp_mm);
    if (fault.low) ways.low_mm -= by_mm;
    if (fault.high) ways.high_mm += by_mm;
  }
  return ways;
}

}  // namespace

Film draw_film(Work work, std::uint64_t seed) {
  Random random = Random(seed).fork(static_cast<std::uint64_t>(work) + 1);
  Film film;
  switch (work) {
    case Work::WetGlue:
      film = {.diffuse_factor = random.uniform({0.55, 0.85}),
              .scattering_by_mm = random.uniform({0.02, 0.1}),
              .roughness_mm = 0.002,
              .height_mm = random.uniform({0.05, 0.3})};
      break;
    case Work::DryGlue:
      film = {.diffuse_factor = random.uniform({0.9, 1.1}),
              .scattering_by_mm = random.uniform({0, 0.05}),
              .roughness_mm = 0.005,
              .height_mm = random.uniform({0.03, 0.1})};
      break;
    case Work::ColouredGlue:
      film = {.cover_ratio = 0.9,
              .own_diffuse_ratio = random.uniform({0.15, 0.85}),
              .height_mm = random.uniform({0.05, 0.3})};
      break;
    case Work::Ground:
      film = {.diffuse_factor = random.uniform({1.15, 1.5}),
              .roughness_mm = 0.03,
              .height_mm = -random.uniform({0.05, 0.3})};
      break;
    case Work::Roughed:
      film = {.diffuse_factor = random.uniform({1.1, 1.4}),
              .roughness_mm = 0.05,
              .height_mm = -random.uniform({0.05, 0.2})};
      break;
    case Work::Unseen:
      break;
  }
  return film;
}

double BandHere::layers_at(double z_mm) const {
  double there =
      layers * ramp(z_mm - edges.low_z_mm, k_film_end_mm) * ramp(edges.high_z_mm - z_mm, k_film_end_mm);
  for (const WorkedBand::Drop& drop : drops)
    there = std::max(there, ramp(drop.half_z_mm - std::abs(z_mm - drop.z_mm), k_film_end_mm));
  return there;
}

BandHere band_at(const WorkedBand& band, double s_mm) {
  const auto count = static_cast<double>(band.edges.size());
  const double at = std::fmod(s_mm / band.perimeter_mm + 1, 1.0) * count;
  const auto before = std::min(static_cast<std::size_t>(at), band.edges.size() - 1);
  const WorkedBand::Edges &a = band.edges[before], &b = band.edges[(before + 1) % band.edges.size()];
  const double share = at - static_cast<double>(before);
  BandHere here{.edges = {.low_z_mm = a.low_z_mm + share * (b.low_z_mm - a.low_z_mm),
                          .high_z_mm = a.high_z_mm + share * (b.high_z_mm - a.high_z_mm)},
                .layers = 1};
  if (!band.laid.empty())
    here.layers =
        (1 - share) * double{band.laid[before]} + share * double{band.laid[(before + 1) % band.laid.size()]};
  const auto in_mm = [&](const WorkedBand::Piece& piece) {
    return piece.half_mm - std::abs(way_mm(piece.s_mm, s_mm, band.perimeter_mm));
  };
  for (const WorkedBand::Piece& piece : band.doubled) here.layers += ramp(in_mm(piece), 2 * k_film_end_mm);
  for (const WorkedBand::Piece& piece : band.gaps) here.layers *= 1 - ramp(in_mm(piece), 2 * k_film_end_mm);
  for (const WorkedBand::Drop& drop : band.drops) {
    const double along = way_mm(drop.s_mm, s_mm, band.perimeter_mm) / drop.half_s_mm;
    if (std::abs(along) >= 1) continue;
    here.drops.push_back(drop);
    here.drops.back().half_z_mm *= std::sqrt(1 - along * along);
  }
  return here;
}

WorkedBand::Edges edges_about(const Section& section, double z_mm, double half_width_mm) {
  constexpr double k_chord_mm = 0.25;
  const auto walk = [&](double step_mm) {
    double way_mm = 0, z = z_mm;
    Vec3 last = section.point(z);
    while (way_mm < half_width_mm) {
      const double next = std::clamp(z + step_mm, section.bottom_z_mm(), section.top_z_mm());
      if (next == z) break;
      const Vec3 here = section.point(next);
      const double chord_mm = (here - last).norm();
      if (way_mm + chord_mm >= half_width_mm) return z + (next - z) * (half_width_mm - way_mm) / chord_mm;
      way_mm += chord_mm;
      z = next;
      last = here;
    }
    return z;
  };
  return {.low_z_mm = walk(-k_chord_mm), .high_z_mm = walk(k_chord_mm)};
}

WorkedBand lay_band(const MadeShoe& unworked, std::span<const TrueLinePoint> line, const BandPlan& plan,
                    const Film& film) {
  WorkedBand band{.film = film, .perimeter_mm = unworked.perimeter_mm()};
  const auto place = [&](std::size_t i) {
    const TrueLinePoint &before = line[(i + line.size() - 1) % line.size()],
                        &after = line[(i + 1) % line.size()];
    const Vec3 along = (after.point_shoe - before.point_shoe).normalized();
    return WayUp{unworked.section(line[i].s_mm), line[i], along};
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const WayUp up = place(i);
    const PlannedWays ways = ways_at(plan, line[i].s_mm, band.perimeter_mm);
    band.edges.push_back({.low_z_mm = up.z_mm(ways.low_mm), .high_z_mm = up.z_mm(ways.high_mm)});
  }
  for (const WorkFault& fault : plan.faults) {
    const WorkedBand::Piece piece{.s_mm = fault.s_mm, .half_mm = fault.length_mm / 2};
    if (fault.kind == WorkFault::Kind::Gap) band.gaps.push_back(piece);
    if (fault.kind == WorkFault::Kind::Double) band.doubled.push_back(piece);
    if (fault.kind != WorkFault::Kind::Drop) continue;
    const double per_mm = static_cast<double>(line.size()) / band.perimeter_mm;
    const WayUp up = place(static_cast<std::size_t>(std::lround(fault.s_mm * per_mm)) % line.size());
    const double high_z_mm = up.z_mm(fault.by_mm + piece.half_mm),
                 low_z_mm = up.z_mm(fault.by_mm - piece.half_mm);
    band.drops.push_back({.s_mm = fault.s_mm,
                          .z_mm = (low_z_mm + high_z_mm) / 2,
                          .half_s_mm = piece.half_mm,
                          .half_z_mm = (high_z_mm - low_z_mm) / 2});
  }
  return band;
}

}  // namespace biteline::sim
