// SPDX-License-Identifier: MIT
#include "host/bite_line/place/point_spread.hpp"

#include <algorithm>
#include <cmath>

#include "host/bite_line/place/confidence.hpp"

namespace biteline::bite_line {

namespace {

double square(double value) {
  return value * value;
}

}  // namespace

double within_of(const PlacedStation& station) {
  double held = station.doubt > 0
                    ? bridge_held_of({.corner_mm = station.corner_mm,
                                      .tried_mm = std::hypot(station.tried_out_mm, station.tried_up_mm)})
                    : jump_held_of(station.own_z_mm - station.position.z());
  // That none could be tried is no sign of a good bridge: then its length and turn alone tell.
  if (station.untried) held = std::min(held, 1 / (1 + station.doubt));
  return flat_held_of(station.sharp) * held;
}

PointSpread spread_of(const PlacedStation& station, const SpreadModel& model) {
  // A wrong height slides the point along the wall.
  const Eigen::Vector2d wall{station.noise.slope, 1};
  const double height_mm2 = square(model.scatter * station.scatter_mm);
  // Places that are guessed are off in any direction.
  const double flat = 1 / std::max(station.sharp, 1e-3) - 1;
  const double anywhere_mm2 = square(model.outward * station.noise.outward_mm) +
                              (station.doubt > 0 ? square(model.any_gap_mm) : 0.0) +
                              square(model.gap_mm * station.doubt) +
                              square(model.corner * station.corner_mm) + square(model.flat_mm * flat);
  const Eigen::Vector2d between_mm2{square(station.between_out_mm), square(station.between_up_mm)};
  const Eigen::Vector2d tried_mm2{square(station.tried_out_mm),
                                  square(station.tried_up_mm) + square(station.hidden_up_mm)};
  Eigen::Matrix2d covariance_mm2 =
      height_mm2 * wall * wall.transpose() + anywhere_mm2 * Eigen::Matrix2d::Identity();
  covariance_mm2 += (between_mm2 + tried_mm2).asDiagonal();
  covariance_mm2(0, 0) += square(model.few * station.few_out_mm) + square(station.noise.round_mm) +
                          square(station.noise.filled_mm);
  return {.covariance_mm2 = covariance_mm2,
          .hold = station.hold,
          .within = within_of(station),
          .other_mm = station.other_mm};
}

PointSpread between(const PointSpread& a, const PointSpread& b, double fraction) {
  return {.covariance_mm2 = (1 - fraction) * a.covariance_mm2 + fraction * b.covariance_mm2,
          .hold = (1 - fraction) * a.hold + fraction * b.hold,
          .within = (1 - fraction) * a.within + fraction * b.within,
          .other_mm = std::max(a.other_mm, b.other_mm)};
}

}  // namespace biteline::bite_line
