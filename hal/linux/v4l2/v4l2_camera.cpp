// SPDX-License-Identifier: MIT
#include "hal/linux/v4l2/v4l2_camera.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "hal/linux/v4l2/state_controls.hpp"

namespace biteline::hal {
namespace {

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

/// A node that is busy names who has it as start-up does later.
Result<Descriptor> open_camera_device(const std::string& path, int flags) {
  Result<Descriptor> opened = open_device(path.c_str(), flags);
  if (!opened && opened.error().sys_errno == EBUSY) return capture_failure(EBUSY, path, "open");
  return opened;
}

std::int64_t area(const PictureSize& size) {
  return std::int64_t{size.width_px} * size.height_px;
}

v4l2_rect rectangle(const geometry::Region& region) {
  return {.left = region.offset_u_px,
          .top = region.offset_v_px,
          .width = static_cast<std::uint32_t>(region.width_px),
          .height = static_cast<std::uint32_t>(region.height_px)};
}

bool fits(const geometry::Region& region, const PictureSize& picture) {
  return region.offset_u_px >= 0 && region.offset_v_px >= 0 && region.width_px > 0 && region.height_px > 0 &&
         region.offset_u_px + region.width_px <= picture.width_px &&
         region.offset_v_px + region.height_px <= picture.height_px;
}

}  // namespace

V4l2Camera::V4l2Camera(Config config, Descriptor device, Descriptor control)
    : config_{std::move(config)}, device_{std::move(device)}, control_{std::move(control)} {}

V4l2Camera::~V4l2Camera() {
  static_cast<void>(stop());
}

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const Config& config) {
  BITELINE_ASSIGN(Descriptor device, open_camera_device(config.device, O_RDWR | O_NONBLOCK));
  BITELINE_ASSIGN(CaptureNode node, CaptureNode::look(device.number(), config.device));
  Descriptor control;
  if (!config.control_device.empty()) {
    BITELINE_ASSIGN(control, open_camera_device(config.control_device, O_RDWR));
  }
  std::unique_ptr<V4l2Camera> camera{new V4l2Camera{config, std::move(device), std::move(control)}};
  camera->node_ = std::move(node);
  BITELINE_TRY(camera->choose_format());
  BITELINE_TRY(camera->read_full_size());
  for (const int each : camera->control_devices()) turn_automatics_off(each);
  if (config.gain) BITELINE_TRY(set_gain(camera->controls(), *config.gain));
  return camera;
}

std::vector<int> V4l2Camera::control_devices() const {
  if (control_.is_open()) return {control_.number(), device_.number()};
  return {device_.number()};
}

Result<void> V4l2Camera::choose_format() {
  const std::vector<std::uint32_t> listed = node_.formats();
  const auto has = [&](PixelFormat format) {
    return std::find(listed.begin(), listed.end(), fourcc_of(format)) != listed.end();
  };
  const auto found = config_.format ? (has(*config_.format) ? &*config_.format : nullptr)
                                    : std::find_if(k_pixel_formats.begin(), k_pixel_formats.end(), has);
  if (found != nullptr && found != k_pixel_formats.end()) {
    format_ = *found;
    return {};
  }
  std::string names;
  for (const std::uint32_t each : listed)
    if (names.size() < 80) names += (names.empty() ? "" : ", ") + fourcc_text(each);
  return fail(
      Errc::NotSupported, "%.60s gives %s: %s expected (a monochrome sensor, one plane)",
      config_.device.c_str(), names.empty() ? "no format" : names.c_str(),
      config_.format ? fourcc_text(fourcc_of(*config_.format)).c_str() : "GREY, Y10P, Y12P, Y10, Y12 or Y16");
}

Result<void> V4l2Camera::read_full_size() {
  v4l2_selection bounds = selection(V4L2_SEL_TGT_CROP_DEFAULT);
  if (retrying_ioctl(device_.number(), VIDIOC_G_SELECTION, &bounds) == 0 && bounds.r.width > 0) {
    full_ = {static_cast<int>(bounds.r.width), static_cast<int>(bounds.r.height)};
    return {};
  }
  if (node_.follows_pipeline() && control_.is_open()) {
    // A bridge takes what its pipeline gives; its own sizes are those of its memory.
    const PipelineSize given = pipeline_size(control_.number());
    if (given.width_px > 0) {
      full_ = {given.width_px, given.height_px};
      return {};
    }
  }
  BITELINE_ASSIGN(const CaptureFormat now, node_.format());
  full_ = now.size;
  if (!node_.follows_pipeline()) largest_ = node_.largest(fourcc_of(format_));
  return {};
}

Result<geometry::CameraState> V4l2Camera::set_state(const geometry::CameraState& wanted) {
  if (state_ == State::Running) return fail(Errc::WrongState, "camera set while running");
  set_state_controls(control_devices(), wanted);
  adopt_size(wanted);
  return state();
}

void V4l2Camera::adopt_size(const geometry::CameraState& wanted) {
  const std::optional<double>&width_px = wanted[geometry::StateKey::SensorWidth],
        &height_px = wanted[geometry::StateKey::SensorHeight];
  if (!width_px || !height_px || has(V4L2_SEL_TGT_CROP_DEFAULT)) return;
  const PictureSize told{static_cast<int>(*width_px), static_cast<int>(*height_px)};
  largest_.reset();
  if (told == full_) return;
  const Result<CaptureFormat> taken = node_.set_format(fourcc_of(format_), told, true);
  if (taken && taken->size == told) full_ = told;
}

Result<geometry::CameraState> V4l2Camera::state() {
  geometry::CameraState state;
  read_state_controls(control_devices(), state);
  state[geometry::StateKey::SensorWidth] = full_.width_px;
  state[geometry::StateKey::SensorHeight] = full_.height_px;
  state.pixel_format = fourcc_text(fourcc_of(format_));
  return state;
}

Result<CameraLimits> V4l2Camera::limits() {
  const PictureSize whole = largest_ && area(*largest_) > area(full_) ? *largest_ : full_;
  CameraLimits limits{.sensor_width_px = whole.width_px,
                      .sensor_height_px = whole.height_px,
                      .hardware_trigger = config_.hardware_trigger};
  exposure_control_ = find_exposure(controls(), full_.width_px);
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
  parameters.type = node_.buffer_type();
  if (retrying_ioctl(device_.number(), VIDIOC_G_PARM, &parameters) == 0) {
    const v4l2_fract& interval = parameters.parm.capture.timeperframe;
    if (interval.numerator > 0)
      limits.rate_max_hz = static_cast<double>(interval.denominator) / interval.numerator;
  }
  return limits;
}

Result<CameraSettings> V4l2Camera::configure(const CameraSettings& wanted) {
  if (state_ == State::Running) return fail(Errc::WrongState, "camera configured while running");
  if (!fits(wanted.region, full_) && largest_ && fits(wanted.region, *largest_)) full_ = *largest_;
  if (!fits(wanted.region, full_)) {
    return fail(Errc::BadValue, "region %d x %d at %d, %d on a sensor of %d x %d", wanted.region.width_px,
                wanted.region.height_px, wanted.region.offset_u_px, wanted.region.offset_v_px, full_.width_px,
                full_.height_px);
  }
  if (wanted.trigger == Trigger::Hardware && !config_.hardware_trigger) {
    return fail(Errc::NotSupported, "%.100s is not wired for a trigger", config_.device.c_str());
  }
  if (wanted.laser_off_frames)
    return fail(Errc::NotSupported, "V4L2 switches no strobe output: no laser-off frames");
  if (wanted.second_exposure != Nanoseconds{0}) {
    return fail(Errc::NotSupported, "V4L2 applies exposures some frames late: no bracketing");
  }

  const bool whole = wanted.region.width_px == full_.width_px && wanted.region.height_px == full_.height_px;
  bool cropped = !whole && crop_in_driver(wanted.region);
  if (cropped) {
    // Some drivers take the rectangle and give it up again for the format, or scale it into one that an
    // earlier user left.
    const geometry::Region picture{.width_px = wanted.region.width_px, .height_px = wanted.region.height_px};
    cropped = set_format({picture.width_px, picture.height_px}).has_value();
    set_rectangle(V4L2_SEL_TGT_COMPOSE, picture);
    cropped = cropped && rectangle_is(V4L2_SEL_TGT_CROP, wanted.region) &&
              (!has(V4L2_SEL_TGT_COMPOSE) || rectangle_is(V4L2_SEL_TGT_COMPOSE, picture));
  }
  window_ = cropped ? PictureWindow{.width_px = wanted.region.width_px, .height_px = wanted.region.height_px}
                    : PictureWindow{wanted.region.offset_u_px, wanted.region.offset_v_px,
                                    wanted.region.width_px, wanted.region.height_px};
  if (!cropped) {
    // A rectangle that an earlier user left would be scaled, or fill a part of the picture, in silence.
    const geometry::Region sensor{.width_px = full_.width_px, .height_px = full_.height_px};
    set_rectangle(V4L2_SEL_TGT_CROP, sensor);
    BITELINE_TRY(set_format(full_));
    set_rectangle(V4L2_SEL_TGT_COMPOSE, sensor);
    for (const std::uint32_t target : {V4L2_SEL_TGT_CROP, V4L2_SEL_TGT_COMPOSE}) {
      if (has(target) && !rectangle_is(target, sensor)) {
        return fail(Errc::DeviceError, "%.100s keeps an old crop", config_.device.c_str());
      }
    }
  }
  copies_ = format_ != PixelFormat::Grey8 || window_.width_px != picture_.width_px ||
            window_.height_px != picture_.height_px ||
            picture_bytes_ < stride_bytes_ * static_cast<std::size_t>(picture_.height_px);

  settings_ = wanted;
  if (wanted.gain) {
    const auto steps = static_cast<std::int32_t>(std::lround(*wanted.gain));
    BITELINE_TRY(set_gain(controls(), steps));
    settings_.gain = steps;
  }
  settings_.rate_hz = set_rate(wanted.rate_hz);
  exposure_control_ = find_exposure(controls(), picture_.width_px);
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

Result<void> V4l2Camera::set_format(PictureSize size) {
  BITELINE_ASSIGN(const CaptureFormat taken, node_.set_format(fourcc_of(format_), size));
  picture_ = taken.size;
  if (taken.planes != 1) {
    return fail(Errc::NotSupported, "%.60s gives its pictures in %d planes: one expected",
                config_.device.c_str(), taken.planes);
  }
  // A driver that scales instead of refusing would change the geometry in silence.
  if (taken.fourcc != fourcc_of(format_) || picture_ != size) {
    return fail(Errc::BadValue, "%.60s gives %d x %d %s instead of %d x %d %s", config_.device.c_str(),
                picture_.width_px, picture_.height_px, fourcc_text(taken.fourcc).c_str(), size.width_px,
                size.height_px, fourcc_text(fourcc_of(format_)).c_str());
  }
  const std::size_t row = row_bytes(format_, picture_.width_px);
  stride_bytes_ = std::max(taken.stride_bytes, row);
  filled_bytes_ = stride_bytes_ * static_cast<std::size_t>(picture_.height_px - 1) + row;
  picture_bytes_ = std::max(taken.picture_bytes, filled_bytes_);
  return {};
}

double V4l2Camera::set_rate(double rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = node_.buffer_type();
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
  BITELINE_ASSIGN(buffers_, BufferSet::create(node_, {.memory = config_.memory,
                                                      .heap = config_.heap,
                                                      .count = config_.buffers,
                                                      .size_bytes = picture_bytes_}));
  const auto size = static_cast<std::size_t>(window_.width_px) * static_cast<std::size_t>(window_.height_px);
  narrowed_.assign(copies_ ? buffers_.count() : 0, std::vector<std::uint8_t>(size));
  for (std::size_t i = 0; i < buffers_.count(); ++i) {
    if (buffers_.bytes(i).size() < picture_bytes_) {
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
  std::uint32_t type = node_.buffer_type();
  if (retrying_ioctl(device_.number(), VIDIOC_STREAMON, &type) < 0) {
    const int fault = errno;
    buffers_ = {};
    return capture_failure(fault, config_.device, "start streaming");
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
    std::size_t begin_bytes = 0;
    const Result<v4l2_buffer> buffer = buffers_.dequeue(begin_bytes);
    if (buffer) return to_frame(*buffer, begin_bytes);
    if (buffer.error().code != Errc::Timeout) return lost(buffer.error());
    // Readable without a buffer is an error state that poll reports at once, again and again; dequeue() tells
    // it apart from a buffer another wake-up took, which cannot happen with one owner.
    if (monotonic_now() >= deadline) return fail(Errc::Timeout, "%.100s", config_.device.c_str());
  }
}

tl::unexpected<Error> V4l2Camera::lost(const Error& error) {
  counters_.connected = false;
  Error told = error;
  told.code = Errc::DeviceLost;
  return tl::unexpected<Error>{told};
}

Result<FrameView> V4l2Camera::to_frame(const v4l2_buffer& buffer, std::size_t begin_bytes) {
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
  const std::span<const std::uint8_t> bytes = buffers_.bytes(index).subspan(begin_bytes);
  bool damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.bytesused < filled_bytes_ ||
                 bytes.size() < filled_bytes_;
  if (copies_) {
    frame.pixels = narrowed_[index];
    frame.stride_bytes = static_cast<std::size_t>(window_.width_px);
    damaged |= !to_grey8({.bytes = bytes, .stride_bytes = stride_bytes_, .format = format_}, window_,
                         narrowed_[index]);
  } else {
    frame.stride_bytes = stride_bytes_;
    const std::size_t lent_bytes = stride_bytes_ * static_cast<std::size_t>(window_.height_px);
    damaged |= bytes.size() < lent_bytes;
    frame.pixels = (damaged ? buffers_.bytes(index) : bytes).first(lent_bytes);
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
    const std::span<const std::uint8_t> whole =
        copies_ ? std::span{std::as_const(narrowed_[i])} : buffers_.bytes(i);
    if (frame.pixels.data() < whole.data() || frame.pixels.data() >= whole.data() + whole.size()) continue;
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
  std::uint32_t type = node_.buffer_type();
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
