// SPDX-License-Identifier: MIT
#include "host/records/results/view/weak_stretches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace biteline::results {
namespace {

constexpr double k_least_confidence = 0.5;
constexpr double k_most_u95_mm = 1;
constexpr double k_join_mm = 3;      // a person looks at both at once
constexpr double k_bend_mm = 2;      // less may be the scan's own tilt
constexpr double k_inside_mm = 0.3;  // what a confidence speaks of
constexpr double k_most_told_mm = 10;

double u95_mm(const cloud::LinePoint& point) {
  return point.u95_mm ? *point.u95_mm : u95_of_confidence_mm(point.confidence);
}

bool is_weak(const cloud::LinePoint& point) {
  return (point.flags & cloud::k_line_unsure) != 0 || point.confidence < k_least_confidence ||
         (point.u95_mm && *point.u95_mm > k_most_u95_mm);
}

/// The line in the shoe's frame, and how far it reaches along the shoe.
struct Plan {
  std::vector<Vec3> points;
  double heel_mm{0}, toe_mm{0};

  Plan(const cloud::ClosedLine& line, const SE3& T_base_shoe) {
    const SE3 T_shoe_base = T_base_shoe.inverse();
    for (const cloud::LinePoint& point : line.points) points.push_back(T_shoe_base * point.position);
    if (points.empty()) return;
    const auto by_x = [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); };
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), by_x);
    heel_mm = low->x();
    toe_mm = high->x();
  }

  [[nodiscard]] double share(const Vec3& point) const {
    return (point.x() - heel_mm) / std::max(1e-9, toe_mm - heel_mm);
  }

  /// Middle between the two sides where the share along the shoe lies in [from, to].
  [[nodiscard]] double middle_y_mm(double from, double to) const {
    double low = 1e9, high = -1e9;
    for (const Vec3& point : points) {
      if (share(point) < from || share(point) > to) continue;
      low = std::min(low, point.y());
      high = std::max(high, point.y());
    }
    return low <= high ? 0.5 * (low + high) : 0;
  }
};

std::string place_of(const Vec3& point_shoe, const Plan& plan, InnerSide inner) {
  const double share = plan.share(point_shoe);
  if (share < 0.06) return "heel";
  if (share > 0.95) return "toe";
  const bool left = point_shoe.y() > plan.middle_y_mm(share - 0.04, share + 0.04);
  std::string place = left ? "left side" : "right side";
  if (inner != InnerSide::Unknown) place += (inner == InnerSide::Left) == left ? " (inner)" : " (outer)";
  return place + (share < 0.3 ? ", at the heel" : share > 0.7 ? ", at the toe" : ", in the middle");
}

}  // namespace

double u95_of_confidence_mm(double confidence) {
  // P(r < a) = 1 - exp(-a^2 / 2 s^2), so that r95 = a sqrt(ln 0.05 / ln(1 - P)).
  const double outside = 1 - std::clamp(confidence, 1e-6, 1 - 1e-9);
  return std::min(k_most_told_mm, k_inside_mm * std::sqrt(std::log(0.05) / std::log(outside)));
}

InnerSide inner_side(const cloud::ClosedLine& line, const SE3& T_base_shoe) {
  if (line.points.size() < 20) return InnerSide::Unknown;
  const Plan plan{line, T_base_shoe};
  const double heel_mm = plan.middle_y_mm(0.05, 0.15), ball_mm = plan.middle_y_mm(0.6, 0.7),
               toe_mm = plan.middle_y_mm(0.9, 0.97);
  // Straight on from heel (0.10) over ball (0.65) to the toe (0.935).
  const double straight_mm = ball_mm + (ball_mm - heel_mm) * (0.935 - 0.65) / (0.65 - 0.10);
  const double bend_mm = toe_mm - straight_mm;
  if (std::abs(bend_mm) < k_bend_mm) return InnerSide::Unknown;
  return bend_mm > 0 ? InnerSide::Left : InnerSide::Right;
}

std::vector<WeakStretch> weak_stretches(const cloud::ClosedLine& line, const SE3& T_base_shoe) {
  const std::size_t count = line.points.size();
  if (count == 0) return {};
  const Plan plan{line, T_base_shoe};
  const InnerSide inner = inner_side(line, T_base_shoe);
  const double spacing_mm = cloud::length_mm(line) / static_cast<double>(count);
  const auto is_weak_at = [&](std::size_t i) { return is_weak(line.points[i % count]); };

  // Begin behind a sound stretch, so that no run is cut in two where the rows begin.
  const auto gap = static_cast<std::size_t>(std::ceil(k_join_mm / std::max(1e-6, spacing_mm)));
  std::size_t begin = 0, sound = 0;
  for (std::size_t i = 0; i < 2 * count && sound <= gap; ++i) {
    sound = is_weak_at(i) ? 0 : sound + 1;
    if (sound > gap) begin = i % count;
  }

  std::vector<WeakStretch> stretches;
  std::size_t last = 0;  // of the run that is being built, counted from `begin`
  std::size_t first = 0;
  std::size_t bridged = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = (begin + k) % count;
    const cloud::LinePoint& point = line.points[i];
    if (!is_weak(point)) continue;
    if (stretches.empty() || k - last > gap) {
      stretches.push_back({.from_mm = static_cast<double>(i) * spacing_mm, .begin_base = point.position});
      first = k;
      bridged = 0;
    }
    WeakStretch& stretch = stretches.back();
    last = k;
    stretch.length_mm = static_cast<double>(k - first + 1) * spacing_mm;
    bridged += point.source == cloud::PointSource::Bridged ? 1 : 0;
    stretch.bridged_share = static_cast<double>(bridged) / static_cast<double>(k - first + 1);
    stretch.least_confidence = std::min(stretch.least_confidence, point.confidence);
    stretch.u95_mm = std::max(stretch.u95_mm, u95_mm(point));
    stretch.u95_is_guessed = stretch.u95_is_guessed || !point.u95_mm;
    const std::size_t middle = (begin + (first + k) / 2) % count;
    stretch.middle_base = line.points[middle].position;
    stretch.end_base = point.position;
    stretch.place = place_of(plan.points[middle], plan, inner);
  }
  std::sort(stretches.begin(), stretches.end(),
            [](const WeakStretch& a, const WeakStretch& b) { return a.from_mm < b.from_mm; });
  return stretches;
}

nlohmann::ordered_json as_json(const std::vector<WeakStretch>& stretches, double line_length_mm) {
  const auto xyz = [](const Vec3& p) { return nlohmann::ordered_json{p.x(), p.y(), p.z()}; };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const WeakStretch& stretch : stretches) {
    list.push_back({{"place", stretch.place},
                    {"from_mm", stretch.from_mm},
                    {"to_mm", std::fmod(stretch.from_mm + stretch.length_mm, line_length_mm)},
                    {"length_mm", stretch.length_mm},
                    {"least_confidence", stretch.least_confidence},
                    {"u95_mm", stretch.u95_mm},
                    {"u95_is_guessed", stretch.u95_is_guessed},
                    {"begin_mm", xyz(stretch.begin_base)},
                    {"middle_mm", xyz(stretch.middle_base)},
                    {"end_mm", xyz(stretch.end_base)}});
  }
  return list;
}

std::string warning(const std::vector<WeakStretch>& stretches) {
  if (stretches.empty()) return {};
  double length_mm = 0, worst_mm = 0;
  for (const WeakStretch& stretch : stretches) {
    length_mm += stretch.length_mm;
    worst_mm = std::max(worst_mm, stretch.u95_mm);
  }
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu weak %s, %.1f mm in all; the likely error is up to %.2f mm: look there first",
                stretches.size(), stretches.size() == 1 ? "stretch" : "stretches", length_mm, worst_mm);
  return text;
}

}  // namespace biteline::results
