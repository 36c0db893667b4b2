// SPDX-License-Identifier: MIT
#include "tests/hal/kernel/vivid.hpp"

#include <CppUTest/TestHarness.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <cstring>
#include <filesystem>

namespace biteline::test {
namespace {

using hal::Descriptor;
using hal::retrying_ioctl;

Descriptor open_node(const std::string& path) {
  return hal::open_device(path.c_str(), O_RDWR | O_NONBLOCK).value();
}

void set_timings(const std::string& node, int width_px, int height_px) {
  const Descriptor device = open_node(node);
  v4l2_enum_dv_timings listed{};
  while (retrying_ioctl(device.number(), VIDIOC_ENUM_DV_TIMINGS, &listed) == 0) {
    v4l2_dv_timings timings = listed.timings;
    if (static_cast<int>(timings.bt.width) == width_px && static_cast<int>(timings.bt.height) == height_px &&
        timings.bt.interlaced == V4L2_DV_PROGRESSIVE) {
      if (retrying_ioctl(device.number(), VIDIOC_S_DV_TIMINGS, &timings) == 0) return;
    }
    ++listed.index;
  }
  FAIL("vivid takes no such timings");
}

}  // namespace

std::optional<VividNodes> find_vivid() {
  VividNodes nodes;
  for (int i = 0; i < 8; ++i) {
    const std::string path = "/dev/video" + std::to_string(i);
    if (!std::filesystem::exists(path)) continue;
    const Descriptor device = open_node(path);
    v4l2_capability capability{};
    if (retrying_ioctl(device.number(), VIDIOC_QUERYCAP, &capability) < 0) continue;
    if (std::strcmp(reinterpret_cast<const char*>(capability.driver), "vivid") != 0) continue;
    if ((capability.device_caps & V4L2_CAP_VIDEO_CAPTURE) != 0) nodes.capture = path;
    if ((capability.device_caps & V4L2_CAP_VIDEO_OUTPUT) != 0) nodes.output = path;
  }
  if (nodes.capture.empty() || nodes.output.empty()) return std::nullopt;
  return nodes;
}

bool set_control(const std::string& node, const std::string& name, int value) {
  const Descriptor device = open_node(node);
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (retrying_ioctl(device.number(), VIDIOC_QUERYCTRL, &query) == 0) {
    if (name == reinterpret_cast<const char*>(query.name)) {
      v4l2_control control{.id = query.id, .value = value};
      return retrying_ioctl(device.number(), VIDIOC_S_CTRL, &control) == 0;
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return false;
}

void loop_vivid(const VividNodes& nodes, int width_px, int height_px) {
  set_timings(nodes.capture, width_px, height_px);
  set_timings(nodes.output, width_px, height_px);
  CHECK(set_control(nodes.capture, "OSD Text Mode", 2));  // none
  CHECK(set_control(nodes.capture, "Timestamp Source",
                    1));  // start of exposure; the other one lies in the future
  CHECK(set_control(nodes.capture, "Loop Video", 1));
  static_cast<void>(set_control(nodes.capture, "Percentage of Dropped Buffers", 0));
}

PictureFeeder::PictureFeeder(const VividNodes& nodes, int width_px, int height_px, Painter painter,
                             std::function<void()> on_frame)
    : device_{open_node(nodes.output)}, painter_{std::move(painter)}, on_frame_{std::move(on_frame)} {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = static_cast<std::uint32_t>(width_px);
  format.fmt.pix.height = static_cast<std::uint32_t>(height_px);
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  CHECK_EQUAL(0, retrying_ioctl(device_.number(), VIDIOC_S_FMT, &format));
  CHECK_EQUAL(width_px, static_cast<int>(format.fmt.pix.width));
  v4l2_requestbuffers wanted{};
  wanted.count = 4;
  wanted.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  wanted.memory = V4L2_MEMORY_MMAP;
  CHECK_EQUAL(0, retrying_ioctl(device_.number(), VIDIOC_REQBUFS, &wanted));
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    v4l2_buffer buffer{};
    buffer.index = i;
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    CHECK_EQUAL(0, retrying_ioctl(device_.number(), VIDIOC_QUERYBUF, &buffer));
    void* const address =
        ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, device_.number(), buffer.m.offset);
    CHECK(address != MAP_FAILED);
    buffers_.push_back(std::span{static_cast<std::uint8_t*>(address), format.fmt.pix.sizeimage});
    queue(i);
  }
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  CHECK_EQUAL(0, retrying_ioctl(device_.number(), VIDIOC_STREAMON, &type));
  thread_ = std::jthread{[this] { run(); }};
}

PictureFeeder::~PictureFeeder() {
  stop_ = true;
  thread_.join();
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  retrying_ioctl(device_.number(), VIDIOC_STREAMOFF, &type);
  for (const std::span<std::uint8_t> buffer : buffers_) ::munmap(buffer.data(), buffer.size());
}

void PictureFeeder::queue(std::uint32_t index) {
  painter_(next_number_++, buffers_[index]);
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.bytesused = static_cast<std::uint32_t>(buffers_[index].size());
  buffer.field = V4L2_FIELD_NONE;
  retrying_ioctl(device_.number(), VIDIOC_QBUF, &buffer);
}

void PictureFeeder::run() {
  constexpr int k_wait_ms = 20;
  while (!stop_) {
    pollfd shown{.fd = device_.number(), .events = POLLOUT, .revents = 0};
    if (::poll(&shown, 1, k_wait_ms) <= 0) continue;
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (retrying_ioctl(device_.number(), VIDIOC_DQBUF, &buffer) == 0) {
      on_frame_();
      queue(buffer.index);
    } else {
      std::this_thread::sleep_for(
          std::chrono::milliseconds{2});  // poll also wakes for a stream that is in error
    }
  }
}

}  // namespace biteline::test
