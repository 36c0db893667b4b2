// SPDX-License-Identifier: MIT
#include "host/robot/path/targets.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace biteline::path {
namespace {

using Way = std::span<const Vec3>;

/// The first place at and after `from` that lies `apart_mm` away from it in a straight line.
std::optional<FinePlace> next_place(Way way, const FinePlace& from, double apart_mm) {
  for (std::size_t k = from.sample; k + 1 < way.size(); ++k) {
    if ((way[k + 1] - from.tip).norm() < apart_mm) continue;
    // |a + t d| = apart, of which the greater t leaves the ball.
    const Vec3 a = (k == from.sample ? from.tip : way[k]) - from.tip, d = way[k + 1] - from.tip - a;
    const double b = a.dot(d), c = a.squaredNorm() - apart_mm * apart_mm, dd = d.squaredNorm();
    const double t = dd > 0 ? std::clamp((-b + std::sqrt(std::max(0.0, b * b - dd * c))) / dd, 0.0, 1.0) : 1;
    const Vec3 tip = from.tip + a + t * d;
    const double whole_mm = (way[k + 1] - way[k]).norm();
    return FinePlace{
        .sample = k, .fraction = whole_mm > 0 ? (tip - way[k]).norm() / whole_mm : 1, .tip = tip};
  }
  return std::nullopt;
}

std::vector<FinePlace> places_apart(Way way, double apart_mm) {
  std::vector<FinePlace> places{{.sample = 0, .fraction = 0, .tip = way.front()}};
  while (const std::optional<FinePlace> next = next_place(way, places.back(), apart_mm))
    places.push_back(*next);
  return places;
}

double from_segment_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 way = b - a;
  const double length2 = way.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * way).norm();
}

}  // namespace

// So that the last digit of a distance leaves the whole blend.
constexpr double k_rounding_mm = 1e-6;

double target_spacing_mm(const Motion& motion, double way_mm) {
  return std::max({motion.spacing_mm, (motion.blend_mm + k_rounding_mm) / k_blend_share,
                   way_mm / static_cast<double>(k_most_line_targets)});
}

std::vector<FinePlace> even_places(std::span<const Vec3> way, double spacing_mm) {
  std::vector<FinePlace> places = places_apart(way, spacing_mm);
  // What is left before the end is spread over the steps: the widest spacing with as many of them.
  const std::size_t count = places.size();
  double least_mm = spacing_mm, most_mm = 2 * spacing_mm;
  constexpr int k_halvings = 30;  // to 1e-9 of the spacing
  for (int i = 0; i < k_halvings; ++i) {
    const double tried_mm = 0.5 * (least_mm + most_mm);
    std::vector<FinePlace> tried = places_apart(way, tried_mm);
    if (tried.size() < count) {
      most_mm = tried_mm;
    } else {
      least_mm = tried_mm;
      places = std::move(tried);
    }
  }
  if (places.size() > 1) places.pop_back();
  places.push_back({.sample = way.size() - 2, .fraction = 1, .tip = way.back()});
  return places;
}

ChordError chord_error(std::span<const Vec3> way, const std::vector<FinePlace>& places, double blend_mm) {
  ChordError worst;
  double arc_mm = 0;
  const auto look = [&](double error_mm) {
    if (error_mm > worst.mm) worst = {.mm = error_mm, .arc_mm = arc_mm};
  };
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Vec3 &a = places[i].tip, &b = places[i + 1].tip;
    for (std::size_t k = places[i].sample + 1; k <= places[i + 1].sample; ++k)
      look(from_segment_mm(way[k], a, b));
    if (i > 0) {
      const Vec3 in = a - places[i - 1].tip, out = b - a;
      look(0.5 * blend_mm * std::sin(0.5 * std::atan2(in.cross(out).norm(), in.dot(out))));
    }
    arc_mm += (b - a).norm();
  }
  return worst;
}

std::vector<double> blend_radii_mm(std::span<const Vec3> tips, double wished_mm) {
  std::vector<double> radii(tips.size(), 0.0);
  for (std::size_t i = 1; i + 1 < tips.size(); ++i) {
    const double room_mm = std::min((tips[i] - tips[i - 1]).norm(), (tips[i + 1] - tips[i]).norm());
    radii[i] = std::min(wished_mm, k_blend_share * room_mm);
  }
  return radii;
}

}  // namespace biteline::path
