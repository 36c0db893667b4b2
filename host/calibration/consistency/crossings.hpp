// SPDX-License-Identifier: MIT
#pragma once
/// \file Places of a rigid world that a scan saw from two directions: only these can contradict each other.

#include <optional>
#include <vector>

#include "host/calibration/drift/scan_view.hpp"
#include "host/cloud/uncertainty/head_uncertainty.hpp"

namespace biteline::consistency {

/// Two views of one direction move alike, whatever is wrong with the head: they see nothing of it.
inline constexpr double k_least_turn_rad = 8 * 0.017453292519943295;

/// What a head may be off by: columns of one standard deviation each.  As stated, or where nothing is stated
/// a fifth of a fault worth telling in each quantity: together some 0.07 mm at the shoe.
struct HeadSpread {
  uncertainty::HeadUncertainty axes;
  Eigen::Matrix<double, uncertainty::k_parameters, uncertainty::k_parameters> columns;
  double pose_sigma_mm{0}, pose_sigma_rad{0};
};
[[nodiscard]] HeadSpread spread_of(const geometry::SensorModel& head,
                                   const std::optional<uncertainty::HeadUncertainty>& stated);

using SpreadRow = Eigen::Matrix<double, 1, uncertainty::k_parameters>;

struct Crossing {
  double apart_mm{0};         ///< of the two views, along the surface's normal
  SpreadRow moves;            ///< d(apart_mm) / d(head's standard deviations)
  Eigen::RowVector2d per_px;  ///< d(apart_mm) / d(place of the picture: columns, rows)
  double pose_sigma_mm{0};    ///< of both poses, as stated
  std::uint32_t frame{0};     ///< of the view that was put against the other
  double time_s{0};
};

/// Some hundreds, spread evenly over what there is.  Cost: some tens of milliseconds of one core.
[[nodiscard]] std::vector<Crossing> crossings_of(const drift::ScanView& scan,
                                                 const geometry::SensorModel& head, const HeadSpread& spread);

}  // namespace biteline::consistency
