// SPDX-License-Identifier: MIT
#include "host/calibration/handeye/consensus.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "host/calibration/handeye/motions.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

/// An industrial arm and a calibrated camera agree to some 0.05 degrees; hobby cameras on small targets to 1.
constexpr double k_agree_rad = 1.5 * std::numbers::pi / 180;
/// Axis lengths of one motion seen twice; looser, since it only saves work.
constexpr double k_same_turn_rad = 2 * k_agree_rad;
constexpr double k_least_turn_rad = 4 * std::numbers::pi / 180;

double turn_rad(const Mat3& R_a, const Mat3& R_b) {
  return geometry::angle_between_rad(R_a, R_b);
}

/// Each stop's best reading under one hypothesis, where it agrees.
Consensus agreeing(std::span<const StopReadings> stops, const Mat3& R_flange_cam, const Mat3& R_base_target) {
  Consensus result;
  result.R_flange_cam = R_flange_cam;
  double sum = 0;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const Mat3 expected = (stops[i].T_base_flange.linear() * R_flange_cam).transpose() * R_base_target;
    std::size_t best = 0;
    double best_rad = 1e9;
    for (std::size_t k = 0; k < stops[i].T_cam_target.size(); ++k) {
      const double rad = turn_rad(expected, stops[i].T_cam_target[k].linear());
      if (rad >= best_rad) continue;
      best_rad = rad;
      best = k;
    }
    if (best_rad > k_agree_rad) continue;
    result.stops.push_back(i);
    result.readings.push_back(best);
    sum += best_rad * best_rad;
  }
  result.rms_rad = result.stops.empty() ? 0 : std::sqrt(sum / static_cast<double>(result.stops.size()));
  return result;
}

bool better(const Consensus& a, const Consensus& b) {
  return a.stops.size() != b.stops.size() ? a.stops.size() > b.stops.size() : a.rms_rad < b.rms_rad;
}

/// The rotation again from all that agree, until the set no longer changes.
Consensus settled(std::span<const StopReadings> stops, Consensus consensus) {
  for (int round = 0; round < 5 && consensus.stops.size() >= 3; ++round) {
    std::vector<Stop> used;
    for (std::size_t i = 0; i < consensus.stops.size(); ++i) {
      const StopReadings& stop = stops[consensus.stops[i]];
      used.push_back(
          {.T_base_flange = stop.T_base_flange, .T_cam_target = stop.T_cam_target[consensus.readings[i]]});
    }
    const std::optional<Mat3> R_flange_cam = rotation_of_x(used);
    if (!R_flange_cam) break;
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();  // mean of the target's rotation in base: Markley 2007
    for (const Stop& stop : used) {
      const Eigen::Vector4d q =
          Eigen::Quaterniond(Mat3(stop.T_base_flange.linear() * *R_flange_cam * stop.T_cam_target.linear()))
              .coeffs();
      sum += q * q.transpose();
    }
    const Eigen::Vector4d q = geometry::principal_axes(sum).vectors.col(3);
    Consensus next = agreeing(stops, *R_flange_cam, Eigen::Quaterniond(q).normalized().toRotationMatrix());
    if (!better(next, consensus)) break;
    consensus = std::move(next);
  }
  return consensus;
}

std::vector<StopReadings> changed(std::span<const StopReadings> stops, auto change) {
  std::vector<StopReadings> result(stops.begin(), stops.end());
  for (StopReadings& stop : result) change(stop);
  return result;
}

/// 0: these stops do not agree; else higher, the better.  Rotations alone cannot tell an inverted pose from a
/// quaternion in another order (both are q -> a conj(q) b), translations can.
double agreement(std::span<const StopReadings> stops, std::size_t enough) {
  const Consensus consensus = rotation_consensus(stops);
  if (consensus.stops.size() < enough) return 0;
  std::vector<Stop> used;
  double square_sum = 0, count = 0;
  for (std::size_t i = 0; i < consensus.stops.size(); ++i) {
    const StopReadings& stop = stops[consensus.stops[i]];
    used.push_back(
        {.T_base_flange = stop.T_base_flange, .T_cam_target = stop.T_cam_target[consensus.readings[i]]});
    square_sum +=
        (used.back().T_cam_target.translation() - used.front().T_cam_target.translation()).squaredNorm();
    count += 1;
  }
  const std::optional<TranslationFit> fit = translation_of_x(used, consensus.R_flange_cam);
  const double motion_mm = std::sqrt(square_sum / count);
  constexpr double k_most_miss_ratio =
      0.1;  // of the target's motion; the wrong hypothesis misses by all of it
  if (!fit || fit->rms_mm > k_most_miss_ratio * motion_mm) return 0;
  return 1 / (1e-6 + fit->rms_mm / std::max(1e-9, motion_mm));
}

/// A stop with one reading for each way that the target may be turned, and where those stand.  Readings that
/// are shifted by whole pitches turn alike: of a large grid that is half seen there are hundreds, and the
/// work below grows with the third power of their number.
struct TurnedStop {
  StopReadings stop;
  std::vector<std::size_t> readings;
};
TurnedStop turned(const StopReadings& all) {
  constexpr double k_alike_rad = 1e-6;
  TurnedStop one{.stop = {.T_base_flange = all.T_base_flange, .T_cam_target = {}}, .readings = {}};
  for (std::size_t k = 0; k < all.T_cam_target.size(); ++k) {
    const bool known = std::ranges::any_of(one.stop.T_cam_target, [&](const SE3& T) {
      return turn_rad(T.linear(), all.T_cam_target[k].linear()) < k_alike_rad;
    });
    if (known) continue;
    one.stop.T_cam_target.push_back(all.T_cam_target[k]);
    one.readings.push_back(k);
  }
  return one;
}

Consensus consensus_of_turned(std::span<const StopReadings> stops) {
  Consensus best;
  const std::size_t n = stops.size();
  if (n < 3) return best;
  std::mt19937_64 random{1};
  std::uniform_int_distribution<std::size_t> any(0, n - 1);
  constexpr int k_draws = 600;  // with half of the stops good a triple is good every eighth time
  for (int draw = 0; draw < k_draws && best.stops.size() < n; ++draw) {
    const std::size_t i = any(random), j = any(random), k = any(random);
    if (i == j || j == k || i == k) continue;
    const Mat3 A_j = stops[j].T_base_flange.linear().transpose() * stops[i].T_base_flange.linear();
    const Mat3 A_k = stops[k].T_base_flange.linear().transpose() * stops[i].T_base_flange.linear();
    const double turn_j = turn_rad(A_j, Mat3::Identity()), turn_k = turn_rad(A_k, Mat3::Identity());
    if (turn_j < k_least_turn_rad || turn_k < k_least_turn_rad) continue;
    const SE3& first = stops[i].T_cam_target[0];
    for (const SE3& T_j : stops[j].T_cam_target) {
      if (std::abs(turn_rad(T_j.linear() * first.linear().transpose(), Mat3::Identity()) - turn_j) >
          k_same_turn_rad)
        continue;
      for (const SE3& T_k : stops[k].T_cam_target) {
        if (std::abs(turn_rad(T_k.linear() * first.linear().transpose(), Mat3::Identity()) - turn_k) >
            k_same_turn_rad)
          continue;
        const std::vector<Stop> triple{
            {stops[i].T_base_flange, first}, {stops[j].T_base_flange, T_j}, {stops[k].T_base_flange, T_k}};
        const std::optional<Mat3> R_flange_cam = rotation_of_x(triple);
        if (!R_flange_cam) continue;
        Consensus here =
            agreeing(stops, *R_flange_cam, stops[i].T_base_flange.linear() * *R_flange_cam * first.linear());
        if (better(here, best)) best = std::move(here);
      }
    }
  }
  return settled(stops, std::move(best));
}

}  // namespace

Consensus rotation_consensus(std::span<const StopReadings> stops) {
  std::vector<StopReadings> reduced;
  std::vector<std::vector<std::size_t>> readings;
  for (const StopReadings& stop : stops) {
    TurnedStop one = turned(stop);
    reduced.push_back(std::move(one.stop));
    readings.push_back(std::move(one.readings));
  }
  Consensus consensus = consensus_of_turned(reduced);
  for (std::size_t i = 0; i < consensus.stops.size(); ++i)
    consensus.readings[i] = readings[consensus.stops[i]][consensus.readings[i]];
  return consensus;
}

std::string explain_disagreement(std::span<const StopReadings> stops, std::size_t enough) {
  const std::size_t n = stops.size();
  struct Hypothesis {
    std::string words;
    std::vector<StopReadings> stops;
  };
  const auto reordered = [&](auto source) {
    std::vector<StopReadings> result(stops.begin(), stops.end());
    for (std::size_t i = 0; i < n; ++i) result[i].T_base_flange = stops[source(i)].T_base_flange;
    return result;
  };
  const std::array<Hypothesis, 5> hypotheses{{
      {"the poses are inverted: they give base in flange, meant is T_base_flange, flange in base",
       changed(stops, [](StopReadings& stop) { stop.T_base_flange = stop.T_base_flange.inverse(); })},
      {"the quaternions are in the order x y z w, meant is w x y z",
       changed(stops,
               [](StopReadings& stop) {
                 const Eigen::Quaterniond q(stop.T_base_flange.linear());  // read as w x y z
                 stop.T_base_flange.linear() =
                     Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
               })},
      {"poses and pictures are off by one against each other",
       reordered([n](std::size_t i) { return (i + 1) % n; })},
      {"poses and pictures are off by one against each other",
       reordered([n](std::size_t i) { return (i + n - 1) % n; })},
      {"poses and pictures are in opposite order", reordered([n](std::size_t i) { return n - 1 - i; })},
  }};
  const auto best =
      std::max_element(hypotheses.begin(), hypotheses.end(), [&](const Hypothesis& a, const Hypothesis& b) {
        return agreement(a.stops, enough) < agreement(b.stops, enough);
      });
  return agreement(best->stops, enough) > 0 ? best->words : "";
}

}  // namespace biteline::calibration
