// SPDX-License-Identifier: MIT
#include "hal/replay/recording.hpp"

#include "common/config/sensor_yaml.hpp"

namespace biteline::hal::replay {

Result<std::shared_ptr<const session::Session>> open_recording(
    const std::filesystem::path& folder, const std::optional<std::filesystem::path>& sensor_file) {
  BITELINE_ASSIGN(session::Session session, session::read_session(folder));
  if (sensor_file) {
    BITELINE_ASSIGN(const geometry::SensorModel calibrated, config::read_sensor_yaml(*sensor_file));
    // The pictures are as the camera gave them: another state's calibration does not fit them.
    if (const Result<void> fits =
            geometry::expect_state(calibrated.camera_state, session.sensor.camera_state);
        !fits) {
      return fail(Errc::Refused, "%.80s: %.160s", folder.c_str(), fits.error().where.c_str());
    }
    session.sensor.camera = calibrated.camera;
    session.sensor.laser_plane = calibrated.laser_plane;
    session.sensor.T_flange_cam = calibrated.T_flange_cam;
  }
  return std::make_shared<const session::Session>(std::move(session));
}

}  // namespace biteline::hal::replay
