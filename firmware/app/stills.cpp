// SPDX-License-Identifier: MIT
#include "firmware/app/stills.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <sstream>

#include "common/config/camera_state_yaml.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::milliseconds;

/// As the scanner's: well below the laser guard's patience with this thread.
constexpr Nanoseconds k_device_wait = milliseconds{20};
/// The arm is looked at over this time.
constexpr Nanoseconds k_rest = milliseconds{300};
/// A camera that gives no picture within this is told.
constexpr Nanoseconds k_frame_patience = milliseconds{3000};
constexpr Nanoseconds k_light_patience = milliseconds{1500};
/// An exposure is sure from the next frame but two on (hal/api/line_camera.hpp).
constexpr int k_frames_to_settle = 3;
/// Shorter than the patience with a frame.
constexpr NumberRange k_exposure_us{1, 1e6};

/// A quoted text of JSON: errors have paths and words of devices in them.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "\"";
}

void answer(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

/// An object of JSON that the caller closes.
std::string rest_text(const Rest& rest) {
  const Vec3 p = rest.T_base_flange.translation();
  const Eigen::Quaterniond q{rest.T_base_flange.linear()};
  char text[400];
  std::snprintf(
      text, sizeof text,
      "{\"ok\":true,\"poses\":%d,\"pose\":[%.6f,%.6f,%.6f,%.12f,%.12f,%.12f,%.12f],\"moved_mm\":%.5f,"
      "\"moved_deg\":%.6f",
      rest.poses, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), rest.moved_mm,
      rest.moved_rad * 180 / std::numbers::pi);
  return text;
}

/// As the block of sensor.yaml, with its lines in one text of JSON.
std::string state_answer(const geometry::CameraState& state) {
  std::string text;
  for (const char c : config::camera_state_text(state, ""))
    text += c == '\n' ? std::string{"\\n"} : c == '"' ? std::string{"\\\""} : std::string{c};
  return "{\"ok\":true,\"state\":\"" + text + "\"}";
}

Result<std::string> obey(StillCamera& camera, const std::string& line, const std::atomic<bool>& stop) {
  std::istringstream words{line};
  std::string order, light, file;
  double exposure_us = 0;
  words >> order;
  if (order == "pose") return rest_text(camera.rest()) + "}";
  if (order == "state") return state_answer(camera.state());
  words >> light >> exposure_us;
  std::getline(words >> std::ws, file);
  if (order != "take" || (light != "dark" && light != "laser") || !k_exposure_us.holds(exposure_us) ||
      file.empty())
    return fail(Errc::InvalidArgument, "'pose', 'state' or 'take dark|laser US FILE' expected");
  BITELINE_ASSIGN(const Still still,
                  camera.take(Nanoseconds{std::llround(1e3 * exposure_us)}, light == "laser", stop));
  BITELINE_TRY(image::write_png(file, still.picture));
  char taken[60];
  std::snprintf(taken, sizeof taken, ",\"exposure_us\":%.3f}",
                1e-3 * static_cast<double>(still.exposure.count()));
  return rest_text(still.rest) + taken;
}

/// Lines of stdin without waiting for them.
class Orders {
 public:
  /// Nothing yet; `ended` once stdin is over.
  std::optional<std::string> next() {
    if (std::optional<std::string> line = take_line()) return line;
    pollfd waiting{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (ended || ::poll(&waiting, 1, 0) <= 0) return std::nullopt;
    std::array<char, 1024> chunk{};
    const ssize_t count = ::read(STDIN_FILENO, chunk.data(), chunk.size());
    if (count <= 0 || pending_.size() > k_longest_line) {
      ended = true;
      return std::nullopt;
    }
    pending_.append(chunk.data(), static_cast<std::size_t>(count));
    return take_line();
  }
  bool ended{false};

 private:
  static constexpr std::size_t k_longest_line = 8192;
  std::optional<std::string> take_line() {
    const std::size_t end = pending_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    return line;
  }
  std::string pending_;
};

}  // namespace

Result<std::unique_ptr<StillCamera>> StillCamera::open(const BoardDevices& devices, const hal::Clock& clock,
                                                       runtime::LaserWatch* laser, const Config& config) {
  std::unique_ptr<StillCamera> stills{new StillCamera{clock, laser}};
  BITELINE_ASSIGN(stills->camera_, devices.open_camera());
  // A new calibration is made in the usual state, not in what another program left; sensor.yaml then tells
  // it.
  BITELINE_TRY(stills->camera_->set_state(geometry::plain_state()));
  BITELINE_ASSIGN(const hal::CameraLimits limits, stills->camera_->limits());
  stills->fixed_exposure_ = limits.exposure_max == Nanoseconds{0};
  const bool triggered = devices.board().camera.hardware_trigger;
  BITELINE_ASSIGN(const hal::CameraSettings taken,
                  stills->camera_->configure(
                      {.region = {.width_px = limits.sensor_width_px, .height_px = limits.sensor_height_px},
                       .exposure = config.exposure,
                       .rate_hz = config.rate_hz,
                       .trigger = triggered ? hal::Trigger::Hardware : hal::Trigger::FreeRun}));
  stills->exposure_ = taken.exposure;
  BITELINE_ASSIGN(stills->state_, stills->camera_->state());
  BITELINE_ASSIGN(stills->trigger_, devices.open_trigger());
  if (stills->trigger_) {
    const Nanoseconds period{static_cast<std::int64_t>(1e9 / config.rate_hz)};
    BITELINE_TRY(stills->trigger_->configure({.period = period, .pulse = period / 10}));
  }
  // An arm whose poses are read by hand is none here.
  if (Result<std::unique_ptr<hal::PoseSource>> poses = devices.open_poses(); poses && (*poses)->start())
    stills->poses_ = std::move(*poses);
  BITELINE_TRY(stills->camera_->start());
  if (stills->trigger_) BITELINE_TRY(stills->trigger_->start());
  if (stills->poses_) {
    stills->pose_thread_ = std::thread{[self = stills.get(), demand = config.realtime] {
      // Without the priority poses only come later.
      (void)runtime::enter_thread(runtime::threads::k_pose, demand);
      self->read_poses();
    }};
  }
  return stills;
}

StillCamera::~StillCamera() {
  if (laser_ != nullptr) laser_->ask_for_light(false);
  stopping_ = true;
  if (pose_thread_.joinable()) pose_thread_.join();
  if (trigger_) (void)trigger_->stop();
  if (camera_) (void)camera_->stop();
  if (poses_) (void)poses_->stop();
}

void StillCamera::read_poses() {
  while (!stopping_) {
    const Result<hal::RobotPose> pose = poses_->next_pose(k_device_wait);
    if (!pose && pose.error().code != Errc::Timeout) return;
    const SensorClock::time_point now = clock_.now();
    const std::lock_guard lock{mutex_};
    if (pose) recent_.push_back({.received = now, .T_base_flange = pose->T_base_flange});
    while (!recent_.empty() && recent_.front().received < now - k_rest) recent_.pop_front();
  }
}

Rest StillCamera::rest() const {
  const std::lock_guard lock{mutex_};
  Rest rest;
  // Those of a source that gave up say nothing of now.
  if (recent_.empty() || recent_.back().received < clock_.now() - k_rest) return rest;
  rest.poses = static_cast<int>(recent_.size());
  const SE3 T_first = recent_.front().T_base_flange;
  // Within a rest all lie close to the first: the mean of the small differences is the mean.
  Twist sum = Twist::Zero();
  const auto off = [&](const SE3& T, const SE3& T_from) {
    Twist difference;
    difference.head<3>() = T.translation() - T_from.translation();
    const Eigen::AngleAxisd turn{T.linear() * T_from.linear().transpose()};
    difference.tail<3>() = turn.angle() * turn.axis();
    return difference;
  };
  for (const TimedPose& pose : recent_) sum += off(pose.T_base_flange, T_first);
  sum /= static_cast<double>(recent_.size());
  const double turn_rad = sum.tail<3>().norm();
  rest.T_base_flange = T_first;
  if (turn_rad > 0) {
    rest.T_base_flange.linear() =
        Eigen::AngleAxisd{turn_rad, sum.tail<3>() / turn_rad}.toRotationMatrix() * T_first.linear();
  }
  rest.T_base_flange.translation() += sum.head<3>();
  for (const TimedPose& pose : recent_) {
    const Twist difference = off(pose.T_base_flange, rest.T_base_flange);
    rest.moved_mm = std::max(rest.moved_mm, difference.head<3>().norm());
    rest.moved_rad = std::max(rest.moved_rad, difference.tail<3>().norm());
  }
  return rest;
}

Result<hal::FrameView> StillCamera::next_frame() {
  const SensorClock::time_point begin = clock_.now();
  for (;;) {
    const SensorClock::time_point now = clock_.now();
    if (laser_ != nullptr) {
      laser_->note_alive(now);
      laser_->note_stream(now);
    }
    Result<hal::FrameView> frame = camera_->next_frame(k_device_wait);
    if (frame && laser_ != nullptr) laser_->note_frame(clock_.now());
    if (frame || frame.error().code != Errc::Timeout || clock_.now() - begin > k_frame_patience) return frame;
  }
}

Result<void> StillCamera::idle() {
  BITELINE_ASSIGN(const hal::FrameView frame, next_frame());
  camera_->release(frame);
  return {};
}

Result<void> StillCamera::wait_for_exposure(Nanoseconds exposure) {
  if (exposure == exposure_) return {};
  const Result<Nanoseconds> taken = camera_->adjust_exposure(exposure);
  // A driver without the control exposes as it does; the answer tells it by an exposure of 0.
  if (!taken && taken.error().code == Errc::NotSupported && fixed_exposure_) return {};
  BITELINE_ASSIGN(exposure_, taken);
  // Frames that were exposed before and waited in the driver say nothing of the new one.
  const SensorClock::time_point from = clock_.now();
  for (int settled = 0; settled < k_frames_to_settle;) {
    if (clock_.now() - from > k_frame_patience + 2 * k_frames_to_settle * exposure_)
      return fail(Errc::Timeout, "camera: no picture of the new exposure came");
    BITELINE_ASSIGN(const hal::FrameView frame, next_frame());
    if (frame.exposure_mid - exposure_ / 2 >= from) ++settled;
    camera_->release(frame);
  }
  return {};
}

Result<void> StillCamera::wait_for_light() {
  laser_->ask_for_light(true);
  const SensorClock::time_point begin = clock_.now();
  while (!laser_->status().on) {
    const runtime::LaserWatch::Status status = laser_->status();
    if (status.state == runtime::LaserGuard::State::Latched || clock_.now() - begin > k_light_patience)
      return fail(Errc::InterlockOpen, "no laser light: %s", runtime::text(status.reason));
    BITELINE_TRY(idle());
  }
  return {};
}

Result<Still> StillCamera::take(Nanoseconds exposure, bool lit, const std::atomic<bool>& stop) {
  if (lit && laser_ == nullptr) return fail(Errc::NotSupported, "this board drives no laser");
  BITELINE_TRY(wait_for_exposure(exposure));
  Result<void> light;
  if (lit) light = wait_for_light();
  const SensorClock::time_point from = clock_.now();
  Still still;
  Result<void> taken = light;
  while (taken) {
    // A camera whose frames are all damaged keeps the guard content: the light has an end of its own.
    if (stop || clock_.now() - from > k_frame_patience) {
      taken = stop ? fail(Errc::WrongState, "the sensor program is told to stop")
                   : fail(Errc::Timeout, "camera: no whole picture came");
      break;
    }
    const Result<hal::FrameView> frame = next_frame();
    if (!frame) {
      taken = tl::unexpected<Error>{frame.error()};
      break;
    }
    const bool whole =
        frame->exposure_mid - exposure_ / 2 >= from && (frame->flags & hal::k_frame_damaged) == 0;
    if (whole) {
      still.picture = {.width_px = frame->width_px, .height_px = frame->height_px, .pixels = {}};
      for (int row = 0; row < frame->height_px; ++row) {
        const auto* begin = frame->pixels.data() + static_cast<std::size_t>(row) * frame->stride_bytes;
        still.picture.pixels.insert(still.picture.pixels.end(), begin, begin + frame->width_px);
      }
    }
    camera_->release(*frame);
    if (whole) break;
  }
  if (lit) {
    // The guard may have taken the light away within the exposure.
    const runtime::LaserWatch::Status status = laser_->status();
    if (taken && !status.on)
      taken = fail(Errc::InterlockOpen, "the laser went off: %s", runtime::text(status.reason));
    laser_->ask_for_light(false);
  }
  if (!taken) return tl::unexpected<Error>{taken.error()};
  still.rest = rest();
  still.exposure = fixed_exposure_ ? Nanoseconds{0} : exposure_;
  return still;
}

Result<void> serve_stills(StillCamera& camera, const std::atomic<bool>& stop) {
  Orders orders;
  while (!stop && !orders.ended) {
    BITELINE_TRY(camera.idle());
    const std::optional<std::string> order = orders.next();
    if (!order) continue;
    const Result<std::string> done = obey(camera, *order, stop);
    if (done) {
      answer(*done);
      continue;
    }
    std::string failed{"{\"ok\":false,\"error\":"};
    failed += quoted(to_line(done.error()));
    answer(failed + "}");
    if (done.error().code == Errc::DeviceLost) return tl::unexpected<Error>{done.error()};
  }
  return {};
}

}  // namespace biteline::sensor
