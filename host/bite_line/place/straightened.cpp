// SPDX-License-Identifier: MIT
#include "host/bite_line/place/straightened.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "common/core/contracts.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_spacing_mm = 0.5;

/// As a closed curve, anticlockwise: along the guide, and back far above.
Outline unrolled_of(std::span<const Vec2> guide, double turn_mm, double beside_mm) {
  constexpr double k_beyond_mm = 80.0, k_far_mm = 500.0;
  const auto beyond = std::min(guide.size(), static_cast<std::size_t>(k_beyond_mm / k_spacing_mm));
  const Vec2 turn{turn_mm, 0};
  std::vector<Vec2> curve;
  for (const Vec2& place : guide.last(beyond)) curve.push_back(place - turn);
  curve.insert(curve.end(), guide.begin(), guide.end());
  for (const Vec2& place : guide.first(beyond)) curve.push_back(place + turn);
  const double end_mm = curve.back().x();
  const double begin_mm = curve.front().x();
  curve.emplace_back(end_mm, k_far_mm);
  curve.emplace_back(begin_mm, k_far_mm);
  return Outline{curve, {.spacing_mm = k_spacing_mm, .smoothing_mm = 0, .reach_mm = beside_mm}};
}

/// Of a place beside it; below 0 where there is none.
double along_curve(const Outline& unrolled, const Vec2& place) {
  const Eigen::Vector2f at = place.cast<float>();
  return static_cast<double>(unrolled.locate({at.x(), at.y(), 0}).s_mm);
}

/// Closed, and as long as the guide to the closing error of its turns.
Outline outline_of(const Outline& outline, const Outline& unrolled, double first_mm, double length_mm) {
  const auto count = static_cast<std::size_t>(std::lround(length_mm));
  const double step_mm = length_mm / static_cast<double>(count);
  std::vector<Vec2> curve;
  Vec2 at = Vec2::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    curve.push_back(at);
    const Vec2 out = outline.normal(unrolled.point(first_mm + (static_cast<double>(k) + 0.5) * step_mm).x());
    at += step_mm * Vec2{-out.y(), out.x()};
  }
  for (std::size_t k = 0; k < count; ++k)
    curve[k] -= static_cast<double>(k) / static_cast<double>(count) * at;
  return Outline{curve, {.smoothing_mm = 0}};
}

double height_of(const Vec2& place) {
  return place.y();
}

double mean_height(std::span<const Vec2> guide) {
  double sum = 0;
  for (const Vec2& place : guide) sum += place.y();
  return sum / static_cast<double>(guide.size());
}

}  // namespace

std::vector<Vec2> smooth_guide(std::span<const Vec2> guide, double turn_mm, double sigma_mm) {
  const Vec2 turn{turn_mm, 0};
  std::vector<double> at_mm{0};
  const auto next = [&](std::size_t i) -> Vec2 {
    return i + 1 < guide.size() ? guide[i + 1] : guide[0] + turn;
  };
  for (std::size_t i = 0; i < guide.size(); ++i) at_mm.push_back(at_mm.back() + (next(i) - guide[i]).norm());
  const auto count = static_cast<std::size_t>(std::lround(at_mm.back() / k_spacing_mm));
  const auto share_of = [&](std::size_t k) { return static_cast<double>(k) / static_cast<double>(count); };
  std::vector<Vec2> from_straight;  // closed, unlike the guide itself
  for (std::size_t k = 0, i = 0; k < count; ++k) {
    const double mm = at_mm.back() * share_of(k);
    while (i + 1 < guide.size() && at_mm[i + 1] <= mm) ++i;
    const double share = (mm - at_mm[i]) / std::max(at_mm[i + 1] - at_mm[i], 1e-9);
    from_straight.push_back((1 - share) * guide[i] + share * next(i) - share_of(k) * turn);
  }
  std::vector<Vec2> smooth =
      geometry::smooth_closed<Vec2>(from_straight, sigma_mm / k_spacing_mm, Vec2::Zero());
  for (std::size_t k = 0; k < count; ++k) smooth[k] += share_of(k) * turn;
  return smooth;
}

OrRefusal<Straightened> Straightened::along(const Side& side, std::span<const Vec2> guide, double beside_mm) {
  constexpr double k_least_ratio = 0.9;  // nothing that goes round is shorter than the outline, to rounding
  BITELINE_EXPECTS(guide.size() > 2);
  const double turn_mm = side.outline.length_mm();
  Outline unrolled = unrolled_of(guide, turn_mm, beside_mm);
  const double first_mm = along_curve(unrolled, guide.front());
  const double length_mm = along_curve(unrolled, guide.front() + Vec2{turn_mm, 0}) - first_mm;
  if (first_mm < 0 || length_mm < k_least_ratio * turn_mm)
    return refuse(Refused::NoCreaseAllRound, "the crease that was followed turns back: it does not go round");
  return Straightened{side, guide, std::move(unrolled), first_mm, length_mm, beside_mm};
}

Straightened::Straightened(const Side& side, std::span<const Vec2> guide, Outline unrolled, double first_mm,
                           double length_mm, double beside_mm)
    : side_{side},
      begin_mm_{guide.front().x()},
      low_mm_{static_cast<float>(std::ranges::min(guide, {}, &height_of).y() - beside_mm)},
      high_mm_{static_cast<float>(std::ranges::max(guide, {}, &height_of).y() + beside_mm)},
      unrolled_{std::move(unrolled)},
      first_mm_{first_mm},
      length_mm_{length_mm},
      height_mm_{mean_height(guide)},
      outline_{outline_of(side.outline, unrolled_, first_mm_, length_mm_)} {}

void Straightened::level(std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> to) const {
  std::vector<Eigen::Vector3f> near;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < points.size(); ++i) {
    to[i] = Eigen::Vector3f::Zero();
    if (!(points[i].z() >= low_mm_ && points[i].z() <= high_mm_)) continue;
    near.push_back(points[i]);
    index.push_back(i);
  }
  std::vector<OutlinePlace> places(near.size());
  side_.outline.locate(near, places);
  std::vector<Eigen::Vector3f> unrolled(near.size());
  const auto begin_mm = static_cast<float>(begin_mm_);
  const auto turn_mm = static_cast<float>(side_.outline.length_mm());
  for (std::size_t i = 0; i < near.size(); ++i)
    unrolled[i] = {places[i].s_mm + (places[i].s_mm < begin_mm ? turn_mm : 0.0F), places[i].z_mm, 0};
  std::vector<OutlinePlace> beside(near.size());
  unrolled_.locate(unrolled, beside);
  const double stretch = outline_.length_mm() / length_mm_;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (places[i].s_mm < 0 || beside[i].s_mm < 0) continue;
    const double u_mm = (static_cast<double>(beside[i].s_mm) - first_mm_) * stretch;
    const Vec2 plan = outline_.outwards(u_mm, static_cast<double>(places[i].o_mm));
    // Outwards of the unrolled curve is down.
    to[index[i]] = {static_cast<float>(plan.x()), static_cast<float>(plan.y()),
                    static_cast<float>(height_mm_) - beside[i].o_mm};
  }
}

PooledVector<Eigen::Vector3f> Straightened::points(std::span<const Eigen::Vector3f> points_base) const {
  constexpr std::size_t k_piece = 8192;
  const Eigen::Isometry3f T_shoe_base = side_.shoe.T_base_shoe.inverse().cast<float>();
  PooledVector<Eigen::Vector3f> to(points_base.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, to.size(), k_piece}, [&](const auto& range) {
    std::vector<Eigen::Vector3f> in_shoe;
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      in_shoe.emplace_back(T_shoe_base * points_base[i]);
    level(in_shoe, {to.data() + range.begin(), range.size()});
  });
  return to;
}

Shoe Straightened::shoe() const {
  constexpr std::size_t k_piece = 8192;
  const Shoe& shoe = side_.shoe;
  PooledVector<Eigen::Vector3f> all(shoe.points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, all.size(), k_piece}, [&](const auto& range) {
    level({shoe.points.data() + range.begin(), range.size()}, {all.data() + range.begin(), range.size()});
  });
  Shoe level;
  level.length_mm = shoe.length_mm;
  level.width_mm = shoe.width_mm;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] == Eigen::Vector3f::Zero()) continue;
    level.points.push_back(all[i]);
    level.index.push_back(shoe.index[i]);
    level.alone.push_back(shoe.alone[i]);
    level.box.extend(all[i]);
  }
  return level;
}

double Straightened::along_unrolled(double u_mm) const {
  return first_mm_ + u_mm * length_mm_ / outline_.length_mm();
}

Vec2 Straightened::unrolled(const Vec2& level) const {
  const double mm = along_unrolled(level.x());
  return unrolled_.outwards(mm, height_mm_ - level.y());
}

Vec3 Straightened::back(const Vec3& level) const {
  const OutlinePlace place = outline_.locate(level.cast<float>());
  const Vec2 at = unrolled({place.s_mm, level.z()});
  const Vec2 plan = side_.outline.outwards(at.x(), static_cast<double>(place.o_mm));
  return {plan.x(), plan.y(), at.y()};
}

Vec2 Straightened::place(double u_mm) const {
  return unrolled_.point(along_unrolled(u_mm));
}

double Straightened::u_mm(const Vec2& place) const {
  const double turn_mm = outline_.length_mm();
  const double u = (along_curve(unrolled_, place) - first_mm_) * turn_mm / length_mm_;
  return u - turn_mm * std::floor(u / turn_mm);
}

double Straightened::upright_ratio(double u_mm) const {
  return std::min(1.0, std::abs(unrolled_.normal(along_unrolled(u_mm)).y()));
}

double Straightened::bend_per_mm(double u_mm) const {
  return unrolled_.bend_per_mm(along_unrolled(u_mm));
}

PlacedLine Straightened::back(PlacedLine placed) const {
  constexpr double k_step_mm = 1.0;  // along the normal
  for (PlacedStation& station : placed.points) {
    const double own_mm = station.own_z_mm - station.position.z();
    const Vec3 at = back(station.position);
    station.normal = (back(Vec3{station.position + k_step_mm * station.normal}) - at).normalized();
    station.position = at;
    station.own_z_mm = at.z() + own_mm;
  }
  return placed;
}

std::vector<Vec2> Straightened::guide(std::span<const Vec2> places) const {
  std::vector<Vec2> guide;
  for (const Vec2& at : places) guide.push_back(unrolled(at));
  return guide;
}

std::vector<double> Straightened::back(const SideField& level, std::span<const double> path_row) const {
  const SideGrid& grid = side_.field.grid;
  const auto cols = static_cast<std::size_t>(grid.cols);
  std::vector<double> sum(cols, 0.0), count(cols, 0.0);
  for (std::size_t c = 0; c < path_row.size(); ++c) {
    const Vec2 at =
        unrolled({(static_cast<double>(c) + 0.5) * level.grid.col_mm, level.grid.z_mm(path_row[c])});
    const double col = std::floor(at.x() / grid.col_mm);
    const std::size_t to = geometry::round_index(0, static_cast<std::ptrdiff_t>(col), cols);
    sum[to] += (at.y() - grid.z_low_mm) / grid.row_mm - 0.5;
    count[to] += 1;
  }
  std::vector<double> row(cols, 0.0);
  double last = 0;
  // Twice round: a column without a place of its own has that of the one before it.
  for (std::size_t k = 0; k < 2 * cols; ++k) {
    const std::size_t c = k % cols;
    if (count[c] > 0) last = sum[c] / count[c];
    row[c] = last;
  }
  return row;
}

}  // namespace biteline::bite_line
