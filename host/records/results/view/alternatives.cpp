// SPDX-License-Identifier: MIT
#include "host/records/results/view/alternatives.hpp"

#include <algorithm>
#include <cmath>

#include "host/report/refusal.hpp"

namespace biteline::results {
namespace {

using bite_line::Refused;

constexpr double k_same_mm = 1.0;
constexpr std::size_t k_most_points = 200;

std::size_t nearest(std::span<const Vec3> points, const Vec3& to) {
  return static_cast<std::size_t>(
      std::ranges::min_element(points, {}, [&](const Vec3& p) { return (p - to).squaredNorm(); }) -
      points.begin());
}

/// From `first` on to `last`, both among them.
std::vector<Vec3> part_of(std::span<const Vec3> points, std::size_t first, std::size_t last) {
  std::vector<Vec3> part{points[first]};
  for (std::size_t i = first; i != last;) {
    i = (i + 1) % points.size();
    part.push_back(points[i]);
  }
  return part;
}

double off_mm(std::span<const Vec3> way, std::span<const Vec3> line) {
  double most_mm = 0;
  for (const Vec3& point : way) most_mm = std::max(most_mm, (point - line[nearest(line, point)]).norm());
  return most_mm;
}

std::vector<Vec3> thinned(std::vector<Vec3> points) {
  if (points.size() <= k_most_points) return points;
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < k_most_points; ++k)
    kept.push_back(points[k * (points.size() - 1) / (k_most_points - 1)]);
  return kept;
}

Refused code_of(const WeakStretch& stretch, bool other_ways) {
  if (other_ways) return Refused::Rivalled;
  if (stretch.bridged_share > 0.5) return Refused::TooMuchBridged;
  return stretch.least_confidence >= cloud::k_sure_ratio ? Refused::TooMuchUncertain : Refused::TooMuchUnsure;
}

}  // namespace

std::vector<Alternative> alternatives(const cloud::ClosedLine& line, const WeakStretch& stretch,
                                      std::span<const bite_line::Candidate> candidates) {
  std::vector<Alternative> found;
  std::vector<Vec3> places;
  for (const cloud::LinePoint& point : line.points) places.push_back(point.position);
  const bool all_round = stretch.length_mm > 0.98 * cloud::length_mm(line);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::vector<Vec3>& way = candidates[i].points;
    if (way.size() < 3) continue;
    const std::size_t first = nearest(way, stretch.begin_base), last = nearest(way, stretch.end_base);
    std::vector<Vec3> part = all_round ? way : part_of(way, first, last);
    const double off = off_mm(part, places);
    if (!(off > k_same_mm)) continue;
    found.push_back(
        {.candidate = static_cast<int>(i) + 1, .off_mm = off, .points = thinned(std::move(part))});
  }
  return found;
}

nlohmann::ordered_json as_open(const std::vector<WeakStretch>& stretches, const cloud::ClosedLine& line,
                               std::span<const bite_line::Candidate> candidates) {
  nlohmann::ordered_json list = as_json(stretches, cloud::length_mm(line));
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    nlohmann::ordered_json ways = nlohmann::ordered_json::array();
    for (const Alternative& other : alternatives(line, stretches[i], candidates)) {
      nlohmann::ordered_json points = nlohmann::ordered_json::array();
      for (const Vec3& p : other.points) {
        const auto rounded = [](double mm) { return std::round(100 * mm) / 100; };
        points.push_back({rounded(p.x()), rounded(p.y()), rounded(p.z())});
      }
      ways.push_back(
          {{"candidate", other.candidate}, {"off_mm", other.off_mm}, {"points", std::move(points)}});
    }
    list[i]["reason_code"] = report::refusal_row(code_of(stretches[i], !ways.empty())).name;
    list[i]["alternatives"] = std::move(ways);
  }
  return list;
}

}  // namespace biteline::results
