// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/capture_node.hpp"

#include <linux/videodev2.h>

#include <array>
#include <cerrno>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {
namespace {

/// A driver that lists more repeats itself.
constexpr std::uint32_t k_most_listed = 256;

CaptureFormat plain(const v4l2_format& format, bool in_planes) {
  if (!in_planes) {
    const v4l2_pix_format& picture = format.fmt.pix;
    return {.fourcc = picture.pixelformat,
            .size = {static_cast<int>(picture.width), static_cast<int>(picture.height)},
            .stride_bytes = picture.bytesperline,
            .picture_bytes = picture.sizeimage};
  }
  const v4l2_pix_format_mplane& picture = format.fmt.pix_mp;
  return {.fourcc = picture.pixelformat,
          .size = {static_cast<int>(picture.width), static_cast<int>(picture.height)},
          .stride_bytes = picture.plane_fmt[0].bytesperline,
          .picture_bytes = picture.plane_fmt[0].sizeimage,
          .planes = picture.num_planes};
}

struct Cause {
  int sys_errno;
  Errc code;
  const char* words;
};

/// What the kernel's documentation and its drivers mean by these on a capture node.
constexpr std::array k_causes{
    Cause{EPIPE, Errc::DeviceError,
          "the formats of the media pipeline and of this node differ: look with media-ctl -p, set with "
          "media-ctl -V"},
    Cause{ENOLINK, Errc::DeviceError,
          "a link of the media pipeline is not enabled: media-ctl -p, media-ctl -l"},
    Cause{ENOSPC, Errc::DeviceError,
          "no bandwidth left on its bus: give it a USB port of its own, a lower rate or a smaller picture"},
    Cause{EBUSY, Errc::DeviceError, "another program has it: fuser -v tells which; end that one"},
    Cause{ENODEV, Errc::DeviceLost, "it is gone: check cable and power"},
    Cause{ENXIO, Errc::DeviceLost, "it is gone: check cable and power"},
    Cause{ENOMEM, Errc::DeviceError,
          "no memory for its pictures: fewer or smaller ones, or a larger cma= at boot"},
    Cause{EIO, Errc::DeviceError,
          "the sensor does not answer its driver: check the camera's cable and its overlay"},
    Cause{EREMOTEIO, Errc::DeviceError,
          "the sensor does not answer its driver: check the camera's cable and its overlay"},
    Cause{ETIMEDOUT, Errc::DeviceError,
          "the sensor does not answer its driver: check the camera's cable and its overlay"},
    Cause{EINVAL, Errc::DeviceError,
          "the driver does not take this format and size: v4l2-ctl --list-formats-ext tells those that it "
          "takes"},
};

}  // namespace

tl::unexpected<Error> capture_failure(int sys_errno, const std::string& device, const char* call) {
  for (const Cause& cause : k_causes) {
    if (cause.sys_errno == sys_errno)
      return fail_errno(cause.code, sys_errno, "%.60s: %.40s: %s", device.c_str(), call, cause.words);
  }
  return device_failure(sys_errno, device.c_str(), call);
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<char>(fourcc >> shift & 0x7fU);
    const bool plain = (letter >= '0' && letter <= '9') || (letter >= 'A' && letter <= 'Z') ||
                       (letter >= 'a' && letter <= 'z');
    if (plain) text += letter;
  }
  return text;
}

Result<CaptureNode> CaptureNode::look(int device, const std::string& name) {
  v4l2_capability capability{};
  if (retrying_ioctl(device, VIDIOC_QUERYCAP, &capability) < 0)
    return device_failure(errno, name.c_str(), "is no V4L2 device");
  const std::uint32_t abilities = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                      ? capability.device_caps
                                      : capability.capabilities;
  CaptureNode node;
  node.device_ = device;
  node.name_ = name;
  node.in_planes_ =
      (abilities & V4L2_CAP_VIDEO_CAPTURE) == 0 && (abilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  node.follows_pipeline_ = (abilities & V4L2_CAP_IO_MC) != 0;
  if ((abilities & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) == 0)
    return fail(Errc::NotSupported,
                "%.100s captures no pictures: v4l2-ctl --list-devices tells the other nodes", name.c_str());
  if ((abilities & V4L2_CAP_STREAMING) == 0)
    return fail(Errc::NotSupported, "%.100s: its driver does not stream into buffers", name.c_str());
  return node;
}

std::uint32_t CaptureNode::buffer_type() const {
  return in_planes_ ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

std::vector<std::uint32_t> CaptureNode::formats() const {
  std::vector<std::uint32_t> found;
  v4l2_fmtdesc description{};
  description.type = buffer_type();
  for (; description.index < k_most_listed; ++description.index) {
    if (retrying_ioctl(device_, VIDIOC_ENUM_FMT, &description) < 0) break;
    found.push_back(description.pixelformat);
  }
  return found;
}

Result<CaptureFormat> CaptureNode::format() const {
  v4l2_format format{};
  format.type = buffer_type();
  if (retrying_ioctl(device_, VIDIOC_G_FMT, &format) < 0) return capture_failure(errno, name_, "read format");
  return plain(format, in_planes_);
}

Result<CaptureFormat> CaptureNode::set_format(std::uint32_t fourcc, PictureSize size, bool try_only) const {
  v4l2_format format{};
  format.type = buffer_type();
  const auto fill = [&](auto& picture) {
    picture.width = static_cast<std::uint32_t>(size.width_px);
    picture.height = static_cast<std::uint32_t>(size.height_px);
    picture.pixelformat = fourcc;
    picture.field = V4L2_FIELD_NONE;
  };
  if (in_planes_) {
    fill(format.fmt.pix_mp);
    format.fmt.pix_mp.num_planes = 1;
  } else {
    fill(format.fmt.pix);
  }
  if (retrying_ioctl(device_, try_only ? VIDIOC_TRY_FMT : VIDIOC_S_FMT, &format) < 0)
    return capture_failure(errno, name_, "set format");
  return plain(format, in_planes_);
}

std::optional<PictureSize> CaptureNode::largest(std::uint32_t fourcc) const {
  std::optional<PictureSize> best;
  v4l2_frmsizeenum listed{};
  listed.pixel_format = fourcc;
  for (; listed.index < k_most_listed; ++listed.index) {
    if (retrying_ioctl(device_, VIDIOC_ENUM_FRAMESIZES, &listed) < 0) break;
    if (listed.type != V4L2_FRMSIZE_TYPE_DISCRETE) return std::nullopt;
    const PictureSize size{static_cast<int>(listed.discrete.width), static_cast<int>(listed.discrete.height)};
    const auto area = [](const PictureSize& of) { return std::int64_t{of.width_px} * of.height_px; };
    if (size.width_px > 0 && size.height_px > 0 && (!best || area(size) > area(*best))) best = size;
  }
  return best;
}

}  // namespace biteline::hal
