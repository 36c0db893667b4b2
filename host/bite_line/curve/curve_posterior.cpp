// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/curve_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// Which station of the curve is near a cell.
class NearCurve {
 public:
  NearCurve(const Raster& raster, const std::vector<Vec2>& places, double reach_mm)
      : raster_{raster}, station_(raster.size(), -1), count_{static_cast<int>(places.size())} {
    const int reach = static_cast<int>(reach_mm / Raster::k_cell_mm);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const int row = static_cast<int>(std::lround(raster.row_of(places[i].y())));
      const int col = static_cast<int>(std::lround(raster.col_of(places[i].x())));
      for (int c = -reach; c <= reach; ++c)
        for (int r = std::max(-reach, -row); r <= std::min(reach, raster.rows - 1 - row); ++r)
          station_[raster.at(row + r, raster.round_col(col + c))] = static_cast<int>(i);
    }
  }
  /// Whether a cell lies beside a part of the curve that is `far` stations and more away.
  [[nodiscard]] bool elsewhere(std::size_t cell, int station, int far) const {
    if (station_[cell] < 0) return false;
    const int away = std::abs(station_[cell] - station);
    return std::min(away, count_ - away) > far;
  }

 private:
  const Raster& raster_;
  std::vector<int> station_;
  int count_;
};

/// A place of a section, and how much a curve through it counts.
struct OnSection {
  double off_mm;
  Vec2 place;
  double weight;
};

class Sections {
 public:
  Sections(const Raster& raster, const ClosedCurve& curve, const Large<float>& excess,
           const PosteriorConfig& config)
      : raster_{raster},
        excess_{excess},
        config_{config},
        places_{places_of(raster, curve)},
        near_{raster, places_, config.same_mm} {}

  [[nodiscard]] std::vector<CurveStation> stations() const {
    std::vector<CurveStation> all;
    for (std::size_t i = 0; i < places_.size(); ++i) all.push_back(station(i));
    return all;
  }

 private:
  static std::vector<Vec2> places_of(const Raster& raster, const ClosedCurve& curve) {
    std::vector<Vec2> places;
    for (const CurveState& state : curve.states) places.push_back(raster.place(state.row, state.col));
    return places;
  }

  [[nodiscard]] Vec2 left_at(std::size_t i) const {
    constexpr std::ptrdiff_t k_about = 4;
    const double turn_mm = raster_.col_mm * raster_.cols;
    Vec2 along = places_[geometry::round_index(i, k_about, places_.size())] -
                 places_[geometry::round_index(i, -k_about, places_.size())];
    along.x() -= turn_mm * std::round(along.x() / turn_mm);
    along.normalize();
    return {-along.y(), along.x()};
  }

  /// From the curve to one side, its own place left out.
  void walk(std::size_t i, const Vec2& left, int side, std::vector<OnSection>& section) const {
    constexpr int k_far_stations = 20;
    const int steps = static_cast<int>(config_.reach_mm / Raster::k_cell_mm);
    for (int k = 1; k <= steps; ++k) {
      const double off_mm = side * k * Raster::k_cell_mm;
      const Vec2 place = places_[i] + off_mm * left;
      const int row = static_cast<int>(std::lround(raster_.row_of(place.y())));
      if (row < 0 || row >= raster_.rows) return;
      const int col = static_cast<int>(std::lround(raster_.col_of(place.x())));
      const std::size_t cell = raster_.at(row, raster_.round_col(col));
      if (near_.elsewhere(cell, static_cast<int>(i), k_far_stations)) return;
      section.push_back({off_mm, place, weight_of(cell)});
    }
  }

  [[nodiscard]] double weight_of(std::size_t cell) const {
    constexpr double k_most = 100;  // less than that is nothing
    return std::exp(-std::min(static_cast<double>(excess_[cell]) / config_.temperature, k_most));
  }

  [[nodiscard]] CurveStation station(std::size_t i) const {
    std::vector<OnSection> section;
    const Vec2 left = left_at(i);
    walk(i, left, -1, section);
    std::ranges::reverse(section);
    section.push_back({0, places_[i], 1});
    walk(i, left, 1, section);
    double all = 0, same = 0;
    for (const OnSection& at : section) {
      all += at.weight;
      if (std::abs(at.off_mm) <= config_.same_mm) same += at.weight;
    }
    CurveStation station{.place = places_[i], .hold = same / all};
    add_alternatives(section, all, station);
    return station;
  }

  /// One for each stretch of the section between two places that are hardly likely.
  void add_alternatives(const std::vector<OnSection>& section, double all, CurveStation& station) const {
    CurveAlternative next{.place = Vec2::Zero(), .off_mm = 0, .mass = 0};
    double most = 0, before = 0;
    const auto close = [&] {
      if (next.mass >= config_.least_mass) station.alternatives.push_back(next);
      next.mass = 0;
      most = 0;
    };
    for (const OnSection& at : section) {
      const bool same = std::abs(at.off_mm) <= config_.same_mm;
      // A valley between two creases: half as likely as the crease before it, and rising again.
      if (same || (at.weight > before && before < most / 2)) close();
      before = at.weight;
      if (same) continue;
      next.mass += at.weight / all;
      if (at.weight <= most) continue;
      most = at.weight;
      next.place = at.place;
      next.off_mm = at.off_mm;
    }
    close();
    std::ranges::sort(station.alternatives, std::ranges::greater{}, &CurveAlternative::mass);
  }

  const Raster& raster_;
  const Large<float>& excess_;
  const PosteriorConfig& config_;
  std::vector<Vec2> places_;
  NearCurve near_;
};

}  // namespace

std::vector<CurveStation> curve_posterior(const Raster& raster, const ClosedCurve& curve,
                                          const Large<float>& excess, const PosteriorConfig& config) {
  return Sections{raster, curve, excess, config}.stations();
}

void add_rival(const Raster& raster, const ClosedCurve& rival, double more_than_best, Large<float>& excess) {
  for (const CurveState& state : rival.states) {
    float& least = excess[raster.at(state.row, raster.round_col(state.col))];
    least = std::min(least, static_cast<float>(more_than_best));
  }
}

}  // namespace biteline::bite_line
