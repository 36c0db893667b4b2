// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// An alternative whose mass is still the odds against the curve.
using Odds = CurveAlternative;

class Stations {
 public:
  Stations(const Raster& raster, const ClosedCurve& curve, double same_mm)
      : turn_mm_{raster.col_mm * raster.cols}, same_mm_{same_mm} {
    for (const CurveState& at : curve.states) places_.push_back(raster.place(at.row, at.col));
    others_.resize(places_.size());
  }

  void add(const CurveRival& rival, double odds) {
    const bool all_round = rival.count == places_.size();
    for (std::size_t k = 0; k < rival.count; ++k) {
      const std::size_t i = (rival.first + k) % places_.size();
      const Odds other = beside(i, rival, odds);
      // Found beside another curve, it may run on this one here and there.
      if (all_round && std::abs(other.off_mm) <= same_mm_) continue;
      add(i, other);
    }
  }

  /// `odds`: that a place is not on the line, whatever rivals it has.
  [[nodiscard]] std::vector<CurveStation> stations(std::span<const double> odds, double least_mass) const {
    std::vector<CurveStation> all;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      CurveStation station{.place = places_[i]};
      double sum = 1 + odds[i];
      for (const Odds& other : others_[i]) sum += other.mass;
      station.hold = 1 / sum;
      for (Odds other : others_[i]) {
        other.mass /= sum;
        if (other.mass >= least_mass) station.alternatives.push_back(other);
      }
      std::ranges::sort(station.alternatives, std::ranges::greater{}, &CurveAlternative::mass);
      all.push_back(std::move(station));
    }
    return all;
  }

 private:
  /// Way from `a` to `b` on the side, which closes.
  [[nodiscard]] Vec2 to(const Vec2& a, const Vec2& b) const {
    Vec2 way = b - a;
    way.x() -= turn_mm_ * std::round(way.x() / turn_mm_);
    return way;
  }

  [[nodiscard]] Vec2 along_at(std::size_t i) const {
    constexpr std::ptrdiff_t k_about = 4;
    return to(places_[geometry::round_index(i, -k_about, places_.size())],
              places_[geometry::round_index(i, k_about, places_.size())])
        .normalized();
  }

  /// The rival's place that lies most square to the curve.
  [[nodiscard]] Odds beside(std::size_t i, const CurveRival& rival, double odds) const {
    constexpr double k_nearer = 0.2;  // of two as square, the nearer one
    const Vec2 along = along_at(i);
    double least = std::numeric_limits<double>::max();
    Vec2 best = Vec2::Zero();
    for (const Vec2& place : rival.places) {
      const Vec2 way = to(places_[i], place);
      const double skew = std::abs(way.dot(along)) + k_nearer * way.norm();
      if (skew >= least) continue;
      least = skew;
      best = way;
    }
    const Vec2 left{-along.y(), along.x()};
    return {.place = places_[i] + best, .off_mm = best.dot(left), .mass = odds};
  }

  void add(std::size_t i, const Odds& odds) {
    for (Odds& other : others_[i]) {
      if (std::abs(other.off_mm - odds.off_mm) > same_mm_) continue;
      if (odds.mass > other.mass) other = odds;
      return;
    }
    others_[i].push_back(odds);
  }

  double turn_mm_, same_mm_;
  std::vector<Vec2> places_;
  std::vector<std::vector<Odds>> others_;
};

template <class Signs>
double sum_of(const Signs& weights, const Signs& signs) {
  return std::inner_product(weights.begin(), weights.end(), signs.begin(), 0.0);
}

double log_of(double per_mm, double most_per_mm = k_most_cost_per_mm) {
  constexpr double k_least_per_mm = 0.02;  // nothing is plainer
  return std::log(std::clamp(per_mm, k_least_per_mm, most_per_mm));
}

}  // namespace

double more_per_mm(const CurveRival& rival) {
  constexpr double k_soft_mm = 25;
  return rival.excess / (rival.length_mm + k_soft_mm);
}

bool leads_all_round(const CurveRival& rival, const ClosedCurve& curve) {
  return 10 * rival.count > 9 * curve.states.size();
}

RoundSigns round_signs(const CurveRival& rival) {
  const double side = rival.above_mm > 0 ? 1 : -1;
  return {side, side * (rival.two_surfaces - 1), side * rival.uneven};
}

PartSigns part_signs(const CurveRival& rival) {
  // What shows nothing is no better known for that.
  constexpr double k_most_per_mm = static_cast<double>(k_unseen_cost_per_mm);
  return {1, log_of(rival.own_per_mm, k_most_per_mm), log_of(rival.faintest_per_mm)};
}

std::vector<std::optional<PlaceSigns>> place_signs(const ClosedCurve& curve,
                                                   std::span<const CurveRival> rivals,
                                                   const CurveLook& look) {
  const std::size_t n = curve.states.size();
  const double length_mm = length_of(curve.states);
  std::vector<double> above(n, 0.0);
  for (const CurveRival& rival : rivals) {
    if (!rival.seen || !(rival.above_mm > 0) || leads_all_round(rival, curve)) continue;
    const double share = rival.two_surfaces * std::min(1.0, rival.length_mm / length_mm);
    for (std::size_t k = 0; k < rival.count; ++k) {
      double& most = above[(rival.first + k) % n];
      most = std::max(most, share);
    }
  }
  std::vector<std::optional<PlaceSigns>> signs(n);
  for (std::size_t i = 0; i < look.places.size(); ++i) {
    const PlaceLook& at = look.places[i];
    if (at.seen)
      signs[i] = PlaceSigns{
          1, log_of(at.per_mm), at.rim, log_of(look.per_mm), at.unlike_rim, at.unlike_below, above[i]};
  }
  return signs;
}

double log_odds_of(const CurveRival& rival, const ClosedCurve& curve, const PosteriorConfig& config) {
  if (!rival.seen) return config.unseen + config.unseen_more * more_per_mm(rival);
  if (leads_all_round(rival, curve)) return sum_of(config.round, round_signs(rival)) + rival.as_whole;
  return sum_of(config.part, part_signs(rival));
}

std::vector<CurveStation> curve_posterior(const Raster& raster, const ClosedCurve& curve,
                                          std::span<const CurveRival> rivals, const CurveLook& look,
                                          double same_mm, const PosteriorConfig& config) {
  Stations stations{raster, curve, same_mm};
  for (const CurveRival& rival : rivals) stations.add(rival, std::exp(log_odds_of(rival, curve, config)));
  std::vector<double> odds;
  for (const std::optional<PlaceSigns>& signs : place_signs(curve, rivals, look))
    odds.push_back(signs ? config.place_rarer * std::exp(sum_of(config.place, *signs)) : 0.0);
  return stations.stations(odds, config.least_mass);
}

}  // namespace biteline::bite_line
