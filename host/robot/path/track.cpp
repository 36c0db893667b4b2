// SPDX-License-Identifier: MIT
#include "host/robot/path/track.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

// How far ahead of the last place, and back, the next one is looked for: a sample at 125 Hz and 1 m/s is 8 mm
// on.
constexpr double k_ahead_mm = 25;
constexpr double k_back_mm = 2;
constexpr double k_passed_mm = 0.5;

/// A place between two waypoints.
struct NearestPlace {
  std::size_t segment{0};
  double fraction{0};
  double distance_mm{1e9};
};

SE3 pose_at(const PlannedPath& path, const NearestPlace& place) {
  return geometry::interpolate(path.waypoints[place.segment].T_base_tcp,
                               path.waypoints[place.segment + 1].T_base_tcp, place.fraction);
}

double arc_at(const PlannedPath& path, const NearestPlace& place) {
  const double a = path.waypoints[place.segment].arc_mm, b = path.waypoints[place.segment + 1].arc_mm;
  return a + place.fraction * (b - a);
}

/// The nearest place within [from_mm, to_mm] of the path.
NearestPlace nearest(const PlannedPath& path, const Vec3& tip, double from_mm, double to_mm) {
  NearestPlace best;
  for (std::size_t i = 0; i + 1 < path.waypoints.size(); ++i) {
    if (path.waypoints[i + 1].arc_mm < from_mm) continue;
    if (path.waypoints[i].arc_mm > to_mm) break;
    const Vec3 a = path.waypoints[i].T_base_tcp.translation(),
               along = path.waypoints[i + 1].T_base_tcp.translation() - a;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((tip - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    const double distance_mm = (tip - a - t * along).norm();
    if (distance_mm < best.distance_mm) best = {.segment = i, .fraction = t, .distance_mm = distance_mm};
  }
  return best;
}

/// Distance of a point to the bite line near a place of the path.
double to_line_mm(const PlannedPath& path, std::size_t segment, const Vec3& point) {
  double best_mm = 1e9;
  const std::size_t from = segment > 4 ? segment - 4 : 0,
                    to = std::min(segment + 5, path.waypoints.size() - 1);
  for (std::size_t i = from; i < to; ++i) {
    const Vec3 a = path.waypoints[i].line_base, along = path.waypoints[i + 1].line_base - a;
    const double length2 = along.squaredNorm();
    const double t = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
    best_mm = std::min(best_mm, (point - a - t * along).norm());
  }
  return best_mm;
}

/// Where the tool works, seen from the tip: the line's point in tcp at that place of the plan.
Vec3 work_in_tcp(const PlannedPath& path, const NearestPlace& place, const SE3& T_base_tcp_planned) {
  const Vec3 a = path.waypoints[place.segment].line_base, b = path.waypoints[place.segment + 1].line_base;
  return T_base_tcp_planned.inverse() * Vec3((1 - place.fraction) * a + place.fraction * b);
}

/// The value that a share of 0.95 of them does not exceed.  Pre: not empty.
double p95(std::vector<double>& values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

TrackDeviation deviation(const PlannedPath& path, std::span<const TrackSample> track) {
  TrackDeviation out;
  const double end_mm = path.waypoints.back().arc_mm;
  double here_mm = -1;
  double sum_mm = 0, sum_mm2 = 0, line_sum_mm = 0;
  std::vector<double> from_path_mm, from_line_mm;
  std::vector<bool> passed(path.waypoints.size(), false);
  for (const TrackSample& sample : track) {
    const Vec3 tip = sample.T_base_tcp.translation();
    if (here_mm < 0) {
      // The way to the first waypoint is the arm's own.
      if ((tip - path.waypoints.front().T_base_tcp.translation()).norm() > k_passed_mm) continue;
      here_mm = 0;
    }
    const NearestPlace place = nearest(path, tip, here_mm - k_back_mm, here_mm + k_ahead_mm);
    here_mm = std::max(here_mm, arc_at(path, place));
    for (const std::size_t i : {place.segment, place.segment + 1}) {
      if ((tip - path.waypoints[i].T_base_tcp.translation()).norm() <
          std::max(k_passed_mm, 0.6 * path.motion.spacing_mm))
        passed[i] = true;
    }
    const bool on_line = path.waypoints[place.segment].segment == Segment::Line &&
                         path.waypoints[place.segment + 1].segment == Segment::Line;
    if (!on_line) continue;
    const SE3 T_planned = pose_at(path, place);
    ++out.samples;
    sum_mm += place.distance_mm;
    sum_mm2 += place.distance_mm * place.distance_mm;
    from_path_mm.push_back(place.distance_mm);
    if (place.distance_mm > out.max_mm) {
      out.max_mm = place.distance_mm;
      out.max_at_mm = arc_at(path, place);
    }
    out.max_rad =
        std::max(out.max_rad, geometry::angle_between_rad(T_planned.linear(), sample.T_base_tcp.linear()));
    const double line_mm =
        to_line_mm(path, place.segment, sample.T_base_tcp * work_in_tcp(path, place, T_planned));
    line_sum_mm += line_mm;
    from_line_mm.push_back(line_mm);
    out.line_max_mm = std::max(out.line_max_mm, line_mm);
  }
  std::size_t waypoints = 0, reached = 0;
  for (std::size_t i = 0; i < passed.size(); ++i) {
    if (path.waypoints[i].segment != Segment::Line) continue;
    ++waypoints;
    if (passed[i]) ++reached;
  }
  if (out.samples > 0) {
    const auto n = static_cast<double>(out.samples);
    out.mean_mm = sum_mm / n;
    out.rms_mm = std::sqrt(sum_mm2 / n);
    out.line_mean_mm = line_sum_mm / n;
    out.p95_mm = p95(from_path_mm);
    out.line_p95_mm = p95(from_line_mm);
  }
  out.covered = waypoints > 0 ? static_cast<double>(reached) / static_cast<double>(waypoints) : 0;
  out.completed = here_mm >= end_mm - k_passed_mm;
  return out;
}

}  // namespace biteline::path
