// SPDX-License-Identifier: MIT
#pragma once
/// \file How a shoe moved in plan, by how far its wall came out at some places.  Places count from the seam.

#include <Eigen/Cholesky>

#include "common/geometry/se3.hpp"

namespace biteline::bite_line {

/// A shift, and a turn about the seam.
struct PlanMotion {
  Vec2 shift_mm{Vec2::Zero()};
  double turn_rad{0};

  [[nodiscard]] Vec2 of(const Vec2& place_mm) const {
    return shift_mm + turn_rad * Vec2{-place_mm.y(), place_mm.x()};
  }
};

/// The likeliest motion that explains steps of the wall: Gaussian noise, and a prior that keeps at rest what
/// the steps do not tell.  The turn counts in mm at `reach_mm` from the seam.
class PlanMotionFit {
 public:
  explicit PlanMotionFit(double reach_mm) : reach_mm_{reach_mm} {}

  void add(const Vec2& place_mm, const Vec2& normal, double step_mm) {
    const Vec3 row{normal.x(), normal.y(),
                   (normal.y() * place_mm.x() - normal.x() * place_mm.y()) / reach_mm_};
    information_ += row * row.transpose();
    pull_ += step_mm * row;
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] PlanMotion likeliest() const {
    // Sound scans' steps, on soft arms; a shoe at rest in its holder.
    constexpr double k_step_sigma_mm = 0.05, k_rest_sigma_mm = 0.3;
    constexpr double k_held = (k_step_sigma_mm / k_rest_sigma_mm) * (k_step_sigma_mm / k_rest_sigma_mm);
    const Vec3 x = (information_ + k_held * Mat3::Identity()).ldlt().solve(pull_);
    return {.shift_mm = x.head<2>(), .turn_rad = x.z() / reach_mm_};
  }

 private:
  double reach_mm_;
  Mat3 information_{Mat3::Zero()};
  Vec3 pull_{Vec3::Zero()};
  int count_{0};
};

}  // namespace biteline::bite_line
