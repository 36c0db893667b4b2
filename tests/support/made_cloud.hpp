// SPDX-License-Identifier: MIT
#pragma once
/// \file Clouds of made shoes whose line is exactly known.

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline::test {

struct MadeCloud {
  cloud::PointCloud cloud;
  std::vector<Vec3> truth;  ///< the line, base
};

/// A coarse scan keeps tests fast: the line's place depends little on it.
inline MadeCloud made_cloud(const sim::ShoeParameters& parameters, const SE3& T_base_shoe) {
  const sim::MadeShoe shoe{parameters};
  const sim::ScannedCloud scan =
      sim::scan_quickly(shoe, {.profile_step_mm = 1.3, .column_step_mm = 0.15}, T_base_shoe);
  MadeCloud made;
  made.cloud.points = scan.points;
  made.cloud.profile = scan.profile;
  for (const auto& point : sim::true_line(shoe, 0.5)) made.truth.push_back(T_base_shoe * point.point_shoe);
  return made;
}

inline MadeCloud made_cloud(sim::ShoeClass shoe_class, std::uint64_t seed, const SE3& T_base_shoe) {
  return made_cloud(sim::draw_shoe(shoe_class, seed), T_base_shoe);
}

/// As if somebody had pushed the shoe when so much of the scan was done.
inline cloud::PointCloud pushed(cloud::PointCloud cloud, double share, const Eigen::Vector3f& by_mm) {
  const double from = share * cloud.profile.back();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.profile[i] > from) cloud.points[i] += by_mm;
  return cloud;
}

/// Some place and yaw on the table.
inline SE3 somewhere() {
  SE3 T = SE3::Identity();
  T.linear() = Eigen::AngleAxisd(2.1, Vec3::UnitZ()).toRotationMatrix();
  T.translation() = Vec3{420, -130, 55};
  return T;
}

inline double mean_error_mm(const cloud::ClosedLine& line, const std::vector<Vec3>& truth) {
  double sum = 0;
  for (const cloud::LinePoint& point : line.points)
    sum += distance_mm(point.position, truth) / static_cast<double>(line.points.size());
  return sum;
}

}  // namespace biteline::test
