// SPDX-License-Identifier: MIT
#pragma once
/// \file How a scanned place moves with the head's quantities.

#include "host/calibration/drift/quantities.hpp"

namespace biteline::drift {

/// A place as the head saw it.
struct Sight {
  Vec3 point_cam{Vec3::Zero()};
  Vec3 velocity_base_mm_s{Vec3::Zero()};  ///< of the flange's frame there
  Mat3 R_base_flange{Mat3::Identity()};
};

/// Thread: const, any.
class Motion {
 public:
  explicit Motion(const geometry::SensorModel& head)
      : head_{head}, axes_{axes_of(head)}, map_{parameters_per_quantity()} {}

  /// d(place in base, mm) / d(quantities); zero in the table's.
  [[nodiscard]] Eigen::Matrix<double, 3, k_quantities> of(const Sight& sight) const {
    Eigen::Matrix<double, 3, uncertainty::k_parameters> J =
        sight.R_base_flange *
        uncertainty::point_jacobian(head_, axes_, head_.camera.project(sight.point_cam));
    J.col(uncertainty::k_clock_at) = sight.velocity_base_mm_s;
    return J * map_;
  }

 private:
  geometry::SensorModel head_;
  uncertainty::HeadUncertainty axes_;
  Eigen::Matrix<double, uncertainty::k_parameters, k_quantities> map_;
};

}  // namespace biteline::drift
