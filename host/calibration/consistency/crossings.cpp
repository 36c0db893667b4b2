// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/crossings.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "host/calibration/clock/overlap.hpp"
#include "host/calibration/drift/quantities.hpp"
#include "host/calibration/drift/seen_twice.hpp"

namespace biteline::consistency {
namespace {

using calibration::OverlapPair;

/// Of a fault worth telling: so far off may a head be of which nothing is stated.
constexpr double k_unstated = 0.2;
constexpr std::size_t k_most_crossings = 600;

class Motion {
 public:
  Motion(const geometry::SensorModel& head, const HeadSpread& spread, const drift::SeenTwice& seen)
      : head_{head}, spread_{spread}, seen_{seen} {}

  struct Moves {
    Eigen::Matrix<double, 3, uncertainty::k_parameters> spread;
    Eigen::Matrix<double, 3, 2> px;
    double pose_sigma_mm2;
  };
  [[nodiscard]] Moves of(std::size_t i) const {
    const calibration::ScanPoint& point = seen_.points[i];
    const Mat3& R = seen_.rotation[point.frame];
    const Vec2 pixel = head_.camera.project(point.point_cam);
    Eigen::Matrix<double, 3, uncertainty::k_parameters> J =
        R * uncertainty::point_jacobian(head_, spread_.axes, pixel);
    J.col(uncertainty::k_clock_at) = point.velocity_base_mm_s;
    const Mat3 to_base = R * head_.T_flange_cam.linear();
    const auto moved_by = [&](const Vec2& px) -> Vec3 {
      return to_base * (geometry::triangulate(head_.camera, head_.laser_plane, pixel + px) - point.point_cam);
    };
    const double lever_mm = (head_.T_flange_cam * point.point_cam).norm();
    return {.spread = J * spread_.columns,
            .px = (Eigen::Matrix<double, 3, 2>() << moved_by({1, 0}), moved_by({0, 1})).finished(),
            .pose_sigma_mm2 =
                std::pow(spread_.pose_sigma_mm, 2) + std::pow(spread_.pose_sigma_rad * lever_mm, 2)};
  }

 private:
  const geometry::SensorModel& head_;
  const HeadSpread& spread_;
  const drift::SeenTwice& seen_;
};

/// The other view's point that stands for it: its neighbours lie within some millimetres and move alike.
std::size_t other_of(const OverlapPair& pair) {
  const auto heaviest = std::max_element(pair.weights.begin(), pair.weights.end()) - pair.weights.begin();
  return pair.others[static_cast<std::size_t>(heaviest)];
}

}  // namespace

HeadSpread spread_of(const geometry::SensorModel& head,
                     const std::optional<uncertainty::HeadUncertainty>& stated) {
  HeadSpread spread{.axes = stated.value_or(drift::axes_of(head)), .columns = {}};
  if (!stated) {
    spread.columns.setZero();
    spread.columns.leftCols<drift::k_head_quantities>() =
        k_unstated * drift::parameters_per_quantity().leftCols<drift::k_head_quantities>();
    return spread;
  }
  spread.pose_sigma_mm = stated->pose_sigma_mm;
  spread.pose_sigma_rad = stated->pose_sigma_rad;
  const Eigen::SelfAdjointEigenSolver<uncertainty::Covariance> parts(stated->covariance);
  spread.columns = parts.eigenvectors() * parts.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  return spread;
}

std::vector<Crossing> crossings_of(const drift::ScanView& scan, const geometry::SensorModel& head,
                                   const HeadSpread& spread) {
  const drift::SeenTwice seen = drift::seen_twice(scan, head);
  if (seen.points.size() < 2) return {};
  std::vector<OverlapPair> pairs = calibration::find_overlaps(
      seen.times, seen.points, {.reach_mm = seen.reach_mm, .least_gap_s = drift::k_least_gap_s});
  const double most_trace = 1 + 2 * std::cos(k_least_turn_rad);
  std::erase_if(pairs, [&](const OverlapPair& pair) {
    const Mat3& R = seen.rotation[seen.points[pair.point].frame];
    const Mat3& other = seen.rotation[seen.points[other_of(pair)].frame];
    return !(R.cwiseProduct(other).sum() < most_trace);  // trace of R^T other
  });
  const Motion motion{head, spread, seen};
  const std::size_t step = pairs.size() / k_most_crossings + 1;
  std::vector<Crossing> found;
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    const OverlapPair& pair = pairs[i];
    const std::uint32_t frame = seen.points[pair.point].frame;
    const Motion::Moves here = motion.of(pair.point), there = motion.of(other_of(pair));
    Crossing crossing{.apart_mm = pair.distance_mm,
                      .moves = pair.normal.transpose() * (here.spread - there.spread),
                      .per_px = pair.normal.transpose() * (here.px - there.px),
                      .pose_sigma_mm = std::sqrt(here.pose_sigma_mm2 + there.pose_sigma_mm2),
                      .frame = frame,
                      .time_s = scan.poses[frame].pose.time_s};
    if (std::isfinite(crossing.apart_mm) && crossing.moves.allFinite() && crossing.per_px.allFinite())
      found.push_back(crossing);
  }
  return found;
}

}  // namespace biteline::consistency
