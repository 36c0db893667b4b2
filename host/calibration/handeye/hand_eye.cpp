// SPDX-License-Identifier: MIT
#include "host/calibration/handeye/hand_eye.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "host/calibration/handeye/consensus.hpp"
#include "host/calibration/handeye/motions.hpp"
#include "host/calibration/handeye/pose_adjustment.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::calibration {

namespace {

constexpr double k_degree = std::numbers::pi / 180;
constexpr int k_least_stops = 4;  ///< three motions
/// Axes within this cone are parallel for all that noise lets us know; translation along them would be made
/// up.
constexpr double k_least_axes_spread_rad = 5 * k_degree;
constexpr double k_least_turn_rad = 10 * k_degree;
/// Share of the stops that must agree for the others to be the odd ones.
constexpr double k_least_share = 0.6;
/// Robot and target may disagree on lengths by this much: print shrinks, arms are good to 0.1 %.
constexpr double k_scale_tolerance_ratio = 0.01;
/// A stop is odd when the others predict it this many times worse than they predict each other, and it
/// matters.
constexpr double k_odd_ratio = 5, k_odd_mm = 0.3, k_odd_rad = 0.1 * k_degree;

std::vector<StopReadings> all_readings(const std::vector<HandEyeView>& views) {
  std::vector<StopReadings> stops;
  for (const HandEyeView& view : views) {
    StopReadings stop{.T_base_flange = view.T_base_flange, .T_cam_target = {}};
    for (const Reading& reading : view.readings)
      stop.T_cam_target.push_back(view.pose.T_cam_target * reading.T_this_other);
    stops.push_back(std::move(stop));
  }
  return stops;
}

Result<void> check_motions(const std::vector<HandEyeView>& views, HandEyeCalibration& result) {
  if (views.size() < static_cast<std::size_t>(k_least_stops)) {
    return fail(Errc::Refused, "hand-eye: %d usable views give %d motions, at least 3 are needed",
                static_cast<int>(views.size()), std::max(0, static_cast<int>(views.size()) - 1));
  }
  std::vector<SE3> flanges;
  for (const HandEyeView& view : views) flanges.push_back(view.T_base_flange);
  const TurningSpread spread = turning_spread(flanges);
  result.largest_turn_rad = spread.largest_turn_rad;
  result.axes_spread_rad = spread.axes_spread_rad;
  if (spread.largest_turn_rad < k_least_turn_rad) {
    return fail(Errc::Degenerate,
                "hand-eye: the arm turned the camera by %.1f degrees at most, at least %.0f are needed "
                "(better 30 to 60)",
                spread.largest_turn_rad / k_degree, k_least_turn_rad / k_degree);
  }
  if (spread.axes_spread_rad < k_least_axes_spread_rad) {
    return fail(Errc::Degenerate,
                "hand-eye: all rotation axes are parallel within %.1f degrees; turn about a second axis too",
                spread.axes_spread_rad / k_degree);
  }
  return {};
}

Result<void> check_scale(const std::vector<Stop>& stops, const Mat3& R_flange_cam, SE3& T_flange_cam) {
  const std::optional<TranslationFit> fit = translation_of_x(stops, R_flange_cam);
  if (!fit) return fail(Errc::Degenerate, "hand-eye: the motions do not determine the translation");
  const double scale = fit->pose_scale;
  const auto near = [&](double value) { return std::abs(scale / value - 1) < 0.1; };
  // Seen in a mirror every rotation has a proper twin, M R M = (-M) R (-M); the translations come out
  // reversed.
  if (near(-1))
    return fail(
        Errc::Refused,
        "hand-eye: the pictures are mirror images (flipped in the camera's driver, or seen in a mirror)");
  if (near(1000))
    return fail(
        Errc::Refused,
        "hand-eye: the poses are in metres (or the target's pitch a thousand times too large); meant is mm");
  if (near(1e-3))
    return fail(Errc::Refused,
                "hand-eye: the target is told in metres (or the poses in micrometres); meant is mm");
  if (near(25.4)) return fail(Errc::Refused, "hand-eye: the poses are in inches; meant is mm");
  if (std::abs(scale - 1) > std::max(k_scale_tolerance_ratio, 5 * fit->pose_scale_sigma)) {
    return fail(Errc::Refused,
                "hand-eye: robot and target disagree on lengths by a factor %.4f +- %.4f: units of the "
                "poses, pitch of the target?",
                1 / scale, fit->pose_scale_sigma);
  }
  T_flange_cam = geometry::make_se3(Eigen::Quaterniond(R_flange_cam), fit->translation_mm);
  return {};
}

PoseAdjustment start_of(const SE3& T_flange_cam, const Stop& first) {
  PoseAdjustment start;
  start.T_flange_cam = T_flange_cam;
  start.T_base_target = first.T_base_flange * T_flange_cam * first.T_cam_target;
  return start;
}

struct LeftOut {
  double mm{0};
  double rad{0};
};

/// Prediction of each stop from all others.
std::vector<LeftOut> leave_one_out(const std::vector<WeightedStop>& stops, const PoseAdjustment& all,
                                   const Vec3& middle_target) {
  std::vector<LeftOut> errors;
  for (std::size_t k = 0; k < stops.size(); ++k) {
    std::vector<WeightedStop> rest = stops;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    const SE3 T = T_seen_predicted(stops[k].stop, adjust_poses(rest, all));
    errors.push_back(
        {.mm = (T * middle_target - middle_target).norm(), .rad = geometry::log_so3(T.linear()).norm()});
  }
  return errors;
}

/// Shifts of whole pitches look alike to rotations: the reading whose place agrees with the rest.
void choose_shifts(const std::vector<StopReadings>& all, const SE3& T_flange_cam, const SE3& T_base_target,
                   Consensus& consensus) {
  for (std::size_t i = 0; i < consensus.stops.size(); ++i) {
    const StopReadings& stop = all[consensus.stops[i]];
    const SE3 expected = (stop.T_base_flange * T_flange_cam).inverse() * T_base_target;
    double best_mm = 1e300;
    for (std::size_t k = 0; k < stop.T_cam_target.size(); ++k) {
      const SE3 T = expected.inverse() * stop.T_cam_target[k];
      if (geometry::log_so3(T.linear()).norm() > 0.3 || T.translation().norm() >= best_mm) continue;
      best_mm = T.translation().norm();
      consensus.readings[i] = k;
    }
  }
}

std::vector<Stop> chosen(const std::vector<StopReadings>& all, const Consensus& consensus) {
  std::vector<Stop> stops;
  for (std::size_t i = 0; i < consensus.stops.size(); ++i) {
    const StopReadings& stop = all[consensus.stops[i]];
    stops.push_back(
        {.T_base_flange = stop.T_base_flange, .T_cam_target = stop.T_cam_target[consensus.readings[i]]});
  }
  return stops;
}

/// Those stops whose grid lost no row or column, so that no shift can be taken for another; all, where these
/// alone do not give three motions.
std::vector<Stop> surest(const std::vector<StopReadings>& all, const Consensus& consensus,
                         const std::vector<Stop>& stops) {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const StopReadings& stop : all) fewest = std::min(fewest, stop.T_cam_target.size());
  std::vector<Stop> sure;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (all[consensus.stops[i]].T_cam_target.size() == fewest) sure.push_back(stops[i]);
  }
  return sure.size() < static_cast<std::size_t>(k_least_stops) ? stops : sure;
}

}  // namespace

Result<HandEyeCalibration> calibrate_hand_eye(const std::vector<HandEyeView>& views,
                                              const HandEyeOptions& options) {
  HandEyeCalibration result;
  BITELINE_TRY(check_motions(views, result));
  const std::vector<StopReadings> all = all_readings(views);
  const auto enough = std::max<std::size_t>(
      k_least_stops, static_cast<std::size_t>(std::ceil(k_least_share * static_cast<double>(views.size()))));
  Consensus consensus = rotation_consensus(all);
  if (consensus.stops.size() < enough) {
    const std::string why = explain_disagreement(all, enough);
    if (!why.empty()) return fail(Errc::Refused, "hand-eye: %s", why.c_str());
    return fail(Errc::Refused,
                "hand-eye: robot and camera disagree: only %d of %d views fit one mounting (poses and "
                "pictures in another order?)",
                static_cast<int>(consensus.stops.size()), static_cast<int>(views.size()));
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (std::find(consensus.stops.begin(), consensus.stops.end(), i) != consensus.stops.end()) continue;
    result.set_aside.push_back(
        {.name = views[i].name,
         .reason = "its pose and its picture turn differently from all others (row of another view?)"});
  }
  std::vector<Stop> stops = chosen(all, consensus);
  const std::vector<Stop> sure = surest(all, consensus, stops);
  SE3 T_flange_cam = SE3::Identity();
  BITELINE_TRY(check_scale(sure, consensus.R_flange_cam, T_flange_cam));
  PoseAdjustment adjusted = start_of(T_flange_cam, sure.front());
  for (;;) {
    choose_shifts(all, adjusted.T_flange_cam, adjusted.T_base_target, consensus);
    stops = chosen(all, consensus);
    std::vector<WeightedStop> weighted;
    const double variance_px2 = options.centre_sigma_px * options.centre_sigma_px;
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const HandEyeView& view = views[consensus.stops[i]];
      const Mat6 Ad = adjoint(view.readings[consensus.readings[i]].T_this_other.inverse());
      weighted.push_back(
          {.stop = stops[i],
           .covariance_seen = Ad * view.pose.covariance_per_px2 * Ad.transpose() * variance_px2});
    }
    adjusted = adjust_poses_and_noise(weighted, adjusted);
    if (!adjusted.converged) return fail(Errc::NotConverged, "hand-eye: the refinement did not converge");
    const std::vector<LeftOut> errors = leave_one_out(weighted, adjusted, options.middle_target);
    std::vector<double> mm, rad;
    for (const LeftOut& e : errors) {
      mm.push_back(e.mm);
      rad.push_back(e.rad);
    }
    const double limit_mm = std::max(k_odd_mm, k_odd_ratio * geometry::median_of(mm)),
                 limit_rad = std::max(k_odd_rad, k_odd_ratio * geometry::median_of(rad));
    std::size_t worst = 0;
    const auto oddness = [&](std::size_t i) { return std::max(mm[i] / limit_mm, rad[i] / limit_rad); };
    for (std::size_t i = 1; i < errors.size(); ++i) worst = oddness(i) > oddness(worst) ? i : worst;
    if (oddness(worst) > 1 && stops.size() > enough) {
      char reason[160];
      std::snprintf(reason, sizeof reason,
                    "the others predict it %.2f mm and %.3f degrees off, each other %.2f mm and %.3f (row of "
                    "another view? target moved?)",
                    mm[worst], rad[worst] / k_degree, geometry::median_of(mm),
                    geometry::median_of(rad) / k_degree);
      result.set_aside.push_back({.name = views[consensus.stops[worst]].name, .reason = reason});
      consensus.stops.erase(consensus.stops.begin() + static_cast<std::ptrdiff_t>(worst));
      consensus.readings.erase(consensus.readings.begin() + static_cast<std::ptrdiff_t>(worst));
      continue;
    }
    double sum_mm2 = 0, sum_rad2 = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      result.stops.push_back({.view = consensus.stops[i],
                              .reading = consensus.readings[i],
                              .T_cam_target = stops[i].T_cam_target,
                              .left_out_mm = mm[i],
                              .left_out_rad = rad[i]});
      sum_mm2 += mm[i] * mm[i];
      sum_rad2 += rad[i] * rad[i];
    }
    result.left_out_rms_mm = std::sqrt(sum_mm2 / static_cast<double>(errors.size()));
    result.left_out_rms_rad = std::sqrt(sum_rad2 / static_cast<double>(errors.size()));
    break;
  }
  result.T_flange_cam = adjusted.T_flange_cam;
  result.T_base_target = adjusted.T_base_target;
  result.covariance = adjusted.covariance;
  result.pose_sigma_mm = adjusted.noise.sigma_mm;
  result.pose_sigma_rad = adjusted.noise.sigma_rad;
  const double sigma_mm = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
  const double sigma_rad = std::sqrt(result.covariance.bottomRightCorner<3, 3>().trace());
  if (sigma_mm > options.most_sigma_mm || sigma_rad > options.most_sigma_rad) {
    return fail(Errc::Degenerate,
                "hand-eye: %d views leave the camera's place uncertain by %.2f mm and %.3f degrees (noise "
                "per pose %.2f mm, %.3f degrees): more and larger turns are needed",
                static_cast<int>(stops.size()), sigma_mm, sigma_rad / k_degree, result.pose_sigma_mm,
                result.pose_sigma_rad / k_degree);
  }
  if (result.left_out_rms_mm > options.most_left_out_mm) {
    return fail(Errc::Refused,
                "hand-eye: robot and camera disagree: left-out views are predicted %.1f mm off",
                result.left_out_rms_mm);
  }
  return result;
}

}  // namespace biteline::calibration
