// SPDX-License-Identifier: MIT
#include "biteline/calibrate.hpp"

#include "host/calibration/head/camera_state.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "host/calibration/head/verdict.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {

Calibration calibrate_head(const std::filesystem::path& folder) {
  calibration::HeadInput input;
  input.camera = or_throw(calibration::read_camera_folder(folder));
  input.laser = or_throw(calibration::read_laser_folder(folder));
  input.hand_eye = or_throw(calibration::read_hand_eye_folder(folder));
  const geometry::CameraState state = or_throw(calibration::read_folder_state(folder));
  const calibration::HeadCalibration result = calibration::calibrate_head(input);
  if (result.refused) {
    if (error_row(result.refused->code).exit_status != ExitStatus::Refused) throw_error(*result.refused);
    throw_refusal(report::told(calibration::refusal_of(result)));
  }
  calibration::Verdict verdict = calibration::judge(result);
  if (verdict.grade == calibration::Grade::Bad) throw_refusal(report::told(calibration::refusal_of(verdict)));
  geometry::SensorModel model;
  model.camera = result.fit.state.camera;
  model.laser_plane = result.fit.state.plane;
  model.T_flange_cam = result.fit.state.T_flange_cam;
  model.region = {.width_px = result.camera->size.width_px, .height_px = result.camera->size.height_px};
  model.camera_state = state;
  model.speckle_contrast = result.laser->speckle_contrast;
  return {.head = make_head(model),
          .good = verdict.grade == calibration::Grade::Good,
          .reasons = std::move(verdict.reasons),
          .retake = std::move(verdict.retake)};
}

}  // namespace biteline::sdk
