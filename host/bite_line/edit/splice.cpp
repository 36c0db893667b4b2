// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/splice.hpp"

#include <algorithm>
#include <cmath>

#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "host/geometry/bridge.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::edit {
namespace {

using cloud::ClosedLine;
using cloud::LinePoint;
using cloud::PointSource;

/// The places of a curve that has two ends, by their way from its start.
std::vector<double> ways_mm(std::span<const LinePoint> points) {
  std::vector<double> way{0.0};
  for (std::size_t i = 1; i < points.size(); ++i)
    way.push_back(way.back() + (points[i].position - points[i - 1].position).norm());
  return way;
}

double smooth_step(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

LinePoint mixed(const LinePoint& a, const LinePoint& b, double share) {
  LinePoint point = share < 0.5 ? a : b;
  point.position = (1 - share) * a.position + share * b.position;
  const Vec3 normal = (1 - share) * a.normal + share * b.normal;
  if (normal.norm() > 1e-9) point.normal = normal.normalized();
  // The worse of two is said.
  point.confidence = std::min(a.confidence, b.confidence);
  if (a.u95_mm && b.u95_mm) point.u95_mm = std::max(*a.u95_mm, *b.u95_mm);
  if (a.source != PointSource::Seen) point.source = a.source;
  return point;
}

LinePoint at_way(std::span<const LinePoint> points, std::span<const double> way_mm, double mm) {
  const auto above = std::upper_bound(way_mm.begin() + 1, way_mm.end() - 1, mm);
  const auto i = static_cast<std::size_t>(above - way_mm.begin());
  const double step_mm = std::max(way_mm[i] - way_mm[i - 1], 1e-12);
  return mixed(points[i - 1], points[i], std::clamp((mm - way_mm[i - 1]) / step_mm, 0.0, 1.0));
}

/// A place that the stretch is moved to, and by how much there.
struct Anchor {
  double way_mm{0};
  Vec3 move{Vec3::Zero()};
};

/// Between neighbouring anchors a smooth step from one move to the next.
void move_between(std::vector<LinePoint>& points, std::span<const double> way_mm,
                  std::vector<Anchor> anchors) {
  constexpr double k_moved_mm = 0.1;
  std::stable_sort(anchors.begin(), anchors.end(),
                   [](const Anchor& a, const Anchor& b) { return a.way_mm < b.way_mm; });
  std::size_t next = 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (next + 1 < anchors.size() && way_mm[i] > anchors[next].way_mm) ++next;
    const Anchor& a = anchors[next - 1];
    const Anchor& b = anchors[next];
    const double share = smooth_step((way_mm[i] - a.way_mm) / std::max(b.way_mm - a.way_mm, 1e-9));
    const Vec3 move = (1 - share) * a.move + share * b.move;
    points[i].position += move;
    if (move.norm() > k_moved_mm) points[i].source = PointSource::Bridged;
  }
}

}  // namespace

std::size_t nearest_index(const ClosedLine& line, const Vec3& place) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    if ((line.points[i].position - place).squaredNorm() <
        (line.points[nearest].position - place).squaredNorm())
      nearest = i;
  }
  return nearest;
}

std::vector<LinePoint> between(const ClosedLine& line, Ends ends) {
  std::vector<LinePoint> points{line.points[ends.first]};
  for (std::size_t i = ends.first; i != ends.last;) {
    i = (i + 1) % line.points.size();
    points.push_back(line.points[i]);
  }
  return points;
}

std::vector<LinePoint> led_stretch(const ClosedLine& placed, const ClosedLine& line, Ends ends,
                                   const Word& word, std::vector<Snap>* snaps) {
  constexpr double k_lead_in_mm = 5.0;  // half the running mean along a placed line, and a little
  constexpr double k_snap_mm = 1.5;     // a hand is no better
  constexpr double k_near_mm = 20.0;
  const LinePoint& first = line.points[ends.first];
  const LinePoint& last = line.points[ends.last];
  std::vector<LinePoint> points = between(
      placed, {.first = nearest_index(placed, first.position), .last = nearest_index(placed, last.position)});
  const std::vector<double> way_mm = ways_mm(points);
  const double lead_mm = std::min(k_lead_in_mm, way_mm.back() / 2);
  const Vec3 off_first = first.position - points.front().position;
  const Vec3 off_last = last.position - points.back().position;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].position += (1 - smooth_step(way_mm[i] / lead_mm)) * off_first +
                          (1 - smooth_step((way_mm.back() - way_mm[i]) / lead_mm)) * off_last;
  }
  std::vector<Anchor> anchors{{.way_mm = 0}, {.way_mm = way_mm.back()}};
  for (const Vec3& hint : word.hints) {
    const auto nearest = static_cast<std::size_t>(
        std::min_element(points.begin(), points.end(),
                         [&](const LinePoint& a, const LinePoint& b) {
                           return (a.position - hint).squaredNorm() < (b.position - hint).squaredNorm();
                         }) -
        points.begin());
    const Vec3 off = hint - points[nearest].position;
    const bool snapped = points[nearest].source == PointSource::Seen && off.norm() <= k_snap_mm;
    anchors.push_back({.way_mm = way_mm[nearest], .move = snapped ? Vec3{Vec3::Zero()} : off});
    if (snaps != nullptr)
      snaps->push_back({.wanted = hint, .on_crease = snapped, .by_mm = snapped ? off.norm() : 0});
  }
  const bool led = !word.hints.empty();
  std::vector<double> set_mm;
  for (const Anchor& anchor : anchors) set_mm.push_back(anchor.way_mm);
  move_between(points, way_mm, std::move(anchors));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool near =
        led && std::ranges::any_of(set_mm, [&](double mm) { return std::abs(way_mm[i] - mm) <= k_near_mm; });
    if (word.chosen || near) mark_by_hand(points[i]);
  }
  // Its own figures stay: an end may be as unsure as what is mended was.
  const auto join = [](LinePoint& point, const LinePoint& end) {
    point.position = end.position;
    point.normal = end.normal;
    point.tangent = end.tangent;
  };
  join(points.front(), first);
  join(points.back(), last);
  return points;
}

std::vector<LinePoint> bridged_stretch(const ClosedLine& line, Ends ends) {
  const std::size_t count = line.points.size();
  const double spacing_mm = cloud::length_mm(line) / static_cast<double>(count);
  const auto lever = static_cast<std::ptrdiff_t>(std::lround(geometry::k_end_lever_mm / spacing_mm));
  const auto end_at = [&](std::size_t end, std::ptrdiff_t away) {
    const auto place = [&](std::ptrdiff_t by) {
      return line.points[geometry::round_index(end, by, count)].position;
    };
    return geometry::CurveEnd{.end = place(0), .near = place(away), .far = place(2 * away)}.direction();
  };
  const LinePoint& first = line.points[ends.first];
  const LinePoint& last = line.points[ends.last];
  const geometry::Arc arc{.p0 = first.position,
                          .d0 = end_at(ends.first, -lever),
                          .p1 = last.position,
                          .d1 = -end_at(ends.last, lever)};
  const double chord_mm = (last.position - first.position).norm();
  const auto steps = static_cast<std::size_t>(std::max(2.0, std::ceil(1.2 * chord_mm / spacing_mm)));
  std::vector<LinePoint> points;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(steps);
    LinePoint point = mixed(first, last, share);
    point.position = arc.at(share);
    const double doubt =
        bite_line::gap_doubt(std::min(share, 1 - share) * chord_mm, chord_mm, arc.turn_rad());
    bite_line::PlacedStation station;
    station.doubt = doubt;
    // An end that is doubted itself says nothing of the bridge.
    point.confidence = std::min(std::max(point.confidence, k_hand_confidence), 1 / (1 + doubt));
    point.u95_mm =
        uncertainty::u95_mm(uncertainty::principal_axes(bite_line::spread_of(station).covariance_mm2), 1, 0);
    point.source = PointSource::Bridged;
    points.push_back(point);
  }
  points.front() = first;
  points.back() = last;
  return points;
}

void mark_by_hand(LinePoint& point) {
  const bool seen = point.source == PointSource::Seen;
  point.u95_mm = seen ? std::min(point.u95_mm.value_or(k_hand_u95_mm), k_hand_u95_mm) : k_hand_u95_mm;
  point.confidence = seen ? std::max(point.confidence, k_hand_confidence) : k_hand_confidence;
  point.source = PointSource::Mended;
  point.flags = 0;
}

void mark_mended(LinePoint& point) {
  if (point.source != PointSource::Seen && point.source != PointSource::Mended)
    point.u95_mm = std::max(point.u95_mm.value_or(0), k_hand_u95_mm);
  point.source = PointSource::Mended;
  point.flags = 0;
  cloud::flag_unsure(point);
}

void mark_mended(LinePoint& point, const LinePoint& replaced) {
  point.confidence = std::min(point.confidence, replaced.confidence);
  mark_mended(point);
}

ClosedLine splice(const ClosedLine& line, Ends ends, std::span<const LinePoint> stretch) {
  const std::size_t count = line.points.size();
  const double spacing_mm = cloud::length_mm(line) / static_cast<double>(count);
  const std::vector<double> way_mm = ways_mm(stretch);
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::round(way_mm.back() / spacing_mm)));

  ClosedLine out;
  const auto keep = [&](std::size_t from, std::size_t end) {
    for (std::size_t i = from; i < end; ++i) out.points.push_back(line.points[i]);
  };
  const auto put = [&] {
    for (std::size_t k = 1; k < steps; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(steps);
      LinePoint point = at_way(stretch, way_mm, share * way_mm.back());
      mark_mended(point);
      out.points.push_back(point);
    }
  };
  if (ends.first < ends.last) {
    keep(0, ends.first + 1);
    put();
    keep(ends.last, count);
  } else {
    // Across the first row: the line begins behind the stretch.
    keep(ends.last, ends.first + 1);
    put();
  }
  bite_line::add_tangents(out);
  bite_line::turn_normals_across(out);
  return out;
}

}  // namespace biteline::edit
