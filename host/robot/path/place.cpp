// SPDX-License-Identifier: MIT
#include "host/robot/path/place.hpp"

#include <algorithm>

namespace biteline::path {
namespace {

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

}  // namespace biteline::path
