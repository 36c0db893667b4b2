// SPDX-License-Identifier: MIT
#include "hal/sim/live/work_trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biteline::sim {
namespace {

/// Less of it leaves no film.
constexpr double k_least_out_ratio = 0.02;
constexpr double k_unworked = std::numeric_limits<double>::quiet_NaN();

}  // namespace

WorkTrace::WorkTrace(const PlacedShoe& unworked, const WorkingTool& tool)
    : shoe_{unworked.shoe},
      line_{unworked.line},
      T_shoe_base_{unworked.T_base_shoe.inverse(Eigen::Isometry)},
      tool_{tool},
      gun_{tool.gun} {
  const auto stations = static_cast<std::size_t>(std::lround(shoe_.perimeter_mm() / k_station_mm));
  laid_.assign(stations, 0);
  z_mm_.assign(stations, k_unworked);
}

void WorkTrace::step(const ArmState& state, const SE3& T_base_flange, double step_s) {
  if (state.program_running && !ran_) worked_ = false;
  if (!state.program_running && ran_) due_ = due_ || worked_;
  ran_ = state.program_running;
  const bool on = ((state.outputs >> tool_.digital_output) & 1U) != 0;
  const double out = gun_.step(step_s, on, 1);
  if (out < k_least_out_ratio) {
    before_ = false;
    return;
  }
  if (!worked_) ++programs_;
  worked_ = true;
  const SE3 T_shoe_tcp = T_shoe_base_ * T_base_flange * state.T_flange_tcp;
  spots_.push_back({.place_shoe = T_shoe_tcp.translation() + tool_.standoff_mm * T_shoe_tcp.linear().col(2),
                    .out_ratio = static_cast<float>(out),
                    .goes_on = before_,
                    .blocked = programs_ <= tool_.gap_programs});
  before_ = true;
}

std::optional<WorkTrace::OnOutline> WorkTrace::on_outline(const Vec3& place_shoe) const {
  const auto nearest = std::ranges::min_element(line_, {}, [&](const TrueLinePoint& point) {
    return (point.point_shoe.head<2>() - place_shoe.head<2>()).squaredNorm();
  });
  if (nearest == line_.end()) return std::nullopt;
  double s_mm = nearest->s_mm;
  // To where the outline's normal meets the place: twice is within a micrometre.
  for (int i = 0; i < 3; ++i) {
    const Outline::Place at = shoe_.outline().at(s_mm);
    s_mm += at.tangent.dot(place_shoe.head<2>() - at.point);
  }
  const Section section = shoe_.section(s_mm);
  const auto off_mm = [&](double z_mm) { return (section.point(z_mm) - place_shoe).norm(); };
  // The nearest height, in finer and finer steps.
  double z_mm = std::clamp(place_shoe.z(), section.bottom_z_mm(), section.top_z_mm());
  for (double step_mm = 1, reach_mm = k_reach_mm; step_mm > 0.005; reach_mm = step_mm, step_mm /= 8) {
    const double middle_mm = z_mm;
    for (double by_mm = -reach_mm; by_mm <= reach_mm; by_mm += step_mm) {
      const double here_mm = std::clamp(middle_mm + by_mm, section.bottom_z_mm(), section.top_z_mm());
      if (off_mm(here_mm) < off_mm(z_mm)) z_mm = here_mm;
    }
  }
  if (off_mm(z_mm) > k_reach_mm) return std::nullopt;
  return OnOutline{.s_mm = s_mm, .z_mm = z_mm};
}

void WorkTrace::lay_between(const OnOutline& from, const OnOutline& to, const Spot& spot) {
  const double way_mm = shoe_.outline().way_mm(from.s_mm, to.s_mm);
  const auto count = static_cast<long>(laid_.size());
  // Each station that is passed, and none twice: the one that is left belongs to the step before.
  const double spacing_mm = shoe_.perimeter_mm() / static_cast<double>(count);
  const double begin = from.s_mm / spacing_mm, end = begin + way_mm / spacing_mm;
  const auto first = static_cast<long>(std::ceil(std::min(begin, end))),
             last = static_cast<long>(std::ceil(std::max(begin, end)));
  for (long i = first; i < last; ++i) {
    const double share = end == begin ? 0 : (static_cast<double>(i) - begin) / (end - begin);
    const double s_mm = static_cast<double>(i) * spacing_mm;
    if (spot.blocked && tool_.gap) {
      const double off_mm = shoe_.outline().way_mm(tool_.gap->from_s_mm + tool_.gap->length_mm / 2, s_mm);
      if (std::abs(off_mm) < tool_.gap->length_mm / 2) continue;
    }
    const auto k = static_cast<std::size_t>(((i % count) + count) % count);
    laid_[k] += spot.out_ratio;
    z_mm_[k] = from.z_mm + share * (to.z_mm - from.z_mm);
  }
}

MadeShoe WorkTrace::lay() {
  due_ = false;
  std::optional<OnOutline> before;
  for (const Spot& spot : spots_) {
    const std::optional<OnOutline> here = on_outline(spot.place_shoe);
    if (here && before && spot.goes_on) lay_between(*before, *here, spot);
    before = here;
  }
  spots_.clear();
  WorkedBand band{.film = draw_film(tool_.work, tool_.film_seed), .perimeter_mm = shoe_.perimeter_mm()};
  band.laid = laid_;
  const double spacing_mm = shoe_.perimeter_mm() / static_cast<double>(laid_.size());
  // Beside a worked piece the edges go on: what lies between two stations has both.
  constexpr std::size_t k_beside = 3;
  const std::size_t count = z_mm_.size();
  for (std::size_t i = 0; i < count; ++i) {
    double z = z_mm_[i];
    for (std::size_t k = 1; k <= k_beside && std::isnan(z); ++k) {
      z = z_mm_[(i + k) % count];
      if (std::isnan(z)) z = z_mm_[(i + count - k) % count];
    }
    if (std::isnan(z)) {
      band.edges.push_back({.low_z_mm = 0, .high_z_mm = 0});
      continue;
    }
    band.edges.push_back(
        edges_about(shoe_.section(static_cast<double>(i) * spacing_mm), z, tool_.width_mm / 2));
  }
  ShoeParameters worked = shoe_.parameters();
  worked.worked = std::move(band);
  return MadeShoe(std::move(worked));
}

}  // namespace biteline::sim
