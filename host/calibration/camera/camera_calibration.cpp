// SPDX-License-Identifier: MIT
#include "host/calibration/camera/camera_calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/calibration/camera/plane_pose.hpp"
#include "host/calibration/rings/homography.hpp"

namespace biteline::calibration {

namespace {

constexpr int k_least_views =
    3;  ///< two views give as many equations as unknowns: nothing would show a bad one
/// Removing a view that agrees lowers the sum of squares as its share of the noise would, ratio 1; 4 means
/// twice the noise of the others, beyond 3 standard deviations for any view of 6 rings or more.
constexpr double k_harm_ratio = 4;
/// A harmful view must also matter: below, it is the noise that differs, not the camera.
constexpr double k_harm_rms_px = 0.08;
/// Whole-pixel blunders remain: wrong target, wrong order, moving target.
constexpr double k_most_rms_px = 1.0;
/// Beyond, a stripe at working distance would be off by more than its own noise.
constexpr double k_most_focal_sigma_ratio = 5e-3;
/// |value| / sigma below which a coefficient is left out.  k3 needs more: outside of the rings it
/// extrapolates wildly, and where centres are good to some 0.005 px it is what fits their last common errors.
constexpr double k_significant_sigmas = 2, k_significant_sigmas_k3 = 5;

struct State {
  std::vector<PlaneView> views;
  std::vector<int> rings_set_aside;
  geometry::Camera camera;
  std::vector<SE3> T_cam_target;
};

std::vector<const PlaneView*> pointers(const State& state, std::size_t without) {
  std::vector<const PlaneView*> result;
  for (std::size_t i = 0; i < state.views.size(); ++i) {
    if (i != without) result.push_back(&state.views[i]);
  }
  return result;
}

constexpr std::size_t k_none = static_cast<std::size_t>(-1);

BundleFit fit(const State& state, std::size_t without, const DistortionChoice& distortion,
              bool with_covariance) {
  BundleStart start{.camera = state.camera,
                    .T_cam_target = {},
                    .distortion = distortion,
                    .with_covariance = with_covariance};
  for (std::size_t i = 0; i < state.views.size(); ++i) {
    if (i != without) start.T_cam_target.push_back(state.T_cam_target[i]);
  }
  return solve_bundle(pointers(state, without), start);
}

void keep(State& state, const BundleFit& solved) {
  state.camera = solved.camera;
  state.T_cam_target = solved.T_cam_target;
}

void remove_view(State& state, std::size_t index) {
  const auto at = static_cast<std::ptrdiff_t>(index);
  state.views.erase(state.views.begin() + at);
  state.rings_set_aside.erase(state.rings_set_aside.begin() + at);
  state.T_cam_target.erase(state.T_cam_target.begin() + at);
}

/// Closed form over all views, or, where one of them spoils it, over all but one.
bool start_from_closed_form(State& state, PictureSize size) {
  std::vector<Mat3> all;
  for (const PlaneView& view : state.views) {
    std::vector<PlanePoint> points;
    for (const CentreObservation& c : view.centres)
      points.push_back({.plane = c.point_target.head<2>(), .image = c.pixel_px});
    const std::optional<Mat3> H = fit_homography(points);
    if (!H) return false;
    all.push_back(*H);
  }
  std::optional<geometry::Camera> camera = closed_form_camera(all, size);
  for (std::size_t i = 0; !camera && i < all.size(); ++i) {
    std::vector<Mat3> rest = all;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    camera = closed_form_camera(rest, size);
  }
  if (!camera) return false;
  state.camera = *camera;
  state.T_cam_target.clear();
  for (const PlaneView& view : state.views) {
    const std::optional<PlanePose> pose = fit_plane_pose(*camera, view.centres);
    if (!pose) return false;
    state.T_cam_target.push_back(pose->T_cam_target);
  }
  return true;
}

double view_rms_px(const State& state, std::size_t index) {
  double sum = 0;
  for (const CentreObservation& c : state.views[index].centres) {
    sum += (state.camera.project(state.T_cam_target[index] * c.point_target) - c.pixel_px).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(state.views[index].centres.size()));
}

/// The view whose removal lowers the sum of squares most beyond its share.
struct Harm {
  std::size_t view{k_none};
  double ratio{0};
  double rms_px{0};  ///< of the view under the camera of the others
};

Harm most_harmful(const State& state, const BundleFit& all, const DistortionChoice& distortion) {
  Harm worst;
  for (std::size_t i = 0; i < state.views.size(); ++i) {
    const BundleFit rest = fit(state, i, distortion, false);
    const int freedom = rest.residuals - rest.unknowns;
    if (freedom <= 0) continue;
    const double removed = all.residuals - rest.residuals - 6.0;
    const double ratio = (all.sum_px2 - rest.sum_px2) / std::max(1.0, removed) / (rest.sum_px2 / freedom);
    if (ratio <= worst.ratio) continue;
    const std::optional<PlanePose> alone = fit_plane_pose(rest.camera, state.views[i].centres);
    worst = {.view = i, .ratio = ratio, .rms_px = alone ? alone->rms_px : 1e6};
  }
  return worst;
}

/// Takes out single rings; true when there were any.
bool set_rings_aside(State& state) {
  bool any = false;
  for (std::size_t v = 0; v < state.views.size(); ++v) {
    const int count = set_rings_aside(state.views[v], state.camera, state.T_cam_target[v]);
    state.rings_set_aside[v] += count;
    any = any || count > 0;
  }
  return any;
}

/// Leaves out what the data cannot tell from 0: k3 before k2 before k1, since they stand in for each other;
/// p1 and p2 together, since they are one tilt.
BundleFit choose_distortion(State& state, DistortionChoice& distortion) {
  BundleFit solved = fit(state, k_none, distortion, true);
  const auto chi2 = [&](std::initializer_list<int> which) {
    const double variance_px2 = std::pow(solved.sigma_px(), 2);
    const std::array<double, 5> values{solved.camera.k1, solved.camera.k2, solved.camera.p1, solved.camera.p2,
                                       solved.camera.k3};
    double sum = 0;
    for (const int i : which) {
      const double variance = variance_px2 * solved.covariance_per_px2(4 + i, 4 + i);
      sum += variance > 0
                 ? values[static_cast<std::size_t>(i)] * values[static_cast<std::size_t>(i)] / variance
                 : 0.0;
    }
    return sum / static_cast<double>(which.size());
  };
  const auto leave_out = [&](std::initializer_list<int> which, double sigmas) {
    if (chi2(which) >= sigmas * sigmas) return false;
    for (const int i : which) distortion[static_cast<std::size_t>(i)] = false;
    keep(state, solved);
    solved = fit(state, k_none, distortion, true);
    return true;
  };
  leave_out({2, 3}, k_significant_sigmas);
  if (leave_out({4}, k_significant_sigmas_k3) && leave_out({1}, k_significant_sigmas))
    leave_out({0}, k_significant_sigmas);
  keep(state, solved);
  return solved;
}

double coverage(const State& state, PictureSize size) {
  std::array<bool, 48> seen{};
  for (const PlaneView& view : state.views) {
    for (const CentreObservation& c : view.centres) {
      const int column = std::clamp(static_cast<int>(8 * c.pixel_px.x() / size.width_px), 0, 7);
      const int row = std::clamp(static_cast<int>(6 * c.pixel_px.y() / size.height_px), 0, 5);
      seen[static_cast<std::size_t>(row * 8 + column)] = true;
    }
  }
  return static_cast<double>(std::count(seen.begin(), seen.end(), true)) / 48.0;
}

/// Solves and sets harmful views aside until the rest agree.
Result<BundleFit> solve_consistently(State& state, const DistortionChoice& distortion,
                                     std::vector<SetAside>& set_aside) {
  const std::size_t most_removed = state.views.size() / 3;
  for (std::size_t removed = 0;; ++removed) {
    for (int round = 0; round < 2; ++round) {
      keep(state, fit(state, k_none, distortion, false));
      for (std::size_t i = 0; i < state.views.size(); ++i)
        improve_centres(state.views[i], state.camera, state.T_cam_target[i]);
      set_rings_aside(state);
    }
    BundleFit solved = fit(state, k_none, distortion, false);
    keep(state, solved);
    if (state.views.size() <= static_cast<std::size_t>(k_least_views)) return solved;
    const Harm harm = most_harmful(state, solved, distortion);
    if (harm.view == k_none || harm.ratio < k_harm_ratio || harm.rms_px < k_harm_rms_px) return solved;
    const std::string& name = state.views[harm.view].name;
    if (removed == most_removed) {
      return fail(
          Errc::Refused,
          "camera: %d of %d views contradict the others, the next would be %s: one camera, one target?",
          static_cast<int>(removed), static_cast<int>(state.views.size() + removed), name.c_str());
    }
    char reason[200];
    std::snprintf(reason, sizeof reason,
                  "contradicts the other views: %.2f px under their camera, %.2f px among themselves "
                  "(another camera, lens or target?)",
                  harm.rms_px, fit(state, harm.view, distortion, false).rms_px());
    set_aside.push_back({.name = name, .reason = reason});
    remove_view(state, harm.view);
  }
}

}  // namespace

Result<CameraCalibration> calibrate_camera(std::vector<PlaneView> views, PictureSize size) {
  if (views.size() < static_cast<std::size_t>(k_least_views)) {
    return fail(Errc::Refused, "camera: %d usable views, at least %d are needed",
                static_cast<int>(views.size()), k_least_views);
  }
  State state{.views = std::move(views), .rings_set_aside = {}, .camera = {}, .T_cam_target = {}};
  state.rings_set_aside.assign(state.views.size(), 0);
  if (!start_from_closed_form(state, size)) {
    return fail(Errc::Degenerate,
                "camera: the views do not determine the focal length (all of them parallel to the sensor?)");
  }
  CameraCalibration result;
  result.size = size;
  // Weakly determined coefficients would let a wrong view hide; two radial ones are enough to find it.
  BITELINE_TRY(solve_consistently(state, {true, true, true, true, false}, result.set_aside));
  result.distortion = {true, true, true, true, true};
  BundleFit solved = choose_distortion(state, result.distortion);
  for (int round = 0; round < 3 && set_rings_aside(state); ++round) {
    result.distortion = {true, true, true, true, true};
    solved = choose_distortion(state, result.distortion);
  }
  if (!solved.converged) return fail(Errc::NotConverged, "camera: the refinement did not converge");
  if (solved.rms_px() > k_most_rms_px) {
    return fail(Errc::Refused,
                "camera: reprojection RMS %.2f px, at most %.1f px is a calibration (target.yaml right? flat "
                "target?)",
                solved.rms_px(), k_most_rms_px);
  }
  result.camera = solved.camera;
  result.sigma_px = solved.sigma_px();
  result.rms_px = solved.rms_px();
  result.covariance = solved.covariance_per_px2 * result.sigma_px * result.sigma_px;
  result.iterations = solved.iterations;
  result.coverage_ratio = coverage(state, size);
  const double focal_sigma_ratio =
      std::max(result.sigma()[0] / solved.camera.fu_px, result.sigma()[1] / solved.camera.fv_px);
  if (!(focal_sigma_ratio < k_most_focal_sigma_ratio)) {
    return fail(
        Errc::Degenerate,
        "camera: focal length uncertain by %.2f %%: tilt the target by 20 to 45 degrees in more views",
        100 * focal_sigma_ratio);
  }
  for (std::size_t i = 0; i < state.views.size(); ++i) {
    const double cos_tilt = std::abs(state.T_cam_target[i].linear()(2, 2));
    result.largest_tilt_rad = std::max(result.largest_tilt_rad, std::acos(std::min(1.0, cos_tilt)));
    result.views.push_back({.view = state.views[i],
                            .T_cam_target = state.T_cam_target[i],
                            .rms_px = view_rms_px(state, i),
                            .rings_set_aside = state.rings_set_aside[i]});
  }
  return result;
}

}  // namespace biteline::calibration
