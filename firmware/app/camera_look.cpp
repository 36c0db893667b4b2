// SPDX-License-Identifier: MIT
#include "firmware/app/camera_look.hpp"

#include <algorithm>
#include <cstdio>

namespace biteline::sensor {
namespace {

using namespace std::chrono_literals;

constexpr int k_frames = 3;
/// A triggered network camera's first frames come late; a hand's patience is longer.
constexpr Nanoseconds k_patience = 3s;
/// Slow and short: any camera takes that of its whole sensor.
constexpr double k_rate_hz = 5;
constexpr Nanoseconds k_exposure = 5ms;

hal::CameraSettings settings_of(const hal::CameraLimits& limits,
                                const std::optional<geometry::SensorModel>& head, bool triggered) {
  hal::CameraSettings settings{
      .region = {.width_px = limits.sensor_width_px, .height_px = limits.sensor_height_px},
      .exposure = k_exposure,
      .rate_hz = k_rate_hz,
      .trigger = triggered ? hal::Trigger::Hardware : hal::Trigger::FreeRun};
  if (limits.exposure_max > Nanoseconds{0})
    settings.exposure = std::clamp(settings.exposure, limits.exposure_min, limits.exposure_max);
  if (!head) return settings;
  settings.region = head->region;
  settings.exposure = head->exposure.value_or(settings.exposure);
  settings.rate_hz = head->rate_hz.value_or(settings.rate_hz);
  return settings;
}

Result<std::string> take_frames(hal::LineCamera& camera) {
  int whole = 0, damaged = 0;
  std::string seen;
  while (whole < k_frames && damaged < k_frames) {
    BITELINE_ASSIGN(const hal::FrameView frame, camera.next_frame(k_patience));
    ((frame.flags & hal::k_frame_damaged) != 0 ? damaged : whole) += 1;
    seen = std::to_string(frame.width_px) + " x " + std::to_string(frame.height_px);
    camera.release(frame);
  }
  if (whole == 0) return fail(Errc::DeviceError, "every frame of %s comes damaged", seen.c_str());
  return std::to_string(whole) + " frames of " + seen;
}

}  // namespace

Result<std::string> look_through_camera(const BoardDevices& devices,
                                        const std::optional<geometry::SensorModel>& head) {
  BITELINE_ASSIGN(const std::unique_ptr<hal::LineCamera> camera, devices.open_camera());
  const geometry::CameraState calibrated = head ? head->camera_state : geometry::CameraState{};
  BITELINE_TRY(camera->set_state(calibrated));
  BITELINE_ASSIGN(const hal::CameraLimits limits, camera->limits());
  const bool triggered = devices.board().camera.hardware_trigger;
  const hal::CameraSettings wanted = settings_of(limits, head, triggered);
  BITELINE_TRY(camera->configure(wanted));
  // One that does not open is told by its own row of the check.
  const std::unique_ptr<hal::PwmOut> trigger = devices.open_trigger().value_or(nullptr);
  if (trigger) {
    const Nanoseconds period{static_cast<std::int64_t>(1e9 / wanted.rate_hz)};
    BITELINE_TRY(trigger->configure({.period = period, .pulse = std::min(wanted.exposure, period / 2)}));
  }
  BITELINE_TRY(camera->start());
  if (head) {
    BITELINE_ASSIGN(const geometry::CameraState seen, camera->state());
    BITELINE_TRY(geometry::expect_state(calibrated, seen));
  }
  const bool by_others = devices.by_way || (triggered && !trigger);
  if (by_others) return std::string{"streams; its frames come with the edges of a scan"};
  if (trigger) BITELINE_TRY(trigger->start());
  const Result<std::string> seen = take_frames(*camera);
  if (trigger) (void)trigger->stop();
  if (!seen && seen.error().code == Errc::Timeout)
    return fail(Errc::Timeout, triggered
                                   ? "no frame within 3 s, though edges are sent: check the trigger's wire"
                                   : "no frame within 3 s");
  return seen;
}

}  // namespace biteline::sensor
