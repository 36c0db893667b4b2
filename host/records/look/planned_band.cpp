// SPDX-License-Identifier: MIT
#include "host/records/look/planned_band.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "host/geometry/closed_curve.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::look {
namespace {

using second_look::Arc;

constexpr double k_spacing_mm = 1;
/// A seam's ends are told within half a profile's way and a gun's delay.
constexpr double k_seam_end_mm = 2;

geometry::ArcLength arc_of(const cloud::ClosedLine& line) {
  return {line.points.size(), [&line](std::size_t i) { return line.points[i].position; }};
}

/// Places in a row that `is` names become one arc.
std::vector<Arc> arcs_where(const std::vector<path::PlaceWork>& work, double step_mm, const auto& is) {
  std::vector<Arc> arcs;
  bool before = false;
  for (std::size_t i = 0; i < work.size(); ++i) {
    const double at_mm = static_cast<double>(i) * step_mm;
    const bool here = is(work[i]);
    if (here && !before) arcs.push_back({.from_mm = at_mm, .to_mm = at_mm});
    if (here) arcs.back().to_mm = at_mm + step_mm;
    before = here;
  }
  return arcs;
}

/// Of the place of the line that lies nearest, from its first point.
double along_mm(const cloud::ClosedLine& line, const Vec3& place) {
  double best = std::numeric_limits<double>::max(), at_mm = 0, way_mm = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Vec3& from = line.points[i].position;
    const Vec3 step = line.points[(i + 1) % line.points.size()].position - from;
    const double length_mm = step.norm();
    const double share =
        length_mm > 0 ? std::clamp((place - from).dot(step) / (length_mm * length_mm), 0.0, 1.0) : 0;
    const double off = (from + share * step - place).squaredNorm();
    if (off < best) {
      best = off;
      at_mm = way_mm + share * length_mm;
    }
    way_mm += length_mm;
  }
  return at_mm;
}

}  // namespace

Result<second_look::PlannedBand> planned_band(const cloud::ClosedLine& line, const path::Process& process,
                                              const BandWish& wish) {
  for (const path::Zone& zone : process.zones) {
    if (zone.up_by_mm != 0 || zone.outward_by_mm != 0)
      return fail(Errc::InvalidArgument, "zone '%s' moves the band, and one band is compared all round",
                  zone.name.c_str());
  }
  for (const path::Check& check : path::check_zones(line, process)) {
    if (!check.passed) return fail(Errc::BadValue, "%s: %s", process.name.c_str(), check.detail.c_str());
  }
  const double middle_mm = wish.offset_mm.value_or(process.placement.up_mm),
               width_mm = wish.width_mm.value_or(path::covered_width_mm(process));
  if (!(width_mm > 0))
    return fail(Errc::InvalidArgument, "the process %s tells no width of its band", process.name.c_str());
  const geometry::ArcLength arc = arc_of(line);
  std::vector<Vec3> places;
  for (const geometry::OnCurve& on : arc.even(arc.count_for(k_spacing_mm)))
    places.push_back(on.between(line.points[on.before].position, line.points[on.after].position));
  const double step_mm = arc.total_mm() / static_cast<double>(places.size());
  const std::vector<path::PlaceWork> work = path::work_along(places, step_mm, process);
  const auto passes_more = [&process](const path::PlaceWork& place) {
    return place.zone >= 0 && !place.left_out &&
           process.zones[static_cast<std::size_t>(place.zone)].passes > 1;
  };
  return second_look::PlannedBand{
      .low_mm = middle_mm - width_mm / 2,
      .high_mm = middle_mm + width_mm / 2,
      .left_out = arcs_where(work, step_mm, [](const path::PlaceWork& place) { return place.left_out; }),
      .twice = arcs_where(work, step_mm, passes_more),
      .tolerance_mm = wish.tolerance_mm.value_or(process.look_tolerance_mm)};
}

std::vector<Vec3> middle_of(const path::PlannedPath& path) {
  std::vector<Vec3> middle;
  for (const path::Waypoint& waypoint : path.waypoints) {
    if (waypoint.segment != path::Segment::Line) continue;
    const SE3& T = waypoint.T_base_tcp;
    middle.emplace_back(T.translation() + path.standoff_mm * T.linear().col(2));
  }
  return middle;
}

std::optional<double> end_of(const path::PlannedPath& path, const cloud::ClosedLine& line) {
  if (!(path.overlap_mm > 0)) return std::nullopt;
  const auto entry = std::ranges::find(path.waypoints, path::Segment::Line, &path::Waypoint::segment);
  if (entry == path.waypoints.end()) return std::nullopt;
  return along_mm(line, entry->line_base);
}

std::optional<Arc> seam_of(const path::PlannedPath& path, const cloud::ClosedLine& line) {
  const std::optional<double> at_mm = end_of(path, line);
  if (!at_mm) return std::nullopt;
  const double line_mm = arc_of(line).total_mm();
  const auto on_line = [&](double mm) { return std::fmod(mm + line_mm, line_mm); };
  return Arc{.from_mm = on_line(*at_mm - k_seam_end_mm),
             .to_mm = on_line(*at_mm + path.overlap_mm + k_seam_end_mm)};
}

}  // namespace biteline::look
