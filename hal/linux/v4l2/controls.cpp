// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/controls.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

std::optional<v4l2_queryctrl> query(int device, std::uint32_t id) {
  v4l2_queryctrl control{};
  control.id = id;
  if (retrying_ioctl(device, VIDIOC_QUERYCTRL, &control) < 0) return std::nullopt;
  if ((control.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  return control;
}

std::optional<std::int64_t> read_wide(int device, std::uint32_t id) {
  v4l2_ext_control value{};
  value.id = id;
  v4l2_ext_controls request{};
  request.which = V4L2_CTRL_WHICH_CUR_VAL;
  request.count = 1;
  request.controls = &value;
  if (retrying_ioctl(device, VIDIOC_G_EXT_CTRLS, &request) < 0) return std::nullopt;
  return id == V4L2_CID_PIXEL_RATE ? value.value64 : value.value;
}

/// One sensor line: (width + horizontal blanking) / pixel rate.
std::optional<Nanoseconds> line_time(int device, int width_px) {
  const std::optional<std::int64_t> blanking_px = read_wide(device, V4L2_CID_HBLANK);
  const std::optional<std::int64_t> rate_px_s = read_wide(device, V4L2_CID_PIXEL_RATE);
  if (!blanking_px || !rate_px_s || *rate_px_s <= 0) return std::nullopt;
  return Nanoseconds{(width_px + *blanking_px) * 1'000'000'000 / *rate_px_s};
}

Result<void> set(int device, std::uint32_t id, std::int32_t value, const char* name) {
  v4l2_control control{.id = id, .value = value};
  if (retrying_ioctl(device, VIDIOC_S_CTRL, &control) < 0) return device_failure(errno, "camera", name);
  return {};
}

}  // namespace

Result<std::int64_t> ExposureRegister::steps_for(Nanoseconds exposure) const {
  const std::int64_t wanted = (exposure + unit / 2) / unit;
  if (wanted < minimum || wanted > maximum) {
    return fail(Errc::BadValue, "exposure %lld us, the camera takes %lld to %lld us",
                static_cast<long long>(exposure.count() / 1000),
                static_cast<long long>(shortest().count() / 1000),
                static_cast<long long>(longest().count() / 1000));
  }
  const std::int64_t in_steps = minimum + (wanted - minimum + step / 2) / step * step;
  return in_steps > maximum ? in_steps - step : in_steps;
}

std::optional<ExposureRegister> find_exposure(int device, int width_px) {
  constexpr Nanoseconds k_absolute_unit{100'000};  // V4L2_CID_EXPOSURE_ABSOLUTE counts 100 us
  std::optional<v4l2_queryctrl> control = query(device, V4L2_CID_EXPOSURE_ABSOLUTE);
  std::optional<Nanoseconds> unit = k_absolute_unit;
  if (!control) {
    control = query(device, V4L2_CID_EXPOSURE);
    unit = line_time(device, width_px);
  }
  if (!control || !unit || *unit <= Nanoseconds{0}) return std::nullopt;
  return ExposureRegister{.id = control->id,
                          .unit = *unit,
                          .minimum = control->minimum,
                          .maximum = control->maximum,
                          .step = std::max(control->step, 1)};
}

Result<Nanoseconds> set_exposure(int device, const ExposureRegister& control, Nanoseconds exposure) {
  BITELINE_ASSIGN(const std::int64_t steps, control.steps_for(exposure));
  BITELINE_TRY(set(device, control.id, static_cast<std::int32_t>(steps), "set exposure"));
  v4l2_control taken{.id = control.id, .value = 0};
  if (retrying_ioctl(device, VIDIOC_G_CTRL, &taken) < 0)
    return device_failure(errno, "camera", "read exposure");
  return taken.value * control.unit;
}

std::optional<GainRange> find_gain(int device) {
  std::optional<v4l2_queryctrl> control = query(device, V4L2_CID_ANALOGUE_GAIN);
  if (!control) control = query(device, V4L2_CID_GAIN);
  if (!control) return std::nullopt;
  GainRange range{.id = control->id, .minimum = control->minimum, .maximum = control->maximum};
  v4l2_control present{.id = control->id, .value = 0};
  if (retrying_ioctl(device, VIDIOC_G_CTRL, &present) == 0) range.now = present.value;
  return range;
}

Result<void> set_gain(int device, std::int32_t gain) {
  const std::optional<GainRange> control = find_gain(device);
  if (!control) return fail(Errc::NotSupported, "camera has no gain control");
  if (gain < control->minimum || gain > control->maximum) {
    return fail(Errc::BadValue, "gain %d, the camera takes %d to %d", gain, control->minimum,
                control->maximum);
  }
  return set(device, control->id, gain, "set gain");
}

void turn_automatics_off(int device) {
  // Absent controls are the normal case for raw sensors; then there is nothing to turn off.
  static_cast<void>(set(device, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "manual exposure"));
  static_cast<void>(set(device, V4L2_CID_AUTOGAIN, 0, "manual gain"));
  static_cast<void>(set(device, V4L2_CID_AUTOBRIGHTNESS, 0, "manual black level"));
  static_cast<void>(set(device, V4L2_CID_FOCUS_AUTO, 0, "manual focus"));
}

}  // namespace biteline::hal
