// SPDX-License-Identifier: MIT
#include "host/calibration/clock/clock_offset.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "host/geometry/robust.hpp"

namespace biteline::calibration {

namespace {

constexpr std::size_t k_least_pairs = 200;
/// Beyond, the answer is no use: 0.5 ms at 110 mm/s is 0.05 mm.
constexpr double k_most_sigma_s = 0.5e-3;

Vec3 other_velocity(const std::vector<ScanPoint>& points, const OverlapPair& pair) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < pair.others.size(); ++i)
    sum += pair.weights[i] * points[pair.others[i]].velocity_base_mm_s;
  return sum;
}

double median_abs(const std::vector<OverlapPair>& pairs) {
  std::vector<double> values;
  for (const OverlapPair& pair : pairs) values.push_back(std::abs(pair.distance_mm));
  return geometry::median_of(std::move(values));
}

/// Share of the passes' disagreement that is the same all over a pass: a mounting off by hundredths of a
/// millimetre, stripes read differently under another angle.  It does not average out; measured on scans that
/// hardly determine the offset.
constexpr double k_common_share = 0.3;

struct Step {
  double step_s{0};
  double sigma_s{0};         ///< by the scatter
  double common_sigma_s{0};  ///< by what a pass has in common
  double rms_mm{0};
  std::size_t pairs{0};
};

/// One Gauss-Newton step with Tukey's weights.
std::optional<Step> one_step(const std::vector<ScanPoint>& points, const std::vector<OverlapPair>& pairs) {
  if (pairs.size() < k_least_pairs) return std::nullopt;
  const double limit_mm = std::max(0.02, 4.685 * geometry::k_sigma_per_mad * median_abs(pairs));
  double information = 0, gradient = 0, square_sum = 0, weight_sum = 0;
  struct Term {
    std::uint32_t frame;
    double J, weight, residual;
  };
  std::vector<Term> terms;
  for (const OverlapPair& pair : pairs) {
    const double ratio = pair.distance_mm / limit_mm;
    if (std::abs(ratio) >= 1) continue;
    const double weight = std::pow(1 - ratio * ratio, 2);
    const double J = pair.normal.dot(points[pair.point].velocity_base_mm_s - other_velocity(points, pair));
    information += weight * J * J;
    gradient += weight * J * pair.distance_mm;
    square_sum += weight * pair.distance_mm * pair.distance_mm;
    weight_sum += weight;
    terms.push_back({points[pair.point].frame, J, weight, pair.distance_mm});
  }
  if (!(information > 0)) return std::nullopt;
  Step step{.step_s = -gradient / information,
            .sigma_s = 0,
            .common_sigma_s = 0,
            .rms_mm = std::sqrt(square_sum / weight_sum),
            .pairs = terms.size()};
  // Cluster-robust variance (White 1980; clusters are blocks of frames, which share pose errors and
  // neighbours).
  constexpr std::uint32_t k_block_frames = 8;
  std::map<std::uint32_t, double> clusters;
  for (const Term& t : terms)
    clusters[t.frame / k_block_frames] += t.weight * t.J * (t.residual + t.J * step.step_s);
  double scatter = 0;
  for (const auto& [block, sum] : clusters) scatter += sum * sum;
  const double count = static_cast<double>(clusters.size());
  // Each pair is there from both its sides: half as many are independent.
  step.sigma_s = count > 1 ? std::sqrt(2 * scatter * count / (count - 1)) / information : 1.0;
  // What a pass has in common holds over one place; a pair touches two, and separate places are independent.
  constexpr std::uint32_t k_place_frames = 20;
  std::set<std::uint32_t> places;
  for (const Term& t : terms) places.insert(t.frame / k_place_frames);
  const double pairs_of_places = std::max(1.0, 0.5 * static_cast<double>(places.size()));
  step.common_sigma_s =
      k_common_share * step.rms_mm / std::sqrt(information / weight_sum) / std::sqrt(pairs_of_places);
  return step;
}

ScanModel at(ScanModel model, double offset_s) {
  model.pose_clock_offset = Nanoseconds{std::llround(offset_s * 1e9)};
  return model;
}

/// A fifth of the points, far reach: where to start.
double coarse_offset_s(const Scan& scan, const ScanModel& model, double search_ms) {
  Scan thin = scan;
  for (ScanFrame& frame : thin.frames) {
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < frame.stripe_px.size(); i += 3) kept.push_back(frame.stripe_px[i]);
    frame.stripe_px = std::move(kept);
  }
  double best_s = 0, best_cost = 1e300;
  for (double ms = -search_ms; ms <= search_ms; ms += 2) {
    const std::vector<ScanPoint> points = place_points(thin, at(model, ms * 1e-3));
    const std::vector<OverlapPair> pairs = find_overlaps(thin, points, {.reach_mm = 4, .least_gap_s = 0.05});
    if (pairs.size() < k_least_pairs / 3) continue;
    // Mean of a bounded loss: pairs that are no pairs must not decide.
    double cost = 0;
    for (const OverlapPair& pair : pairs) cost += std::min(std::abs(pair.distance_mm), 1.0);
    cost /= static_cast<double>(pairs.size());
    if (cost >= best_cost) continue;
    best_cost = cost;
    best_s = ms * 1e-3;
  }
  return best_s;
}

}  // namespace

Result<ClockOffset> find_clock_offset(const Scan& scan, const ScanModel& model, double search_ms) {
  ClockOffset result;
  double offset_s = search_ms > 0 ? coarse_offset_s(scan, model, search_ms)
                                  : std::chrono::duration<double>(model.pose_clock_offset).count();
  std::optional<Step> step;
  for (result.iterations = 0; result.iterations < 15; ++result.iterations) {
    const std::vector<ScanPoint> points = place_points(scan, at(model, offset_s));
    step = one_step(points, find_overlaps(scan, points, {}));
    if (!step) {
      return fail(Errc::Degenerate,
                  "clock: hardly any surface is seen twice: let the arm come back over the same place with "
                  "another motion");
    }
    offset_s += std::clamp(step->step_s, -2e-3, 2e-3);
    if (std::abs(step->step_s) < 1e-7) break;
  }
  // What the neighbourhood's size changes is no noise, but no truth either.
  const std::vector<ScanPoint> settled = place_points(scan, at(model, offset_s));
  constexpr OverlapSearch k_closer{.reach_mm = 1.5, .least_gap_s = 0.05};
  const std::optional<Step> closer = one_step(settled, find_overlaps(scan, settled, k_closer));
  const double scatter_sigma_s = step->sigma_s;
  step->sigma_s = std::hypot(scatter_sigma_s, step->common_sigma_s, closer ? closer->step_s : 0.0);
  if (step->sigma_s > k_most_sigma_s) {
    char words[160];
    std::snprintf(
        words, sizeof words,
        "clock: the scan leaves the offset uncertain by %.2f ms: the same surface must be seen under "
        "different velocities",
        1e3 * step->sigma_s);
    result.reason = words;
  } else if (std::abs(step->step_s) > scatter_sigma_s) {
    return fail(Errc::NotConverged, "clock: the search for the offset did not settle (%.3f ms left)",
                1e3 * step->step_s);
  }
  const std::vector<ScanPoint> before = place_points(scan, at(model, 0));
  if (const auto first = one_step(before, find_overlaps(scan, before, {})))
    result.rms_before_mm = first->rms_mm;
  result.offset = Nanoseconds{std::llround(offset_s * 1e9)};
  result.sigma = Nanoseconds{std::llround(step->sigma_s * 1e9)};
  result.rms_mm = step->rms_mm;
  result.pairs = step->pairs;
  return result;
}

}  // namespace biteline::calibration
