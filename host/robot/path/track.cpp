// SPDX-License-Identifier: MIT
#include "host/robot/path/track.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/geometry/robust.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/place.hpp"

namespace biteline::path {
namespace {

// States that a busy network or host lost: in so short a time no tip leaves the path and comes back to it.
constexpr double k_unseen_s = 0.1;

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
Vec3 work_in_tcp(const PlannedPath& path, const PathPlace& place, const SE3& T_base_tcp_planned) {
  const Vec3 a = path.waypoints[place.segment].line_base, b = path.waypoints[place.segment + 1].line_base;
  return T_base_tcp_planned.inverse() * Vec3((1 - place.fraction) * a + place.fraction * b);
}

}  // namespace

namespace {

/// Marks the waypoints that were passed: near which a sample was, and those between two samples that follow
/// each other closely on the path.
class Passed {
 public:
  explicit Passed(const PlannedPath& path)
      : path_{path}, within_mm_{std::max(k_passed_mm, 0.6 * path.motion.spacing_mm)} {
    passed_.resize(path.waypoints.size(), false);
    for (const Waypoint& w : path.waypoints) fastest_mm_s_ = std::max(fastest_mm_s_, w.speed_mm_s);
  }

  void add(const PathPlace& place, const TrackSample& sample) {
    const Vec3 tip = sample.T_base_tcp.translation();
    for (const std::size_t i : {place.segment, place.segment + 1}) {
      if (off_waypoint_mm(path_, i, tip) < within_mm_) passed_[i] = true;
    }
    const bool near = off_path_mm(path_, place, tip) < within_mm_;
    const double gap_s = sample.time_s - last_time_s_, arc_mm = arc_at(path_, place);
    const bool follows = arc_mm - last_arc_mm_ <= fastest_mm_s_ * gap_s + k_passed_mm;
    if (near && last_near_ && gap_s <= k_unseen_s && follows) {
      for (std::size_t i = last_segment_ + 1; i <= place.segment; ++i) passed_[i] = true;
    }
    last_near_ = near;
    last_time_s_ = sample.time_s;
    last_arc_mm_ = arc_mm;
    last_segment_ = place.segment;
  }

  /// Of the line's waypoints.
  [[nodiscard]] double share() const {
    std::size_t all = 0, reached = 0;
    for (std::size_t i = 0; i < passed_.size(); ++i) {
      if (path_.waypoints[i].segment != Segment::Line) continue;
      ++all;
      if (passed_[i]) ++reached;
    }
    return all > 0 ? static_cast<double>(reached) / static_cast<double>(all) : 0;
  }

 private:
  const PlannedPath& path_;
  double within_mm_;
  double fastest_mm_s_{0};
  std::vector<bool> passed_;
  bool last_near_{false};
  double last_time_s_{0}, last_arc_mm_{0};
  std::size_t last_segment_{0};
};

/// Notes when the arm comes from one part of the path to the next.
class Parts {
 public:
  explicit Parts(double end_mm) : end_mm_{end_mm} {}

  void way_there(double time_s) {
    if (!first_s_) first_s_ = time_s;
    begun_s_ = time_s;
  }
  void on_path(double time_s, double arc_mm, bool on_line) {
    if (!line_from_s_ && on_line) line_from_s_ = time_s;
    if (on_line) line_until_s_ = time_s;
    if (!line_from_s_ || arc_mm < end_mm_) ended_s_ = time_s;
  }

  [[nodiscard]] PartTimes times() const {
    if (!first_s_ || !line_from_s_) return {};
    return {.way_there_s = begun_s_ - *first_s_,
            .approach_s = *line_from_s_ - begun_s_,
            .line_s = line_until_s_ - *line_from_s_,
            .retreat_s = std::max(0.0, ended_s_ - line_until_s_)};
  }

 private:
  double end_mm_;
  std::optional<double> first_s_{}, line_from_s_{};
  double begun_s_{0}, line_until_s_{0}, ended_s_{0};
};

}  // namespace

TrackDeviation deviation(const PlannedPath& path, std::span<const TrackSample> track) {
  TrackDeviation out;
  const double end_mm = path.waypoints.back().arc_mm;
  AlongPath along{path};
  double sum_mm = 0, sum_mm2 = 0, line_sum_mm = 0;
  std::vector<double> from_path_mm, from_line_mm;
  Passed passed{path};
  Parts parts{end_mm - k_passed_mm};
  for (const TrackSample& sample : track) {
    const Vec3 tip = sample.T_base_tcp.translation();
    if (along.here_mm() < 0) parts.way_there(sample.time_s);
    const std::optional<PathPlace> found = along.next(tip);
    if (!found) continue;
    const PathPlace& place = *found;
    passed.add(place, sample);
    const bool on_line = path.waypoints[place.segment].segment == Segment::Line &&
                         path.waypoints[place.segment + 1].segment == Segment::Line;
    parts.on_path(sample.time_s, along.here_mm(), on_line);
    if (!on_line) continue;
    const SE3 T_planned = pose_at(path, place);
    ++out.samples;
    // Where the path presses, the force is kept and not the place along it.
    const double off_mm = off_path_mm(path, place, tip);
    sum_mm += off_mm;
    sum_mm2 += off_mm * off_mm;
    from_path_mm.push_back(off_mm);
    if (off_mm > out.max_mm) {
      out.max_mm = off_mm;
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
  if (out.samples > 0) {
    const auto n = static_cast<double>(out.samples);
    out.mean_mm = sum_mm / n;
    out.rms_mm = std::sqrt(sum_mm2 / n);
    out.line_mean_mm = line_sum_mm / n;
    out.p95_mm = geometry::quantile_of(std::span<double>{from_path_mm}, 0.95);
    out.line_p95_mm = geometry::quantile_of(std::span<double>{from_line_mm}, 0.95);
  }
  out.covered = passed.share();
  out.parts = parts.times();
  out.completed = along.here_mm() >= end_mm - k_passed_mm;
  return out;
}

}  // namespace biteline::path
