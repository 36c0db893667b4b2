// SPDX-License-Identifier: MIT
#include "host/robot/path/place.hpp"

#include <algorithm>

namespace biteline::path {
namespace {

// How far ahead of the last place, and back, the next one is looked for: a sample at 125 Hz and 1 m/s is 8 mm
// on.
constexpr double k_ahead_mm = 25;
constexpr double k_back_mm = 2;

double between(double a, double b, double fraction) {
  return a + fraction * (b - a);
}

}  // namespace

PathPlace nearest_place(const PlannedPath& path, const Vec3& tip, const Stretch& within) {
  PathPlace best;
  for (std::size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
    if (path.waypoints[i + 1].arc_mm < within.from_mm) continue;
    if (path.waypoints[i].arc_mm > within.to_mm) break;
    const Vec3 a = path.waypoints[i].T_base_tcp.translation(),
               along = path.waypoints[i + 1].T_base_tcp.translation() - a;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((tip - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    const double distance_mm = (tip - a - t * along).norm();
    if (distance_mm < best.distance_mm) best = {.segment = i, .fraction = t, .distance_mm = distance_mm};
  }
  return best;
}

SE3 pose_at(const PlannedPath& path, const PathPlace& place) {
  return geometry::interpolate(path.waypoints[place.segment].T_base_tcp,
                               path.waypoints[place.segment + 1].T_base_tcp, place.fraction);
}

double arc_at(const PlannedPath& path, const PathPlace& place) {
  return between(path.waypoints[place.segment].arc_mm, path.waypoints[place.segment + 1].arc_mm,
                 place.fraction);
}

double time_at(const PlannedPath& path, const PathPlace& place) {
  return between(path.waypoints[place.segment].time_s, path.waypoints[place.segment + 1].time_s,
                 place.fraction);
}

std::optional<PathPlace> AlongPath::next(const Vec3& tip) {
  if (here_mm_ < 0) {
    // States may be missing just there.
    if (nearest_place(path_, tip, {.from_mm = 0, .to_mm = k_ahead_mm}).distance_mm > k_passed_mm)
      return std::nullopt;
    here_mm_ = 0;
  }
  const PathPlace place =
      nearest_place(path_, tip, {.from_mm = here_mm_ - k_back_mm, .to_mm = here_mm_ + k_ahead_mm});
  here_mm_ = std::max(here_mm_, arc_at(path_, place));
  return place;
}

}  // namespace biteline::path
