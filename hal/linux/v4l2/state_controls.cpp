// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/state_controls.hpp"

#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>

#include <array>
#include <cmath>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

using geometry::StateKey;

struct StateControl {
  StateKey key;
  std::uint32_t id;
};

/// BRIGHTNESS is the kernel's name for the black level.
constexpr std::array k_controls{
    StateControl{StateKey::MirrorX, V4L2_CID_HFLIP},
    StateControl{StateKey::MirrorY, V4L2_CID_VFLIP},
    StateControl{StateKey::Turn, V4L2_CID_ROTATE},
    StateControl{StateKey::BlackLevel, V4L2_CID_BRIGHTNESS},
    StateControl{StateKey::Zoom, V4L2_CID_ZOOM_ABSOLUTE},
    StateControl{StateKey::Pan, V4L2_CID_PAN_ABSOLUTE},
    StateControl{StateKey::Tilt, V4L2_CID_TILT_ABSOLUTE},
    StateControl{StateKey::Focus, V4L2_CID_FOCUS_ABSOLUTE},
    StateControl{StateKey::Aperture, V4L2_CID_IRIS_ABSOLUTE},
};

/// The first device that lists the control; -1: none does.
int owner_of(std::span<const int> devices, std::uint32_t id) {
  for (const int device : devices) {
    v4l2_queryctrl control{};
    control.id = id;
    if (retrying_ioctl(device, VIDIOC_QUERYCTRL, &control) == 0 &&
        (control.flags & V4L2_CTRL_FLAG_DISABLED) == 0)
      return device;
  }
  return -1;
}

/// A whole factor between what a sub-device reads from its sensor and what it gives out.
std::optional<double> factor(std::uint32_t read, std::uint32_t given) {
  if (read == 0 || given == 0 || read < given) return std::nullopt;
  return std::round(static_cast<double>(read) / given);
}

}  // namespace

void set_state_controls(std::span<const int> devices, const geometry::CameraState& wanted) {
  for (const StateControl& row : k_controls) {
    const int owner = wanted[row.key] ? owner_of(devices, row.id) : -1;
    if (owner < 0) continue;
    v4l2_control control{.id = row.id, .value = static_cast<std::int32_t>(std::lround(*wanted[row.key]))};
    static_cast<void>(retrying_ioctl(owner, VIDIOC_S_CTRL, &control));
  }
}

void read_state_controls(std::span<const int> devices, geometry::CameraState& state) {
  for (const StateControl& row : k_controls) {
    const int owner = owner_of(devices, row.id);
    v4l2_control control{.id = row.id, .value = 0};
    if (owner >= 0 && retrying_ioctl(owner, VIDIOC_G_CTRL, &control) == 0) state[row.key] = control.value;
  }
  for (const int device : devices) {
    v4l2_subdev_selection crop{};
    crop.which = V4L2_SUBDEV_FORMAT_ACTIVE;
    crop.target = V4L2_SEL_TGT_CROP;
    const PipelineSize given = pipeline_size(device);
    if (given.width_px == 0 || retrying_ioctl(device, VIDIOC_SUBDEV_G_SELECTION, &crop) < 0) continue;
    state[StateKey::BinningX] = factor(crop.r.width, static_cast<std::uint32_t>(given.width_px));
    state[StateKey::BinningY] = factor(crop.r.height, static_cast<std::uint32_t>(given.height_px));
    break;
  }
}

PipelineSize pipeline_size(int sub_device) {
  v4l2_subdev_format format{};
  format.which = V4L2_SUBDEV_FORMAT_ACTIVE;
  if (retrying_ioctl(sub_device, VIDIOC_SUBDEV_G_FMT, &format) < 0) return {};
  return {.width_px = static_cast<int>(format.format.width),
          .height_px = static_cast<int>(format.format.height)};
}

}  // namespace biteline::hal
