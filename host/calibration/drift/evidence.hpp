// SPDX-License-Identifier: MIT
#pragma once
/// \file What one scan says about its own calibration: places that it saw twice do not agree under a wrong
/// one.

#include <cstdint>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "host/calibration/drift/quantities.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::drift {

/// Where the arm was when a profile was taken.
struct PosedProfile {
  std::uint32_t profile{0};  ///< its sequence number
  uncertainty::ProfilePose pose{};
};

/// A finished scan; borrowed.
struct ScanView {
  std::span<const Eigen::Vector3f> points_base;  ///< in scan order
  std::span<const std::uint32_t> profile;        ///< of each point
  std::span<const PosedProfile> poses;           ///< in the order of their numbers
};

/// Normal equations in the quantities: information * x = pull, x what the head has drifted by.  Sums of scans
/// are sums of both.
struct Evidence {
  Matrix information{Matrix::Zero()};
  Vector pull{Vector::Zero()};
  double before_mm{0};  ///< how far the two views of a place lie apart, root mean square
  double after_mm{0};   ///< the same, if the head had drifted as it looks
  std::size_t pairs{0};
  std::size_t profiles{0};  ///< that saw a place again

  /// Each quantity as if it alone had drifted, and its standard deviation; where a scan says nothing 0 and
  /// infinity.
  [[nodiscard]] Vector alone() const;
  [[nodiscard]] Vector alone_sigma() const;
};

/// Cost: some 0.1 s of one core.  Errc::Degenerate where hardly any surface is seen twice.
[[nodiscard]] Result<Evidence> look_at(const ScanView& scan, const geometry::SensorModel& head);

}  // namespace biteline::drift
