// SPDX-License-Identifier: MIT
#include "host/calibration/drift/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "host/calibration/clock/overlap.hpp"
#include "host/calibration/drift/motion.hpp"
#include "host/calibration/drift/seen_twice.hpp"
#include "host/geometry/robust.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::drift {
namespace {

using calibration::OverlapPair;
using Row = Eigen::Matrix<double, 1, k_quantities>;

constexpr std::size_t k_least_pairs = 200;
/// A quantity is held to about so many fault sizes where a scan does not say more.
constexpr double k_wide = 3;

struct Equation {
  Row row;
  double distance_mm{0};
  std::uint32_t frame{0};
};

std::vector<Equation> equations(const SeenTwice& seen, const std::vector<OverlapPair>& pairs,
                                const geometry::SensorModel& head) {
  const Motion motion{head};
  const auto moves = [&](std::size_t i) {
    const calibration::ScanPoint& point = seen.points[i];
    return motion.of({.point_cam = point.point_cam,
                      .velocity_base_mm_s = point.velocity_base_mm_s,
                      .R_base_flange = seen.rotation[point.frame]});
  };
  constexpr std::size_t k_most = 3000;
  const std::size_t step = std::max<std::size_t>(1, pairs.size() / k_most);
  std::vector<Equation> rows;
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    const OverlapPair& pair = pairs[i];
    // The others lie within some millimetres and move alike: the heaviest stands for them.
    const auto heaviest = std::max_element(pair.weights.begin(), pair.weights.end()) - pair.weights.begin();
    const std::size_t other = pair.others[static_cast<std::size_t>(heaviest)];
    const Row row = pair.normal.transpose() * (moves(pair.point) - moves(other));
    if (row.allFinite() && std::isfinite(pair.distance_mm))
      rows.push_back({.row = row, .distance_mm = pair.distance_mm, .frame = seen.points[pair.point].frame});
  }
  return rows;
}

double limit_mm(const std::vector<Equation>& rows, const Vector& x) {
  std::vector<double> off;
  for (const Equation& e : rows) off.push_back(std::abs(e.distance_mm + e.row * x));
  return std::max(0.02, 4.685 * geometry::k_sigma_per_mad * geometry::median_of(std::move(off)));
}

struct FitSums {
  Matrix information{Matrix::Zero()};
  Vector pull{Vector::Zero()};
  double before{0}, after{0}, weight{0};
  std::set<std::uint32_t> frames{};
};

FitSums sums_of(const std::vector<Equation>& rows, const Vector& x) {
  FitSums sums;
  const double limit = limit_mm(rows, x);
  for (const Equation& e : rows) {
    const double left = e.distance_mm + e.row * x;
    const double ratio = left / limit;
    if (std::abs(ratio) >= 1) continue;
    const double weight = std::pow(1 - ratio * ratio, 2);
    sums.information += weight * e.row.transpose() * e.row;
    sums.pull -= weight * e.row.transpose() * e.distance_mm;
    sums.before += weight * e.distance_mm * e.distance_mm;
    sums.after += weight * left * left;
    sums.weight += weight;
    sums.frames.insert(e.frame);
  }
  return sums;
}

/// Of the places seen twice.
Result<Evidence> look_at_seam(const ScanView& scan, const geometry::SensorModel& head) {
  const SeenTwice seen = seen_twice(scan, head);
  std::vector<OverlapPair> pairs;
  if (seen.points.size() >= k_least_pairs)
    pairs = calibration::find_overlaps(seen.times, seen.points,
                                       {.reach_mm = seen.reach_mm, .least_gap_s = k_least_gap_s});
  const std::vector<Equation> rows = equations(seen, pairs, head);
  if (rows.size() < k_least_pairs) {
    return fail(
        Errc::Degenerate,
        "calibration check: hardly any surface is seen twice (%zu places): let the scan end some 60 mm "
        "behind its begin, from another direction, or show the table all the way round",
        rows.size());
  }
  // Twice: the second time what a drift explains is no outlier.
  constexpr double k_start_sigma_mm = 0.02;
  Vector x = Vector::Zero();
  FitSums sums;
  double variance_mm2 = k_start_sigma_mm * k_start_sigma_mm;
  for (int round = 0; round < 3; ++round) {
    sums = sums_of(rows, x);
    if (!(sums.weight > 0)) return fail(Errc::Degenerate, "calibration check: no two views agree");
    // Errors of one profile go together: it counts as one observation, not as hundreds.
    const double per_profile = static_cast<double>(rows.size()) / static_cast<double>(sums.frames.size());
    if (round > 0) variance_mm2 = sums.after / sums.weight;
    const double scale = 1 / (variance_mm2 * per_profile);
    sums.information *= scale;
    sums.pull *= scale;
    const Matrix held = sums.information + Matrix::Identity() / (k_wide * k_wide);
    x = geometry::solve_symmetric(held, sums.pull);
  }
  if (!sums.information.allFinite() || !sums.pull.allFinite())
    return fail(Errc::Degenerate, "calibration check: the scan's places are no numbers");
  Evidence evidence{.seam = {.information = sums.information, .pull = sums.pull},
                    .before_mm = std::sqrt(sums.before / sums.weight),
                    .after_mm = std::sqrt(sums.after / sums.weight),
                    .pairs = rows.size(),
                    .profiles = sums.frames.size(),
                    .table = {}};
  return evidence;
}

}  // namespace

Sums Evidence::sums(const std::optional<TablePlane>& usual) const {
  Sums sums = seam;
  if (!table || (usual && table->is_another(*usual))) return sums;
  const TableEvidence counted = usual ? table->counted_from(*usual) : *table;
  sums.add(counted.information, counted.pull);
  return sums;
}

Result<Evidence> look_at(const ScanView& scan, const geometry::SensorModel& head) {
  std::optional<TableEvidence> table = see_table(scan, head);
  Result<Evidence> evidence = look_at_seam(scan, head);
  if (!evidence && !table) return evidence;
  if (!evidence) evidence = Evidence{};
  evidence->table = std::move(table);
  return evidence;
}

}  // namespace biteline::drift
