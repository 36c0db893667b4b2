// SPDX-License-Identifier: MIT
#pragma once
/// \file A made sample and the next upper of its model, scanned quickly: for tests of registration and
/// transfer.

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

inline cloud::PointCloud scanned(const sim::ShoeParameters& shoe, const SE3& T_base_shoe,
                                 const sim::ScanSettings& settings) {
  sim::ScannedCloud scan = sim::scan_quickly(sim::MadeShoe{shoe}, settings, T_base_shoe);
  cloud::PointCloud cloud;
  cloud.points = std::move(scan.points);
  cloud.profile = std::move(scan.profile);
  cloud.column = std::move(scan.column);
  return cloud;
}

inline cloud::ClosedLine as_line(const std::vector<sim::TrueLinePoint>& truth, const SE3& T_base_shoe) {
  cloud::ClosedLine line;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3 before = truth[(i + truth.size() - 1) % truth.size()].point_shoe,
               after = truth[(i + 1) % truth.size()].point_shoe;
    line.points.push_back({.position = T_base_shoe * truth[i].point_shoe,
                           .normal = T_base_shoe.linear() * truth[i].normal_shoe,
                           .tangent = T_base_shoe.linear() * (after - before).normalized(),
                           .confidence = 1});
  }
  return line;
}

/// Everything known about both.
struct MadePair {
  SE3 T_base_sample, T_base_upper;  ///< poses of the two shoes' frames
  cloud::PointCloud sample_cloud{}, upper_cloud{};
  cloud::ClosedLine sample_line{}, upper_line{};
};

struct PairSettings {
  sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
  std::uint64_t seed{1};
  double last_difference_mm{0.15};
  SE3 T_base_sample{
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{0.4, Vec3::UnitZ()}}, {370, -80, 60})};
  SE3 T_base_upper{
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{-2.2, Vec3::UnitZ()}}, {430, 90, 48})};
  sim::ScanSettings scan{};
};

inline MadePair made_pair(const PairSettings& settings) {
  const sim::ShoeParameters sample = sim::draw_shoe(settings.shoe_class, settings.seed);
  const sim::ShoeParameters upper =
      sim::bare_upper_of(sample, settings.last_difference_mm, settings.seed + 100);
  const std::vector<sim::TrueLinePoint> truth = sim::true_line(sim::MadeShoe{sample}, 1.0);
  sim::ScanSettings scan = settings.scan;
  scan.seed = settings.seed;
  MadePair pair{.T_base_sample = settings.T_base_sample, .T_base_upper = settings.T_base_upper};
  pair.sample_cloud = scanned(sample, settings.T_base_sample, scan);
  scan.seed = settings.seed + 1;
  pair.upper_cloud = scanned(upper, settings.T_base_upper, scan);
  pair.sample_line = as_line(truth, settings.T_base_sample);
  pair.upper_line = as_line(sim::carried_line(truth, sim::MadeShoe{upper}), settings.T_base_upper);
  return pair;
}

}  // namespace biteline::test
