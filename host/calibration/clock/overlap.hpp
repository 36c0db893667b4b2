// SPDX-License-Identifier: MIT
#pragma once
/// \file Places of a surface that a scan saw more than once, and how far apart it saw them.

#include <vector>

#include "host/calibration/clock/scan.hpp"

namespace biteline::calibration {

/// What turns a scan's pixels into points in base.
struct ScanModel {
  geometry::Camera camera;
  geometry::LaserPlane plane;
  SE3 T_flange_cam{SE3::Identity()};
  Nanoseconds pose_clock_offset{0};
};

/// A point with what is needed to move it.
struct ScanPoint {
  Vec3 point_base{Vec3::Zero()};
  Vec3 point_cam{Vec3::Zero()};
  Vec3 velocity_base_mm_s{
      Vec3::Zero()};  ///< of the head's frame at the point: d(point_base) / d(pose clock offset)
  std::uint32_t frame{0};
  std::uint32_t pixel{0};  ///< index in the frame's stripe
};

/// One point against the surface of another pass: a quadratic through its neighbours there, since over a few
/// millimetres a shoe bends by more than the stripe's noise.  distance = normal . (point - sum of weight *
/// other).
struct OverlapPair {
  std::size_t point{0};
  std::vector<std::size_t> others;  ///< points of the other pass
  std::vector<double> weights;      ///< theirs in the surface's place below the point; they sum up to 1
  Vec3 normal{Vec3::UnitZ()};
  double distance_mm{0};
};

/// Points in base at the poses of their instants; those without a fresh pose are left out.
[[nodiscard]] std::vector<ScanPoint> place_points(const Scan& scan, const ScanModel& model);

struct OverlapSearch {
  double reach_mm{2.0};      ///< neighbours of the other pass within it
  double least_gap_s{0.05};  ///< passes are this far apart in time
};

/// Pairs between passes.
[[nodiscard]] std::vector<OverlapPair> find_overlaps(const Scan& scan, const std::vector<ScanPoint>& points,
                                                     const OverlapSearch& search);

}  // namespace biteline::calibration
