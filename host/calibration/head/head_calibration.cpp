// SPDX-License-Identifier: MIT
#include "host/calibration/head/head_calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host/calibration/head/input_fault.hpp"

namespace biteline::calibration {

namespace {

/// An arm's view under the camera's calibration: more, and it is another camera's or another target's.
constexpr double k_most_view_rms_px = 0.2, k_most_view_ratio = 5;
/// All pictures are one camera's: together they fit about as well as its own do.  Blur and light differ by
/// less than that.
constexpr double k_most_joint_ratio = 1.7, k_least_joint_rms_px = 0.06, k_most_change_sigmas = 4;
/// The ring target's print may differ from what target.yaml says by this much before it is another target.
constexpr double k_diameter_tolerance_ratio = 0.15;

void append(std::vector<SetAside>& all, const std::vector<SetAside>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

Result<void> check_print(const std::vector<PlaneView>& views) {
  for (const PlaneView& view : views) {
    if (view.target.chessboard()) continue;
    const double told = view.target.inner_diameter_mm / view.target.outer_diameter_mm,
                 seen = seen_diameter_ratio(view);
    if (seen > 0 && std::abs(seen / told - 1) > k_diameter_tolerance_ratio) {
      return fail(Errc::Refused,
                  "%s: rings with inner to outer diameter %.2f, target.yaml says %.2f: another target?",
                  view.name.c_str(), seen, told);
    }
  }
  return {};
}

std::vector<Ring> rings_of(std::span<const PlaneView> grids) {
  std::vector<Ring> rings;
  for (const PlaneView& view : grids) {
    for (const GridRing& ring : view.grid.rings) rings.push_back(ring.ring);
  }
  return rings;
}

PixelGrid pixel_grid_of(const HeadInput& input) {
  std::vector<std::vector<Ring>> pictures;
  if (input.camera) {
    for (const PlaneView& view : input.camera->views) pictures.push_back(rings_of({&view, 1}));
  }
  if (input.hand_eye) {
    for (const ArmPicture& picture : input.hand_eye->views) pictures.push_back(rings_of({&picture.view, 1}));
  }
  if (input.laser) {
    for (const LaserPictures& place : input.laser->places) pictures.push_back(rings_of(place.planes));
  }
  return find_pixel_grid(pictures);
}

/// The views as a camera with an even grid would have given them.
HeadInput evened_out(HeadInput input, const PixelGrid& grid) {
  const auto even_out = [&](PlaneView& view) {
    for (GridRing& ring : view.grid.rings) ring.ring = grid.corrected(ring.ring);
    view = make_plane_view(view.name, view.grid, view.target);
  };
  if (input.camera) std::for_each(input.camera->views.begin(), input.camera->views.end(), even_out);
  if (input.hand_eye) {
    for (ArmPicture& picture : input.hand_eye->views) even_out(picture.view);
  }
  if (input.laser) {
    for (LaserPictures& place : input.laser->places)
      std::for_each(place.planes.begin(), place.planes.end(), even_out);
  }
  return input;
}

class Calibrator {
 public:
  Calibrator(const HeadInput& input, const PixelGrid& grid) : input_{input} { result_.pixel_grid = grid; }

  HeadCalibration run() {
    const Result<void> done = all_parts();
    if (!done) result_.refused = done.error();
    return std::move(result_);
  }

 private:
  Result<void> all_parts() {
    result_.refused_in = Part::Camera;
    BITELINE_TRY(camera_part());
    result_.refused_in = Part::Laser;
    if (input_.laser) BITELINE_TRY(laser_part());
    result_.refused_in = Part::HandEye;
    if (input_.hand_eye) BITELINE_TRY(hand_eye_part());
    result_.refused_in = Part::Together;
    return together();
  }

  Result<void> camera_part() {
    if (!input_.camera) {
      if (!input_.known_camera)
        return fail(Errc::InvalidArgument,
                    "camera: neither pictures in camera/ nor a known camera (--sensor)");
      camera_ = *input_.known_camera;
      return {};
    }
    append(result_.set_aside, input_.camera->set_aside);
    BITELINE_TRY(check_print(input_.camera->views));
    BITELINE_ASSIGN(result_.camera, calibrate_camera(input_.camera->views, input_.camera->size));
    append(result_.set_aside, result_.camera->set_aside);
    camera_ = result_.camera->camera;
    centre_sigma_px_ = result_.camera->sigma_px;
    for (const CameraView& view : result_.camera->views)
      seen_.free.push_back({.view = view.view, .T_cam_target = view.T_cam_target});
    start_.distortion = result_.camera->distortion;
    return {};
  }

  Result<void> laser_part() {
    append(result_.set_aside, input_.laser->set_aside);
    BITELINE_ASSIGN(result_.laser, calibrate_laser(camera_, input_.laser->places));
    append(result_.set_aside, result_.laser->set_aside);
    start_.plane = result_.laser->plane;
    start_.T_plane1_plane2 = result_.laser->T_plane1_plane2;
    for (const LaserView& view : result_.laser->views) {
      seen_.stripe.push_back({.planes = view.pictures.planes,
                              .T_cam_plane = view.T_cam_plane,
                              .rigid = view.rigid,
                              .points = view.points});
    }
    return {};
  }

  Result<void> hand_eye_part() {
    append(result_.set_aside, input_.hand_eye->set_aside);
    std::vector<HandEyeView> views;
    std::vector<const ArmPicture*> pictures;
    std::vector<PlaneView> improved;
    for (const ArmPicture& picture : input_.hand_eye->views) {
      PlaneView view = picture.view;
      const auto pose = fit_view_pose(camera_, view);
      const double limit_px =
          std::max(k_most_view_rms_px, k_most_view_ratio * std::sqrt(2.0) * centre_sigma_px_);
      if (!pose || pose->rms_px > limit_px) {
        char reason[160];
        std::snprintf(
            reason, sizeof reason,
            "%s off by %.2f px under the camera's calibration, at most %.2f expected (another camera?)",
            view.target.marks(), pose ? pose->rms_px : 0.0, limit_px);
        result_.set_aside.push_back({.name = view.name, .reason = reason});
        continue;
      }
      views.push_back({.name = view.name,
                       .T_base_flange = picture.T_base_flange,
                       .pose = *pose,
                       .readings = view.grid.readings});
      pictures.push_back(&picture);
      improved.push_back(std::move(view));
    }
    BITELINE_ASSIGN(result_.hand_eye,
                    calibrate_hand_eye(views, {.centre_sigma_px = centre_sigma_px_,
                                               .middle_target = input_.hand_eye->target.middle_target()}));
    append(result_.set_aside, result_.hand_eye->set_aside);
    for (const HandEyeStop& stop : result_.hand_eye->stops) {
      ArmPicture arm{.view = improved[stop.view], .T_base_flange = pictures[stop.view]->T_base_flange};
      const SE3 T_other_this = arm.view.grid.readings[stop.reading].T_this_other.inverse();
      for (CentreObservation& c : arm.view.centres) c.point_target = T_other_this * c.point_target;
      seen_.arm.push_back({.view = arm.view, .T_base_flange = arm.T_base_flange});
      result_.arm_views.push_back(std::move(arm));
    }
    start_.T_flange_cam = result_.hand_eye->T_flange_cam;
    start_.T_base_target = result_.hand_eye->T_base_target;
    seen_.pose_noise = {.sigma_mm = result_.hand_eye->pose_sigma_mm,
                        .sigma_rad = result_.hand_eye->pose_sigma_rad};
    return {};
  }

  Result<void> together() {
    start_.camera = camera_;
    seen_.centre_sigma_px = centre_sigma_px_;
    seen_.camera_known = !input_.camera;
    result_.fit = solve_head(seen_, start_);
    if (!result_.fit.converged)
      return fail(Errc::NotConverged, "the adjustment of everything together did not converge");
    return check_agreement();
  }

  /// The folders show one camera: together they fit about as well as camera/ alone, and tell the same lens.
  Result<void> check_agreement() const {
    if (!result_.camera) return {};
    if (result_.fit.rms_px > std::max(k_least_joint_rms_px, k_most_joint_ratio * result_.camera->rms_px)) {
      return fail(Errc::Refused,
                  "the folders contradict each other: %s to %.3f px together, camera/ alone to %.3f px "
                  "(one folder mirrored, or of another camera?)",
                  input_.camera->target.marks(), result_.fit.rms_px, result_.camera->rms_px);
    }
    const CameraVector sigma = result_.camera->sigma();
    const geometry::Camera &alone = result_.camera->camera, &all = result_.fit.state.camera;
    const std::array<double, 4> change{all.fu_px - alone.fu_px, all.fv_px - alone.fv_px,
                                       all.cu_px - alone.cu_px, all.cv_px - alone.cv_px};
    for (int i = 0; i < 4; ++i) {
      if (std::abs(change[static_cast<std::size_t>(i)]) <= k_most_change_sigmas * sigma[i]) continue;
      return fail(Errc::Refused,
                  "the folders contradict each other: camera/ alone puts the principal point to (%.1f, "
                  "%.1f), all pictures to (%.1f, %.1f) (one folder mirrored?)",
                  alone.cu_px, alone.cv_px, all.cu_px, all.cv_px);
    }
    return {};
  }

  const HeadInput& input_;
  HeadCalibration result_;
  geometry::Camera camera_;
  /// Until the camera's own pictures tell: what ring centres are good to on any sharp picture.
  double centre_sigma_px_{0.05};
  HeadObservations seen_;
  HeadState start_;
};

}  // namespace

Refusal refusal_of(const HeadCalibration& calibration) {
  BITELINE_EXPECTS(calibration.refused.has_value());
  if (!calibration.refused_as) return refusal_of(calibration.refused_in, *calibration.refused);
  return {.code = *calibration.refused_as, .reason = std::string{calibration.refused->where.view()}};
}

HeadCalibration calibrate_head(const HeadInput& input) {
  if (const std::optional<Refusal> fault = input_fault(input)) {
    HeadCalibration result;
    result.refused = fail(Errc::Refused, "%s", fault->reason.c_str()).value();
    result.refused_as = fault->code;
    if (input.camera) append(result.set_aside, input.camera->set_aside);
    if (input.laser) append(result.set_aside, input.laser->set_aside);
    if (input.hand_eye) append(result.set_aside, input.hand_eye->set_aside);
    return result;
  }
  const PixelGrid grid = pixel_grid_of(input);
  if (!grid.uneven()) return Calibrator(input, grid).run();
  const HeadInput even = evened_out(input, grid);
  return Calibrator(even, grid).run();
}

}  // namespace biteline::calibration
