// SPDX-License-Identifier: MIT
#include "host/calibration/refine/scan_refinement.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "host/geometry/robust.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

constexpr std::size_t k_least_pairs = 200;
constexpr int k_rounds = 8;

ScanModel changed(const ScanModel& model, const RefineVector& x, const Eigen::Matrix<double, 3, 2>& axes,
                  const Vec3& middle_cam) {
  ScanModel next = model;
  const Vec3 normal = (model.plane.normal_cam + axes * x.head<2>()).normalized();
  // Turned about the points' middle: about the origin a turn would also be a shift of a quarter metre's
  // lever.
  const Vec3 on_plane = middle_cam - model.plane.signed_distance_mm(middle_cam) * model.plane.normal_cam;
  next.plane = {.normal_cam = normal, .distance_mm = normal.dot(on_plane) + x[2]};
  next.T_flange_cam = geometry::orthonormalised(model.T_flange_cam * geometry::exp_se3(x.segment<6>(3)));
  next.pose_clock_offset += Nanoseconds{std::llround(x[9] * 1e9)};
  return next;
}

struct System {
  RefineMatrix information{RefineMatrix::Zero()};
  RefineVector gradient{RefineVector::Zero()};
  double rms_mm{0};
  std::size_t pairs{0};
};

double limit_of(const std::vector<OverlapPair>& pairs) {
  std::vector<double> values;
  for (const OverlapPair& pair : pairs) values.push_back(std::abs(pair.distance_mm));
  return std::max(0.02, 4.685 * geometry::k_sigma_per_mad * geometry::median_of(std::move(values)));
}

/// Distances' derivatives by moving the whole scan a little in each direction.
std::optional<System> linearise(const Scan& scan, const ScanModel& model,
                                const Eigen::Matrix<double, 3, 2>& axes, const Vec3& middle_cam) {
  const std::vector<ScanPoint> points = place_points(scan, model);
  const std::vector<OverlapPair> pairs = find_overlaps(scan, points, {});
  if (pairs.size() < k_least_pairs) return std::nullopt;
  Eigen::Matrix<double, Eigen::Dynamic, k_refined> J(static_cast<Eigen::Index>(pairs.size()), k_refined);
  for (int k = 0; k < k_refined; ++k) {
    RefineVector step = RefineVector::Zero();
    step[k] = k == 9 ? 1e-5 : (k == 2 || (k >= 3 && k < 6) ? 1e-2 : 1e-5);  // s, mm, rad
    const std::vector<ScanPoint> moved = place_points(scan, changed(model, step, axes, middle_cam));
    if (moved.size() != points.size()) return std::nullopt;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const OverlapPair& pair = pairs[i];
      Vec3 other = Vec3::Zero();
      for (std::size_t o = 0; o < pair.others.size(); ++o) {
        other += pair.weights[o] * (moved[pair.others[o]].point_base - points[pair.others[o]].point_base);
      }
      const Vec3 own = moved[pair.point].point_base - points[pair.point].point_base;
      J(static_cast<Eigen::Index>(i), k) = pair.normal.dot(own - other) / step[k];
    }
  }
  System system;
  const double limit_mm = limit_of(pairs);
  std::set<std::uint32_t> frames;
  double square_sum = 0, weight_sum = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double ratio = pairs[i].distance_mm / limit_mm;
    if (std::abs(ratio) >= 1) continue;
    const double weight = std::pow(1 - ratio * ratio, 2);
    const auto row = J.row(static_cast<Eigen::Index>(i));
    system.information += weight * row.transpose() * row;
    system.gradient += weight * row.transpose() * pairs[i].distance_mm;
    square_sum += weight * pairs[i].distance_mm * pairs[i].distance_mm;
    weight_sum += weight;
    frames.insert(points[pairs[i].point].frame);
    ++system.pairs;
  }
  if (system.pairs < k_least_pairs || frames.empty()) return std::nullopt;
  system.rms_mm = std::sqrt(square_sum / weight_sum);
  // Errors of one frame go together: a frame counts as one observation of their common size, not as hundreds.
  const double per_frame = static_cast<double>(system.pairs) / static_cast<double>(frames.size());
  const double variance_mm2 = system.rms_mm * system.rms_mm * per_frame;
  system.information /= variance_mm2;
  system.gradient /= variance_mm2;
  return system;
}

Vec3 middle_of(const Scan& scan, const ScanModel& model) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const ScanPoint& p : place_points(scan, model)) {
    sum += p.point_cam;
    count += 1;
  }
  return count > 0 ? Vec3(sum / count) : Vec3::UnitZ();
}

}  // namespace

Result<ScanRefinement> refine_from_scan(const Scan& scan, const ScanModel& start, const RefineMatrix& prior,
                                        const Eigen::Matrix<double, 3, 2>& plane_axes) {
  const auto nothing_seen_twice = [] {
    return fail(Errc::Degenerate,
                "refine: hardly any surface is seen twice: let the arm come back over the same place from "
                "another direction");
  };
  const RefineMatrix prior_information = geometry::SymmetricSolver{prior}.inverse();
  const Vec3 middle_cam = middle_of(scan, start);
  ScanRefinement result{.model = start,
                        .change = RefineVector::Zero(),
                        .sigma = RefineVector::Zero(),
                        .rms_before_mm = 0,
                        .rms_after_mm = 0,
                        .pairs = 0};
  for (int round = 0; round < k_rounds; ++round) {
    const std::optional<System> system = linearise(scan, result.model, plane_axes, middle_cam);
    if (!system) return nothing_seen_twice();
    if (round == 0) result.rms_before_mm = system->rms_mm;
    const geometry::SymmetricSolver solver{system->information + prior_information};
    const RefineVector step = -solver.solve(system->gradient + prior_information * result.change);
    result.sigma = solver.inverse().diagonal().cwiseMax(0).cwiseSqrt();
    result.pairs = system->pairs;
    result.rms_after_mm = system->rms_mm;
    if (step.cwiseQuotient(result.sigma).cwiseAbs().maxCoeff() < 0.01) break;
    result.change += step;
    result.model = changed(start, result.change, plane_axes, middle_cam);
  }
  // The last word is none where the passes agree no better for it.
  if (result.rms_after_mm > result.rms_before_mm) {
    result.model = start;
    result.change.setZero();
    result.rms_after_mm = result.rms_before_mm;
  }
  return result;
}

}  // namespace biteline::calibration
