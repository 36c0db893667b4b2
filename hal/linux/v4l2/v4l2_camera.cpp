// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/v4l2_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace biteline::hal {
namespace {

bool has_format(int device, PixelFormat format) {
  v4l2_fmtdesc description{};
  description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  while (retrying_ioctl(device, VIDIOC_ENUM_FMT, &description) == 0) {
    if (description.pixelformat == fourcc_of(format)) return true;
    ++description.index;
  }
  return false;
}

SensorClock::time_point stamp_of(const v4l2_buffer& buffer) {
  return SensorClock::time_point{
      Nanoseconds{std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 + buffer.timestamp.tv_usec * 1000}};
}

v4l2_selection selection(std::uint32_t target) {
  v4l2_selection selection{};
  selection.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  selection.target = target;
  return selection;
}

v4l2_rect rectangle(const geometry::Region& region) {
  return {.left = region.offset_u_px,
          .top = region.offset_v_px,
          .width = static_cast<std::uint32_t>(region.width_px),
          .height = static_cast<std::uint32_t>(region.height_px)};
}

bool fits(const geometry::Region& region, int width_px, int height_px) {
  return region.offset_u_px >= 0 && region.offset_v_px >= 0 && region.width_px > 0 && region.height_px > 0 &&
         region.offset_u_px + region.width_px <= width_px &&
         region.offset_v_px + region.height_px <= height_px;
}

}  // namespace

V4l2Camera::V4l2Camera(Config config, Descriptor device, Descriptor control)
    : config_{std::move(config)}, device_{std::move(device)}, control_{std::move(control)} {}

V4l2Camera::~V4l2Camera() {
  static_cast<void>(stop());
}

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const Config& config) {
  BITELINE_ASSIGN(Descriptor device, open_device(config.device.c_str(), O_RDWR | O_NONBLOCK));
  v4l2_capability capability{};
  if (retrying_ioctl(device.number(), VIDIOC_QUERYCAP, &capability) < 0) {
    return device_failure(errno, config.device.c_str(), "is no V4L2 device");
  }
  constexpr std::uint32_t k_needed = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  if ((capability.device_caps & k_needed) != k_needed) {
    return fail(Errc::NotSupported, "%.100s: no streaming capture", config.device.c_str());
  }
  Descriptor control;
  if (!config.control_device.empty()) {
    BITELINE_ASSIGN(control, open_device(config.control_device.c_str(), O_RDWR));
  }
  std::unique_ptr<V4l2Camera> camera{new V4l2Camera{config, std::move(device), std::move(control)}};
  const auto has = [&](PixelFormat format) { return has_format(camera->device_.number(), format); };
  if (config.format) {
    if (!has(*config.format))
      return fail(Errc::NotSupported, "%.100s lacks the format asked", config.device.c_str());
    camera->format_ = *config.format;
  } else {
    const auto found = std::find_if(k_pixel_formats.begin(), k_pixel_formats.end(), has);
    if (found == k_pixel_formats.end()) {
      return fail(Errc::NotSupported, "%.100s has no grey format", config.device.c_str());
    }
    camera->format_ = *found;
  }
  BITELINE_TRY(camera->read_full_size());
  turn_automatics_off(camera->controls());
  if (config.gain) BITELINE_TRY(set_gain(camera->controls(), *config.gain));
  return camera;
}

Result<void> V4l2Camera::read_full_size() {
  v4l2_selection bounds = selection(V4L2_SEL_TGT_CROP_DEFAULT);
  if (retrying_ioctl(device_.number(), VIDIOC_G_SELECTION, &bounds) == 0 && bounds.r.width > 0) {
    sensor_width_px_ = static_cast<int>(bounds.r.width);
    sensor_height_px_ = static_cast<int>(bounds.r.height);
    return {};
  }
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (retrying_ioctl(device_.number(), VIDIOC_G_FMT, &format) < 0) {
    return device_failure(errno, config_.device.c_str(), "read format");
  }
  sensor_width_px_ = static_cast<int>(format.fmt.pix.width);
  sensor_height_px_ = static_cast<int>(format.fmt.pix.height);
  return {};
}

Result<CameraLimits> V4l2Camera::limits() {
  CameraLimits limits{.sensor_width_px = sensor_width_px_,
                      .sensor_height_px = sensor_height_px_,
                      .hardware_trigger = config_.hardware_trigger};
  exposure_control_ = find_exposure(controls(), sensor_width_px_);
  if (exposure_control_) {
    limits.exposure_min = exposure_control_->shortest();
    limits.exposure_max = exposure_control_->longest();
  }
  if (const std::optional<GainRange> gain = find_gain(controls())) {
    limits.gain_min = gain->minimum;
    limits.gain_max = gain->maximum;
    if (gain->now) limits.gain = *gain->now;
  }
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (retrying_ioctl(device_.number(), VIDIOC_G_PARM, &parameters) == 0) {
    const v4l2_fract& interval = parameters.parm.capture.timeperframe;
    if (interval.numerator > 0)
      limits.rate_max_hz = static_cast<double>(interval.denominator) / interval.numerator;
  }
  return limits;
}

Result<CameraSettings> V4l2Camera::configure(const CameraSettings& wanted) {
  if (state_ == State::Running) return fail(Errc::WrongState, "camera configured while running");
  if (!fits(wanted.region, sensor_width_px_, sensor_height_px_)) {
    return fail(Errc::BadValue, "region %d x %d at %d, %d on a sensor of %d x %d", wanted.region.width_px,
                wanted.region.height_px, wanted.region.offset_u_px, wanted.region.offset_v_px,
                sensor_width_px_, sensor_height_px_);
  }
  if (wanted.trigger == Trigger::Hardware && !config_.hardware_trigger) {
    return fail(Errc::NotSupported, "%.100s is not wired for a trigger", config_.device.c_str());
  }
  if (wanted.laser_off_frames)
    return fail(Errc::NotSupported, "V4L2 switches no strobe output: no laser-off frames");
  if (wanted.second_exposure != Nanoseconds{0}) {
    return fail(Errc::NotSupported, "V4L2 applies exposures some frames late: no bracketing");
  }

  const bool whole =
      wanted.region.width_px == sensor_width_px_ && wanted.region.height_px == sensor_height_px_;
  bool cropped = !whole && crop_in_driver(wanted.region);
  if (cropped) {
    // Some drivers take the rectangle and give it up again for the format, or scale it into one that an
    // earlier user left.
    const geometry::Region picture{.width_px = wanted.region.width_px, .height_px = wanted.region.height_px};
    cropped = set_format({.width_px = picture.width_px, .height_px = picture.height_px}).has_value();
    set_rectangle(V4L2_SEL_TGT_COMPOSE, picture);
    cropped = cropped && rectangle_is(V4L2_SEL_TGT_CROP, wanted.region) &&
              (!has(V4L2_SEL_TGT_COMPOSE) || rectangle_is(V4L2_SEL_TGT_COMPOSE, picture));
  }
  window_ = cropped ? PictureWindow{.width_px = wanted.region.width_px, .height_px = wanted.region.height_px}
                    : PictureWindow{wanted.region.offset_u_px, wanted.region.offset_v_px,
                                    wanted.region.width_px, wanted.region.height_px};
  if (!cropped) {
    // A rectangle that an earlier user left would be scaled, or fill a part of the picture, in silence.
    const geometry::Region sensor{.width_px = sensor_width_px_, .height_px = sensor_height_px_};
    set_rectangle(V4L2_SEL_TGT_CROP, sensor);
    BITELINE_TRY(set_format({.width_px = sensor_width_px_, .height_px = sensor_height_px_}));
    set_rectangle(V4L2_SEL_TGT_COMPOSE, sensor);
    for (const std::uint32_t target : {V4L2_SEL_TGT_CROP, V4L2_SEL_TGT_COMPOSE}) {
      if (has(target) && !rectangle_is(target, sensor)) {
        return fail(Errc::DeviceError, "%.100s keeps an old crop", config_.device.c_str());
      }
    }
  }
  copies_ = format_ != PixelFormat::Grey8 || window_.width_px != picture_width_px_ ||
            window_.height_px != picture_height_px_;

  settings_ = wanted;
  if (wanted.gain) {
    const auto steps = static_cast<std::int32_t>(std::lround(*wanted.gain));
    BITELINE_TRY(set_gain(controls(), steps));
    settings_.gain = steps;
  }
  settings_.rate_hz = set_rate(wanted.rate_hz);
  exposure_control_ = find_exposure(controls(), picture_width_px_);
  if (exposure_control_ && wanted.exposure > Nanoseconds{0}) {
    BITELINE_ASSIGN(settings_.exposure, set_exposure(controls(), *exposure_control_, wanted.exposure));
  } else {
    settings_.exposure = Nanoseconds{0};  // the driver cannot say it
  }
  state_ = State::Configured;
  return settings_;
}

bool V4l2Camera::crop_in_driver(const geometry::Region& region) {
  v4l2_selection crop = selection(V4L2_SEL_TGT_CROP);
  crop.r = rectangle(region);
  if (retrying_ioctl(device_.number(), VIDIOC_S_SELECTION, &crop) == 0 &&
      rectangle_is(V4L2_SEL_TGT_CROP, region))
    return true;
  return false;  // another rectangle than the one asked would move every pixel
}

bool V4l2Camera::has(std::uint32_t target) const {
  v4l2_selection found = selection(target);
  return retrying_ioctl(device_.number(), VIDIOC_G_SELECTION, &found) == 0;
}

bool V4l2Camera::rectangle_is(std::uint32_t target, const geometry::Region& region) const {
  v4l2_selection found = selection(target);
  const v4l2_rect wanted = rectangle(region);
  return retrying_ioctl(device_.number(), VIDIOC_G_SELECTION, &found) == 0 && found.r.left == wanted.left &&
         found.r.top == wanted.top && found.r.width == wanted.width && found.r.height == wanted.height;
}

void V4l2Camera::set_rectangle(std::uint32_t target, const geometry::Region& region) {
  v4l2_selection wanted = selection(target);
  wanted.r = rectangle(region);
  // Drivers without it have nothing to set.
  static_cast<void>(retrying_ioctl(device_.number(), VIDIOC_S_SELECTION, &wanted));
}

Result<void> V4l2Camera::set_format(PictureWindow size) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(size.width_px);
  format.fmt.pix.height = static_cast<std::uint32_t>(size.height_px);
  format.fmt.pix.pixelformat = fourcc_of(format_);
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (retrying_ioctl(device_.number(), VIDIOC_S_FMT, &format) < 0) {
    return device_failure(errno, config_.device.c_str(), "set format");
  }
  picture_width_px_ = static_cast<int>(format.fmt.pix.width);
  picture_height_px_ = static_cast<int>(format.fmt.pix.height);
  // A driver that scales instead of refusing would change the geometry in silence.
  if (format.fmt.pix.pixelformat != fourcc_of(format_) || picture_width_px_ != size.width_px ||
      picture_height_px_ != size.height_px) {
    return fail(Errc::BadValue, "%.60s gives %d x %d instead of %d x %d", config_.device.c_str(),
                picture_width_px_, picture_height_px_, size.width_px, size.height_px);
  }
  stride_bytes_ = std::max<std::size_t>(format.fmt.pix.bytesperline, row_bytes(format_, picture_width_px_));
  picture_bytes_ = format.fmt.pix.sizeimage;
  return {};
}

double V4l2Camera::set_rate(double rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (retrying_ioctl(device_.number(), VIDIOC_G_PARM, &parameters) < 0) return 0;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  if (rate_hz > 0) {
    interval = {.numerator = 1000, .denominator = static_cast<std::uint32_t>(std::lround(rate_hz * 1000))};
    static_cast<void>(retrying_ioctl(device_.number(), VIDIOC_S_PARM, &parameters));
  }
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0;
}

Result<void> V4l2Camera::start() {
  if (state_ != State::Configured) return fail(Errc::WrongState, "camera started before it was configured");
  BITELINE_ASSIGN(buffers_, BufferSet::create(device_.number(), {.memory = config_.memory,
                                                                 .heap = config_.heap,
                                                                 .count = config_.buffers,
                                                                 .size_bytes = picture_bytes_}));
  const auto size = static_cast<std::size_t>(window_.width_px) * static_cast<std::size_t>(window_.height_px);
  narrowed_.assign(copies_ ? buffers_.count() : 0, std::vector<std::uint8_t>(size));
  for (std::size_t i = 0; i < buffers_.count(); ++i) {
    if (buffers_.bytes(i).size() < stride_bytes_ * static_cast<std::size_t>(picture_height_px_)) {
      return fail(Errc::SizeMismatch, "%.100s: buffer smaller than its picture", config_.device.c_str());
    }
    BITELINE_TRY(buffers_.queue(i));
  }
  lent_ = 0;
  last_sequence_.reset();
  sequence_ = 0;
  for (auto* counter :
       {&counters_.frames, &counters_.frames_lost, &counters_.frames_damaged, &counters_.underruns}) {
    *counter = 0;
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (retrying_ioctl(device_.number(), VIDIOC_STREAMON, &type) < 0) {
    const int fault = errno;
    buffers_ = {};
    return device_failure(fault, config_.device.c_str(), "start streaming");
  }
  state_ = State::Running;
  return {};
}

Result<FrameView> V4l2Camera::next_frame(Nanoseconds timeout) {
  if (state_ != State::Running) return fail(Errc::WrongState, "camera is not running");
  if (!counters_.connected) return fail(Errc::DeviceLost, "%.100s", config_.device.c_str());
  const SensorClock::time_point deadline = monotonic_now() + timeout;
  while (true) {
    BITELINE_TRY(wait_readable(device_.number(), deadline - monotonic_now(), config_.device.c_str()));
    Result<v4l2_buffer> buffer = dequeue();
    if (buffer) return to_frame(*buffer);
    if (buffer.error().code != Errc::Timeout) return lost(buffer.error());
    // Readable without a buffer is an error state that poll reports at once, again and again; dequeue() tells
    // it apart from a buffer another wake-up took, which cannot happen with one owner.
    if (monotonic_now() >= deadline) return fail(Errc::Timeout, "%.100s", config_.device.c_str());
  }
}

Result<v4l2_buffer> V4l2Camera::dequeue() {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = buffers_.v4l2_memory();
  if (retrying_ioctl(device_.number(), VIDIOC_DQBUF, &buffer) == 0) return buffer;
  // EIO: the driver gave up on the stream (videobuf2: queue in error); only a new start helps.
  if (errno == EAGAIN) return fail(Errc::Timeout, "%.100s", config_.device.c_str());
  return device_failure(errno, config_.device.c_str(), "dequeue buffer");
}

tl::unexpected<Error> V4l2Camera::lost(const Error& error) {
  counters_.connected = false;
  Error told = error;
  told.code = Errc::DeviceLost;
  return tl::unexpected<Error>{told};
}

Result<FrameView> V4l2Camera::to_frame(const v4l2_buffer& buffer) {
  const std::size_t index = buffer.index;
  ++lent_;
  if (lent_ == buffers_.count()) counters_.underruns.fetch_add(1);

  FrameView frame;
  frame.width_px = window_.width_px;
  frame.height_px = window_.height_px;
  const std::uint32_t counted = last_sequence_ ? buffer.sequence - *last_sequence_ : buffer.sequence + 1;
  const std::uint32_t steps =
      std::max(counted, 1U);  // a driver that repeats a number still gave another frame
  last_sequence_ = buffer.sequence;
  if (steps != 1) {
    frame.flags |= k_frame_gap_before;
    counters_.frames_lost.fetch_add(steps - 1);
  }
  sequence_ += steps;
  frame.sequence = sequence_;

  buffers_.begin_reading(index);
  const std::span<const std::uint8_t> bytes = buffers_.bytes(index);
  bool damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.bytesused < picture_bytes_;
  if (copies_) {
    frame.pixels = narrowed_[index];
    frame.stride_bytes = static_cast<std::size_t>(window_.width_px);
    damaged |= !to_grey8({.bytes = bytes, .stride_bytes = stride_bytes_, .format = format_}, window_,
                         narrowed_[index]);
  } else {
    frame.stride_bytes = stride_bytes_;
    frame.pixels = bytes.first(stride_bytes_ * static_cast<std::size_t>(window_.height_px));
  }
  if (damaged) {
    frame.flags |= k_frame_damaged;
    counters_.frames_damaged.fetch_add(1);
  } else {
    counters_.frames.fetch_add(1);
  }
  place_in_time(buffer, frame);
  return frame;
}

void V4l2Camera::place_in_time(const v4l2_buffer& buffer, FrameView& frame) const {
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    frame.exposure_mid = monotonic_now();
    frame.flags |= k_frame_stamp_uncertain;
    return;
  }
  const Nanoseconds half_exposure = settings_.exposure / 2;
  if ((buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE) {
    frame.exposure_mid = stamp_of(buffer) + half_exposure;
    return;
  }
  frame.exposure_mid = stamp_of(buffer) - config_.readout.value_or(Nanoseconds{0}) - half_exposure;
  if (!config_.readout) frame.flags |= k_frame_stamp_uncertain;
}

void V4l2Camera::release(const FrameView& frame) noexcept {
  if (state_ != State::Running) return;  // stop() invalidated it
  for (std::size_t i = 0; i < buffers_.count(); ++i) {
    const std::uint8_t* const start = copies_ ? narrowed_[i].data() : buffers_.bytes(i).data();
    if (start != frame.pixels.data()) continue;
    buffers_.end_reading(i);
    --lent_;
    // A refusal is a camera that went away; next_frame() says so.
    static_cast<void>(buffers_.queue(i));
    return;
  }
}

Result<Nanoseconds> V4l2Camera::adjust_exposure(Nanoseconds exposure) {
  if (state_ != State::Running) return fail(Errc::WrongState, "camera is not running");
  if (!exposure_control_)
    return fail(Errc::NotSupported, "%.100s: no exposure control", config_.device.c_str());
  BITELINE_ASSIGN(settings_.exposure, set_exposure(controls(), *exposure_control_, exposure));
  return settings_.exposure;
}

Result<void> V4l2Camera::stop() {
  if (state_ != State::Running) return {};
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  // Fails when the camera is gone, and streams no more in either case.
  static_cast<void>(retrying_ioctl(device_.number(), VIDIOC_STREAMOFF, &type));
  buffers_ = {};
  lent_ = 0;
  state_ = State::Configured;
  return {};
}

CameraHealth V4l2Camera::health() const noexcept {
  return {.frames = counters_.frames.load(),
          .frames_lost = counters_.frames_lost.load(),
          .frames_damaged = counters_.frames_damaged.load(),
          .underruns = counters_.underruns.load(),
          .connected = counters_.connected.load()};
}

}  // namespace biteline::hal
