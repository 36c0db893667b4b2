// SPDX-License-Identifier: MIT
#include "firmware/app/scanner.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "firmware/app/live_head.hpp"
#include "firmware/runtime/busy_limit.hpp"

namespace biteline::sensor {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// How long a thread sleeps in its device before it looks whether it shall stop, and says that it lives: well
/// below the laser guard's patience with it (50 ms).
constexpr Nanoseconds k_device_wait = milliseconds{20};
/// A paused lossless source looks again so often: far less than a frame takes to process.
constexpr Nanoseconds k_pause = microseconds{200};
/// Poses are read this far beyond the profile that waits for them: twice the smoothing's reach (50 ms), and
/// at 8 kHz, beyond any controller, still a fifth of the history.
constexpr Nanoseconds k_pose_lead = milliseconds{100};
/// A live profile waits so long for poses after its exposure: the smoothing's reach plus two periods of the
/// slowest controller (8 ms) and as much for the network.
constexpr Nanoseconds k_pose_patience = geometry::PoseSmoothing{}.reach + milliseconds{16 + 10};

/// A live pose stamped later than that from now is no measurement: it would outlive all true ones in the
/// history.  The clock maps err by less than a millisecond; the rest is room for a reading thread that is
/// preempted meanwhile.
constexpr Nanoseconds k_pose_ahead_max = milliseconds{5};

constexpr std::int64_t k_never_ns = std::numeric_limits<std::int64_t>::min();

std::int64_t to_ns(SensorClock::time_point instant) {
  return instant.time_since_epoch().count();
}

}  // namespace

Result<std::unique_ptr<Scanner>> Scanner::create(Source source, const Config& config, const hal::Clock& clock,
                                                 runtime::LaserWatch* laser) {
  pipeline::ProfilePipeline::Config stages = config.pipeline;
  stages.bracketing = config.capture.second_exposure.count() != 0;
  // The laser-off frame just before is one period old, whatever the rate.
  if (config.capture.laser_off_frames && config.model.rate_hz) {
    constexpr double k_periods = 1.5;
    stages.ambient_max_age =
        std::max(stages.ambient_max_age,
                 Nanoseconds{static_cast<std::int64_t>(k_periods * 1e9 / *config.model.rate_hz)});
  }
  BITELINE_ASSIGN(pipeline::ProfilePipeline pipeline,
                  pipeline::ProfilePipeline::create(stages, config.model));
  BITELINE_ASSIGN(auto capture, CaptureControl::create(config.capture, config.model, *source.camera));
  return std::unique_ptr<Scanner>{
      new Scanner{std::move(source), config, std::move(pipeline), std::move(capture), clock, laser}};
}

Scanner::Scanner(Source source, const Config& config, pipeline::ProfilePipeline pipeline,
                 std::unique_ptr<CaptureControl> capture, const hal::Clock& clock, runtime::LaserWatch* laser)
    : source_{std::move(source)},
      config_{config},
      pipeline_{std::move(pipeline)},
      capture_{std::move(capture)},
      clock_{clock},
      laser_{laser},
      pictures_{std::make_shared<pipeline::PictureTap>(config.model.region)},
      exposure_{config.model.exposure.value_or(Nanoseconds{0})},
      poses_wanted_until_ns_{k_never_ns} {}

Scanner::~Scanner() {
  stop();
}

Result<void> Scanner::start() {
  BITELINE_TRY(source_.poses->start());
  BITELINE_TRY(source_.camera->start());
  // What runs may be another mode than what was set up.
  BITELINE_TRY(look_at_state());
  if (source_.trigger) BITELINE_TRY(source_.trigger->start());
  pose_thread_ = std::thread{[this] { read_poses(); }};
  acquisition_thread_ = std::thread{[this] { acquire(); }};
  return {};
}

Result<void> Scanner::look_at_state() {
  BITELINE_ASSIGN(const geometry::CameraState seen, source_.camera->state());
  return geometry::expect_state(config_.model.camera_state, seen);
}

void Scanner::stop() {
  stopping_ = true;
  if (acquisition_thread_.joinable()) acquisition_thread_.join();
  if (pose_thread_.joinable()) pose_thread_.join();
  // All say only that a device that is to be quiet anyway did not answer.
  if (source_.trigger) (void)source_.trigger->stop();
  (void)source_.camera->stop();
  (void)source_.poses->stop();
}

void Scanner::acquire() {
  if (const Result<void> entered = runtime::enter_thread(runtime::threads::k_acquisition, config_.realtime);
      !entered) {
    record_failure(entered.error());
  } else {
    runtime::BusyLimit busy;
    while (!stopping_) {
      // Fewer than three free: the ring may be full, and a recording is not to lose anything.
      if (config_.lossless && pool_.rt_free_count() < 3) {
        std::this_thread::sleep_for(k_pause);
        continue;
      }
      if (const Result<void> taken = take_change(); !taken) {
        record_failure(taken.error());
        break;
      }
      const SensorClock::time_point begin = clock_.now();
      if (laser_ != nullptr) laser_->note_alive(begin);
      const Result<hal::FrameView> frame = source_.camera->next_frame(k_device_wait);
      const SensorClock::time_point came = clock_.now();
      const Nanoseconds rest = config_.lossless ? Nanoseconds{0} : busy.rest_due(came, came - begin);
      if (frame) {
        wait_meter.rt_add(came - begin);
        if (const Result<void> done = process(*frame); !done) {
          record_failure(done.error());
          break;
        }
      } else if (frame.error().code != Errc::Timeout) {
        record_failure(frame.error());
        break;
      } else if (source_.camera->health().finished) {
        break;
      }
      if (rest > Nanoseconds{0}) {
        // The rest comes on top of a picture that took long: the guard's patience is for either alone.
        if (laser_ != nullptr) laser_->note_alive(clock_.now());
        std::this_thread::sleep_for(rest);
      }
    }
  }
  // Another program may have turned the picture meanwhile.
  if (!config_.lossless && !failure() && source_.camera->health().connected) {
    const Result<void> as_begun = look_at_state();
    if (!as_begun && as_begun.error().code == Errc::Refused) record_failure(as_begun.error());
  }
  // Taken, and nobody is left to ask for the rate.
  if (rate_wanted_ != nullptr) rate_wanted_->done.store(true, std::memory_order_release);
  acquisition_over_.store(true, std::memory_order_release);
}

Result<void> Scanner::process(const hal::FrameView& frame) {
  const SensorClock::time_point begin = clock_.now();
  frame_since_change_ = true;
  const std::optional<rt::BufferIndex> buffer = pool_.rt_acquire();
  BITELINE_EXPECTS(buffer.has_value());  // k_pool_profiles leaves one
  // In the dark before the laser comes on nothing is to be learned.
  const bool lit = laser_ == nullptr || laser_->status().on;
  if (lit) note_exposure(frame.exposure_mid);
  const bool made = pipeline_.rt_process(frame, pool_[*buffer]);
  // Peaks go along before the profile is out of this thread's hands, pixels when it is on its way.
  const bool pictured = made && pictures_->rt_wanted();
  if (pictured) pictures_->rt_keep_peaks(pool_[*buffer]);
  const bool copied = pictured || recording_ != nullptr;
  if (!copied) source_.camera->release(frame);
  if (!made) {  // an ambient picture, or the first half of a bracket
    pool_.rt_release(*buffer);
    if (recording_ != nullptr) {
      recording_->rt_keep_frame(frame);
      source_.camera->release(frame);
    }
    if (laser_ != nullptr) laser_->note_frame(clock_.now());
    return {};
  }
  const CaptureControl::Wish wish = lit ? capture_->rt_consider(pool_[*buffer]) : CaptureControl::Wish{};
  const SensorClock::time_point end = clock_.now();
  if (end - begin > runtime::threads::k_acquisition.budget && !config_.lossless) {
    pool_[*buffer].header.flags |= profile::k_profile_overrun;
    overruns_.fetch_add(1, std::memory_order_relaxed);
  }
  if (const std::optional<rt::BufferIndex> victim = ring_.rt_push(*buffer)) {
    pool_.rt_release(*victim);
    dropped_.fetch_add(1, std::memory_order_relaxed);
  }
  process_meter.rt_add(end - begin);
  profiles_.fetch_add(1, std::memory_order_relaxed);
  if (laser_ != nullptr) laser_->note_frame(end);
  if (copied) {
    const SensorClock::time_point copy_begin = clock_.now();
    if (pictured) pictures_->rt_keep_frame(frame);
    if (recording_ != nullptr) recording_->rt_keep_frame(frame);
    source_.camera->release(frame);
    picture_meter.rt_add(clock_.now() - copy_begin);
  }
  if (!wish.exposure && !wish.rows) return {};
  const SensorClock::time_point asked = clock_.now();
  BITELINE_TRY(capture_->apply(wish, *source_.camera));
  const SensorClock::time_point answered = clock_.now();
  adjust_meter.rt_add(answered - asked);
  // Its answer is a sign of life as good as a frame, and new rows cost it a frame or two.
  if (laser_ != nullptr) laser_->note_frame(answered);
  return {};
}

Result<void> Scanner::offer_change(Nanoseconds exposure, const stripe::PeakConfig& peaks,
                                   stripe::PeakChoice choice) {
  BITELINE_EXPECTS(change_ == nullptr);
  BITELINE_ASSIGN(auto prepared, pipeline_.prepare_peaks(peaks, choice));
  change_.reset(
      new Change{.exposure = exposure, .peaks = std::move(prepared), .outcome = Changed{}, .done = {}});
  offered_.store(change_.get(), std::memory_order_release);
  return {};
}

Result<void> Scanner::take_change() {
  ask_rate();
  Change* change = offered_.load(std::memory_order_acquire);
  if (change == nullptr) return {};
  offered_.store(nullptr, std::memory_order_relaxed);
  Result<void> camera;
  if (change->exposure.count() != 0) {
    const SensorClock::time_point asked = clock_.now();
    const Nanoseconds former = exposure_;
    Result<void> told = capture_->apply({.exposure = change->exposure, .rows = {}}, *source_.camera);
    const Nanoseconds taken = capture_->state().exposure;
    if (told && !is_as_asked(change->exposure, taken)) {
      told = fail(
          Errc::BadValue, "camera.exposure_us: what the camera takes expected, %g us instead of %g us",
          1e-3 * static_cast<double>(taken.count()), 1e-3 * static_cast<double>(change->exposure.count()));
    }
    if (told) {
      exposure_ = change->exposure;
      change->outcome = Changed{.exposure = taken, .rate_max_hz = 0};
      rate_wanted_ = change;
    } else {
      change->outcome = tl::unexpected<Error>{told.error()};
      // A camera that has no such control took nothing: there is nothing to put back.
      if (told.error().code != Errc::NotSupported)
        camera = capture_->apply({.exposure = former, .rows = {}}, *source_.camera);
    }
    const SensorClock::time_point answered = clock_.now();
    adjust_meter.rt_add(answered - asked);
    // As after a change by the automatic exposure: once for a frame.  Sets in a row are no frames, and one
    // before the first frame lights nothing.
    const bool frame_came = std::exchange(frame_since_change_, false);
    if (laser_ != nullptr && frame_came && camera) laser_->note_frame(answered);
  }
  if (change->outcome) pipeline_.rt_take_peaks(change->peaks);
  if (rate_wanted_ == nullptr) change->done.store(true, std::memory_order_release);
  return camera;
}

void Scanner::ask_rate() {
  Change* change = std::exchange(rate_wanted_, nullptr);
  if (change == nullptr) return;
  if (const Result<double> rate_hz = source_.camera->rate_max_hz()) change->outcome->rate_max_hz = *rate_hz;
  change->done.store(true, std::memory_order_release);
}

std::optional<Result<Scanner::Changed>> Scanner::change_done() {
  if (change_ == nullptr) return std::nullopt;
  // In this order: an acquisition that is over has said before whether it took the change.
  const bool over = acquisition_over_.load(std::memory_order_acquire);
  if (!change_->done.load(std::memory_order_acquire)) {
    if (!over) return std::nullopt;
    change_->outcome = fail(Errc::WrongState, "the scan ended before the settings were taken");
  }
  const Result<Changed> outcome = change_->outcome;
  change_.reset();
  return outcome;
}

void Scanner::note_exposure(SensorClock::time_point mid) {
  const std::int64_t last_ns = last_lit_ns_.exchange(to_ns(mid));
  if (last_ns != 0) longest_pause_ns_ = std::max(longest_pause_ns_.load(), to_ns(mid) - last_ns);
}

Nanoseconds Scanner::longest_pause(SensorClock::time_point until) const {
  const std::int64_t last_ns = last_lit_ns_;
  const std::int64_t open_ns = last_ns == 0 ? 0 : to_ns(until) - last_ns;
  return Nanoseconds{std::max(longest_pause_ns_.load(), open_ns)};
}

void Scanner::read_poses() {
  if (const Result<void> entered = runtime::enter_thread(runtime::threads::k_pose, config_.realtime);
      !entered) {
    record_failure(entered.error());
    poses_over_ = true;
    return;
  }
  while (!stopping_) {
    if (config_.lossless &&
        to_ns(poses_.rt_newest()) > poses_wanted_until_ns_.load(std::memory_order_relaxed)) {
      std::this_thread::sleep_for(k_pause);
      continue;
    }
    const Result<hal::RobotPose> pose = source_.poses->next_pose(k_device_wait);
    if (pose) {
      const SensorClock::time_point stamp =
          pose->stamp_sensor.value_or(to_sensor_clock(pose->stamp, config_.model.pose_clock_offset));
      const bool ahead = !config_.lossless && stamp > clock_.now() + k_pose_ahead_max;
      if (ahead) {
        rejected_poses_.fetch_add(1, std::memory_order_relaxed);
      } else {
        keep_pose(
            {.stamp = stamp, .T_base_flange = pose->T_base_flange, .encoder_ticks = pose->encoder_ticks});
      }
    } else if (pose.error().code != Errc::Timeout) {
      record_failure(pose.error());
      break;
    } else if (source_.poses->health().state == hal::PoseState::Finished) {
      break;
    }
  }
  poses_over_.store(true, std::memory_order_release);
}

void Scanner::keep_pose(const geometry::PoseSample& pose) {
  // A live pose goes the way that a recorded one goes when it is read back, recorded or not: then a replay
  // has the same numbers to the last bit.
  const Eigen::Quaterniond rotation{pose.T_base_flange.linear()};
  const Vec3 translation_mm = pose.T_base_flange.translation();
  const geometry::PoseSample kept{
      .stamp = pose.stamp,
      .T_base_flange = config_.lossless ? pose.T_base_flange : geometry::make_se3(rotation, translation_mm),
      .encoder_ticks = pose.encoder_ticks};
  if (!poses_.rt_push(kept)) {
    rejected_poses_.fetch_add(1, std::memory_order_relaxed);
  } else if (recording_ != nullptr) {
    recording_->rt_keep_pose({.stamp = pose.stamp,
                              .rotation = rotation,
                              .translation_mm = translation_mm,
                              .encoder_ticks = pose.encoder_ticks});
  }
}

const profile::ProfileBuffer* Scanner::take() {
  if (!taken_) {
    taken_ = ring_.rt_pop();
    if (!taken_) return nullptr;
    stamped_ = false;
    taken_at_ = clock_.now();
    poses_wanted_until_ns_.store(to_ns(pool_[*taken_].header.exposure_mid + k_pose_lead),
                                 std::memory_order_relaxed);
  }
  if (!stamped_) {
    if (!pose_settled()) return nullptr;
    const SensorClock::time_point begin = clock_.now();
    pipeline_.rt_stamp(pool_[*taken_], poses_);
    stamp_meter.rt_add(clock_.now() - begin);
    stamped_ = true;
  }
  return &pool_[*taken_];
}

bool Scanner::pose_settled() {
  // In this order: a pose source that is over has pushed everything before it said so.
  const bool over = poses_over_.load(std::memory_order_acquire);
  if (over || pipeline_.rt_pose_ready(pool_[*taken_], poses_)) return true;
  if (config_.lossless || clock_.now() - taken_at_ <= k_pose_patience) return false;
  ++stamped_early_;
  return true;
}

void Scanner::give_back() {
  BITELINE_EXPECTS(taken_.has_value());
  pool_.rt_release(*taken_);
  taken_.reset();
}

bool Scanner::finished() const {
  return acquisition_over_.load(std::memory_order_acquire) && !taken_ &&
         pool_.rt_free_count() == k_pool_profiles;
}

void Scanner::record_failure(const Error& error) {
  const std::lock_guard lock{failure_mutex_};
  if (!failure_) failure_ = error;
}

std::optional<Error> Scanner::failure() const {
  const std::lock_guard lock{failure_mutex_};
  return failure_;
}

profile::ScanCounts Scanner::counts() const {
  const hal::CameraHealth camera = source_.camera->health();
  const hal::PoseHealth poses = source_.poses->health();
  return {.frames = camera.frames,
          .frames_lost = camera.frames_lost,
          .frames_damaged = camera.frames_damaged,
          .poses = poses.poses,
          .poses_lost = poses.poses_lost,
          .poses_rejected = poses.poses_rejected + rejected_poses_.load(std::memory_order_relaxed),
          .profiles = profiles_.load(std::memory_order_relaxed),
          .profiles_dropped = dropped_.load(std::memory_order_relaxed),
          .overruns = overruns_.load(std::memory_order_relaxed)};
}

}  // namespace biteline::sensor
