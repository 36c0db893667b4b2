// SPDX-License-Identifier: MIT
#include "tests/hal/video/fake_video.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstring>
#include <thread>

namespace biteline::test {
namespace {

/// By the file's number, since descriptors come and go.
std::map<std::pair<dev_t, ino_t>, FakeVideo*>& nodes() {
  static std::map<std::pair<dev_t, ino_t>, FakeVideo*> all;
  return all;
}

std::optional<std::pair<dev_t, ino_t>> identity(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return std::nullopt;
  return std::pair{status.st_dev, status.st_ino};
}

int refuse(int number) {
  errno = number;
  return -1;
}

std::uint32_t code_of(const std::string& name) {
  return v4l2_fourcc(name[0], name[1], name[2], name[3]);
}

constexpr std::size_t k_buffer_room = std::size_t{4} << 20U;

}  // namespace

FakeVideo::FakeVideo(FakeDriver wanted) : driver{std::move(wanted)} {
  path_ = folder_.write("video0", "").string();
  file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (::ftruncate(file_, 16 * k_buffer_room) != 0) std::abort();
  nodes()[*identity(file_)] = this;
  fourcc_ = code_of(driver.formats.front());
  crop_ = {.left = 0, .top = 0, .width = driver.width_px, .height = driver.height_px};
}

FakeVideo::~FakeVideo() {
  nodes().erase(*identity(file_));
  ::close(file_);
}

std::size_t FakeVideo::stride() const {
  const auto width = static_cast<std::size_t>(driver.width_px);
  const std::size_t row = fourcc_ == V4L2_PIX_FMT_Y10 || fourcc_ == V4L2_PIX_FMT_Y16 ? 2 * width : width;
  return row + driver.row_padding_bytes;
}

std::size_t FakeVideo::picture_bytes() const {
  return driver.data_offset + stride() * static_cast<std::size_t>(driver.height_px) + driver.spare_bytes;
}

int FakeVideo::answer(unsigned long request, void* argument) {
  if (const auto found = driver.failing.find(request); found != driver.failing.end())
    return refuse(found->second);
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      capability.device_caps = V4L2_CAP_STREAMING |
                               (driver.in_planes ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE) |
                               (driver.follows_pipeline ? V4L2_CAP_IO_MC : 0);
      capability.capabilities = capability.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_ENUM_FMT:
    case VIDIOC_ENUM_FRAMESIZES:
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
    case VIDIOC_TRY_FMT:
    case VIDIOC_SUBDEV_G_FMT:
      return answer_format(request, argument);
    case VIDIOC_QUERYCTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return answer_control(request, argument);
    case VIDIOC_G_SELECTION:
    case VIDIOC_S_SELECTION:
    case VIDIOC_SUBDEV_G_SELECTION:
      return answer_selection(request, argument);
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
    case VIDIOC_DQBUF:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return answer_buffer(request, argument);
    default:
      return refuse(ENOTTY);
  }
}

int FakeVideo::answer_format(unsigned long request, void* argument) {
  if (request == VIDIOC_SUBDEV_G_FMT) {
    if (driver.pad_size.first == 0) return refuse(ENOTTY);
    auto& format = static_cast<v4l2_subdev_format*>(argument)->format;
    format.width = static_cast<std::uint32_t>(driver.pad_size.first);
    format.height = static_cast<std::uint32_t>(driver.pad_size.second);
    return 0;
  }
  if (request == VIDIOC_ENUM_FMT) {
    auto& description = *static_cast<v4l2_fmtdesc*>(argument);
    const bool mine = (description.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) == driver.in_planes;
    if (!mine || description.index >= driver.formats.size()) return refuse(EINVAL);
    description.pixelformat = code_of(driver.formats[description.index]);
    return 0;
  }
  if (request == VIDIOC_ENUM_FRAMESIZES) {
    auto& listed = *static_cast<v4l2_frmsizeenum*>(argument);
    if (driver.lists_range && listed.index == 0) {
      listed.type = V4L2_FRMSIZE_TYPE_STEPWISE;
      listed.stepwise = {1, 16384, 1, 1, 16384, 1};
      return 0;
    }
    if (listed.index >= driver.sizes.size()) return refuse(driver.sizes.empty() ? ENOTTY : EINVAL);
    listed.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    listed.discrete.width = static_cast<std::uint32_t>(driver.sizes[listed.index].first);
    listed.discrete.height = static_cast<std::uint32_t>(driver.sizes[listed.index].second);
    return 0;
  }
  auto& format = *static_cast<v4l2_format*>(argument);
  if ((format.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) != driver.in_planes) return refuse(EINVAL);
  const int was_width = driver.width_px, was_height = driver.height_px;
  const std::uint32_t was_fourcc = fourcc_;
  const auto take = [&](auto& picture) {
    const std::pair<int, int> asked{static_cast<int>(picture.width), static_cast<int>(picture.height)};
    const bool known = driver.lists_range || driver.crops || driver.sizes.empty() ||
                       std::ranges::find(driver.sizes, asked) != driver.sizes.end();
    if (request != VIDIOC_G_FMT) {
      if (known) std::tie(driver.width_px, driver.height_px) = asked;
      fourcc_ = picture.pixelformat;
    }
    picture.width = static_cast<std::uint32_t>(driver.width_px);
    picture.height = static_cast<std::uint32_t>(driver.height_px);
    picture.pixelformat = fourcc_;
  };
  if (driver.in_planes) {
    auto& picture = format.fmt.pix_mp;
    take(picture);
    picture.num_planes = static_cast<std::uint8_t>(driver.planes);
    picture.plane_fmt[0].bytesperline = static_cast<std::uint32_t>(stride());
    picture.plane_fmt[0].sizeimage = static_cast<std::uint32_t>(picture_bytes());
  } else {
    take(format.fmt.pix);
    format.fmt.pix.bytesperline = static_cast<std::uint32_t>(stride());
    format.fmt.pix.sizeimage = static_cast<std::uint32_t>(picture_bytes());
  }
  if (request == VIDIOC_TRY_FMT) {
    driver.width_px = was_width;
    driver.height_px = was_height;
    fourcc_ = was_fourcc;
  }
  return 0;
}

int FakeVideo::answer_control(unsigned long request, void* argument) {
  const std::uint32_t id = *static_cast<std::uint32_t*>(argument);
  const auto found = driver.controls.find(id);
  if (found == driver.controls.end()) return refuse(EINVAL);
  if (request == VIDIOC_QUERYCTRL) {
    auto& control = *static_cast<v4l2_queryctrl*>(argument);
    control.minimum = -1000;
    control.maximum = 1000;
    control.step = 1;
    control.flags = 0;
    return 0;
  }
  auto& control = *static_cast<v4l2_control*>(argument);
  if (request == VIDIOC_G_CTRL) {
    control.value = found->second;
    return 0;
  }
  if (driver.stuck.contains(id)) return refuse(EBUSY);
  found->second = control.value;
  return 0;
}

int FakeVideo::answer_selection(unsigned long request, void* argument) {
  if (request == VIDIOC_SUBDEV_G_SELECTION) {
    if (driver.pad_crop.first == 0) return refuse(ENOTTY);
    auto& r = static_cast<v4l2_subdev_selection*>(argument)->r;
    r = {0, 0, static_cast<std::uint32_t>(driver.pad_crop.first),
         static_cast<std::uint32_t>(driver.pad_crop.second)};
    return 0;
  }
  if (!driver.crops) return refuse(ENOTTY);
  auto& selection = *static_cast<v4l2_selection*>(argument);
  if (selection.target == V4L2_SEL_TGT_CROP_DEFAULT) {
    selection.r = {0, 0, 640, 480};
    return request == VIDIOC_G_SELECTION ? 0 : refuse(EINVAL);
  }
  if (selection.target != V4L2_SEL_TGT_CROP) return refuse(EINVAL);
  if (request == VIDIOC_S_SELECTION) {
    crop_ = {selection.r.left, selection.r.top, static_cast<int>(selection.r.width),
             static_cast<int>(selection.r.height)};
    driver.width_px = crop_.width;
    driver.height_px = crop_.height;
  }
  selection.r = {crop_.left, crop_.top, static_cast<std::uint32_t>(crop_.width),
                 static_cast<std::uint32_t>(crop_.height)};
  return 0;
}

int FakeVideo::answer_buffer(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_REQBUFS: {
      auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
      wanted.count = std::min(wanted.count, 16U);
      queued_.clear();
      return 0;
    }
    case VIDIOC_STREAMON:
      sequence_ = driver.first_sequence;
      return 0;
    case VIDIOC_STREAMOFF:
      queued_.clear();
      return 0;
    default:
      break;
  }
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  if ((buffer.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) != driver.in_planes) return refuse(EINVAL);
  if (driver.in_planes && (buffer.m.planes == nullptr || buffer.length < 1)) return refuse(EINVAL);
  if (request == VIDIOC_QUERYBUF) {
    const auto length = static_cast<std::uint32_t>(picture_bytes());
    const auto offset = static_cast<std::uint32_t>(buffer.index * k_buffer_room);
    if (driver.in_planes) {
      buffer.m.planes[0].length = length;
      buffer.m.planes[0].m.mem_offset = offset;
    } else {
      buffer.length = length;
      buffer.m.offset = offset;
    }
    return 0;
  }
  if (request == VIDIOC_QBUF) {
    queued_.push_back(static_cast<int>(buffer.index));
    return 0;
  }
  std::this_thread::sleep_for(std::chrono::milliseconds{2});
  if (queued_.empty()) {
    ++sequence_;  // a frame that found no buffer
    return refuse(EAGAIN);
  }
  buffer.index = static_cast<std::uint32_t>(queued_.front());
  queued_.pop_front();
  std::uint32_t used = 0;
  fill(static_cast<int>(buffer.index), used);
  if (driver.in_planes) {
    buffer.m.planes[0].bytesused = used;
    buffer.m.planes[0].data_offset = static_cast<std::uint32_t>(driver.data_offset);
  } else {
    buffer.bytesused = used;
  }
  buffer.sequence = sequence_++;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
  buffer.timestamp = {.tv_sec = now.count() / 1'000'000, .tv_usec = now.count() % 1'000'000};
  return 0;
}

void FakeVideo::fill(int index, std::uint32_t& used) {
  const auto is_on = [&](std::uint32_t id) {
    const auto found = driver.controls.find(id);
    return found != driver.controls.end() && found->second != 0;
  };
  const bool flip_u = is_on(V4L2_CID_HFLIP), flip_v = is_on(V4L2_CID_VFLIP);
  const int left = driver.crops ? crop_.left : 0, top = driver.crops ? crop_.top : 0;
  std::vector<std::uint8_t> bytes(picture_bytes(), 0xee);
  const bool wide = fourcc_ == V4L2_PIX_FMT_Y10;
  for (int v = 0; v < driver.height_px; ++v) {
    std::uint8_t* const row = bytes.data() + driver.data_offset + static_cast<std::size_t>(v) * stride();
    for (int u = 0; u < driver.width_px; ++u) {
      const std::uint8_t value =
          grey(left + (flip_u ? driver.width_px - 1 - u : u), top + (flip_v ? driver.height_px - 1 - v : v));
      if (wide) {
        const unsigned ten = static_cast<unsigned>(value) << 2U;
        row[2 * u] = static_cast<std::uint8_t>(ten & 0xffU);
        row[2 * u + 1] = static_cast<std::uint8_t>(ten >> 8U);
      } else {
        row[u] = value;
      }
    }
  }
  if (::pwrite(file_, bytes.data(), bytes.size(),
               static_cast<off_t>(index) * static_cast<off_t>(k_buffer_room)) < 0)
    std::abort();
  used = static_cast<std::uint32_t>(bytes.size() - driver.spare_bytes - driver.short_bytes);
}

}  // namespace biteline::test

/// Before libc's: nodes of the test are answered here, all else goes on.
extern "C" int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (const auto identity = biteline::test::identity(descriptor)) {
    const auto found = biteline::test::nodes().find(*identity);
    if (found != biteline::test::nodes().end()) return found->second->answer(request, argument);
  }
  static auto* const next = reinterpret_cast<decltype(&ioctl)>(dlsym(RTLD_NEXT, "ioctl"));
  return next(descriptor, request, argument);
}
