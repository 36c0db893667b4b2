// SPDX-License-Identifier: MIT
#include "firmware/app/live_head.hpp"

#include "common/config/sensor_yaml.hpp"

namespace biteline::sensor {

Result<geometry::SensorModel> read_live_head(const std::filesystem::path& sensor_file) {
  BITELINE_ASSIGN(geometry::SensorModel head, config::read_sensor_yaml(sensor_file));
  if (!head.rate_hz || !head.exposure || *head.rate_hz <= 0) {
    return fail(Errc::BadValue, "%s: rate_hz and exposure_ns are needed to run a camera",
                sensor_file.c_str());
  }
  return head;
}

Result<void> configure_as_head(hal::LineCamera& camera, const geometry::SensorModel& head,
                               const Capture& capture, hal::Trigger trigger) {
  BITELINE_ASSIGN(const hal::CameraSettings got,
                  camera.configure({.region = head.region,
                                    .exposure = *head.exposure,
                                    .rate_hz = *head.rate_hz,
                                    .trigger = trigger,
                                    .second_exposure = capture.second_exposure,
                                    .laser_off_frames = capture.laser_off_frames}));
  const geometry::Region& region = got.region;
  if (region.offset_u_px == head.region.offset_u_px && region.offset_v_px == head.region.offset_v_px &&
      region.width_px == head.region.width_px && region.height_px == head.region.height_px) {
    return {};
  }
  return fail(Errc::DeviceError, "camera: its region is %d x %d at %d, %d instead of the head's",
              region.width_px, region.height_px, region.offset_u_px, region.offset_v_px);
}

hal::PwmSettings train_of(const geometry::SensorModel& head, const Capture& capture) {
  return {.period = Nanoseconds{static_cast<std::int64_t>(1e9 / *head.rate_hz)},
          .pulse = longest_exposure(capture, head)};
}

}  // namespace biteline::sensor
