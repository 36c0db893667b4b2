// SPDX-License-Identifier: MIT
#pragma once
/// \file What a scan as a whole adds to the uncertainty of its places: head, poses, clock and arm.

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "host/cloud/uncertainty/arm_sway.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::uncertainty {

/// As far as it is known.
struct WholeScan {
  std::optional<ScanSpread> head{};  ///< calibration, poses and clock
  std::optional<ArmMotion> arm{};    ///< what the scan tells of its arm

  [[nodiscard]] bool known() const { return head || arm; }
  /// Of a place on the scanned surface, in base, mm^2; zero where nothing is known.
  [[nodiscard]] Mat3 covariance_mm2(const Vec3& point_base) const;
};

/// Along a closed line the covariance changes slowly, and is dear: it is worked out at every eighth point.
class SpreadAlong {
 public:
  /// `point`: 0 to `count` - 1, in base; called from several threads.
  SpreadAlong(const WholeScan& scan, std::size_t count, const std::function<Vec3(std::size_t)>& point);
  /// mm^2; zero where nothing is known.
  [[nodiscard]] Mat3 at(std::size_t point) const;

 private:
  std::size_t count_{0};
  std::vector<Mat3> nodes_;
};

/// Of a place's covariance, in the plane across a line with this tangent: outwards, then up; mm^2.
[[nodiscard]] Eigen::Matrix2d across(const Mat3& covariance_mm2, const Vec3& tangent, const Vec3& up);

}  // namespace biteline::uncertainty
