// SPDX-License-Identifier: MIT
#include "hal/replay/replay_camera.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "common/core/contracts.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::hal::replay {
namespace {

enum class Phase { Open, Configured, Running };

/// One picture's buffer.  Its frame number is slot + k * slot count: frames take the slots in turn.
struct Slot {
  enum class State { Free, Decoding, Ready, Lent };
  State state{State::Free};
  std::optional<Error> error;
  std::vector<std::uint8_t> pixels;
};

}  // namespace

struct ReplayCamera::State {
  State(std::shared_ptr<const session::Session> recorded, int threads)
      : session{std::move(recorded)}, decode_threads{threads} {}

  std::shared_ptr<const session::Session> session;
  int decode_threads;
  Phase phase{Phase::Open};

  mutable std::mutex mutex;
  std::condition_variable changed;
  // Below: guarded by mutex (but for the pixels of a slot, which belong to whoever its state names).
  std::vector<Slot> slots;
  std::size_t next_to_decode{0};
  std::size_t next_to_give{0};
  bool stopping{false};
  std::optional<Error> failed;

  std::vector<std::thread> decoders;

  Slot& slot_of(std::size_t frame) { return slots[frame % slots.size()]; }
  std::size_t frame_count() const { return session->frames.size(); }
  int width_px() const { return session->sensor.region.width_px; }
  int height_px() const { return session->sensor.region.height_px; }
  int rows_of(const session::FrameEntry& frame) const {
    return frame.rows_px == 0 ? height_px() : frame.rows_px;
  }

  /// One decoder's life: take the next picture as soon as its slot is free.
  void decode() {
    std::unique_lock lock{mutex};
    while (true) {
      changed.wait(lock, [&] {
        return stopping || next_to_decode == frame_count() ||
               slot_of(next_to_decode).state == Slot::State::Free;
      });
      if (stopping || next_to_decode == frame_count()) return;
      const std::size_t frame = next_to_decode++;
      Slot& slot = slot_of(frame);
      slot.state = Slot::State::Decoding;
      lock.unlock();
      const Result<void> read = image::read_png_into(session->frames[frame].file, width_px(),
                                                     rows_of(session->frames[frame]), slot.pixels);
      lock.lock();
      slot.error = read ? std::optional<Error>{} : read.error();
      slot.state = Slot::State::Ready;
      changed.notify_all();
    }
  }

  void stop_decoders() {
    {
      const std::lock_guard lock{mutex};
      stopping = true;
    }
    changed.notify_all();
    for (std::thread& decoder : decoders) decoder.join();
    decoders.clear();
  }
};

Result<std::unique_ptr<ReplayCamera>> ReplayCamera::open(std::shared_ptr<const session::Session> session,
                                                         const ReplayCameraConfig& config) {
  BITELINE_EXPECTS(session != nullptr && config.buffers >= 2 && config.decode_threads >= 1);
  auto state = std::make_unique<State>(std::move(session), config.decode_threads);
  state->slots.resize(static_cast<std::size_t>(config.buffers));
  const auto size_px =
      static_cast<std::size_t>(state->width_px()) * static_cast<std::size_t>(state->height_px());
  for (Slot& slot : state->slots) slot.pixels.resize(size_px);
  return std::unique_ptr<ReplayCamera>{new ReplayCamera{std::move(state)}};
}

ReplayCamera::ReplayCamera(std::unique_ptr<State> state) : state_{std::move(state)} {}

ReplayCamera::~ReplayCamera() {
  state_->stop_decoders();
}

Result<geometry::CameraState> ReplayCamera::state() {
  return state_->session->sensor.camera_state;
}

Result<CameraLimits> ReplayCamera::limits() {
  const geometry::SensorModel& sensor = state_->session->sensor;
  const Nanoseconds exposure = sensor.exposure.value_or(Nanoseconds{0});
  // Of the full sensor a recording knows only that the region lay inside.
  return CameraLimits{.sensor_width_px = sensor.region.offset_u_px + sensor.region.width_px,
                      .sensor_height_px = sensor.region.offset_v_px + sensor.region.height_px,
                      .exposure_min = exposure,
                      .exposure_max = exposure,
                      .rate_max_hz = sensor.rate_hz.value_or(0)};
}

Result<CameraSettings> ReplayCamera::configure(const CameraSettings& wanted) {
  if (state_->phase == Phase::Running) return fail(Errc::WrongState, "recording: configure while running");
  const geometry::SensorModel& sensor = state_->session->sensor;
  const geometry::Region& region = sensor.region;
  if (wanted.region.offset_u_px != region.offset_u_px || wanted.region.offset_v_px != region.offset_v_px ||
      wanted.region.width_px != region.width_px || wanted.region.height_px != region.height_px) {
    return fail(Errc::BadValue, "%s: recorded with another region than asked for",
                state_->session->root.c_str());
  }
  if (wanted.second_exposure.count() != 0 || wanted.laser_off_frames)
    return fail(Errc::NotSupported, "%s: a recording is exposed already", state_->session->root.c_str());
  state_->phase = Phase::Configured;
  return CameraSettings{.region = region,
                        .exposure = sensor.exposure.value_or(Nanoseconds{0}),
                        .rate_hz = sensor.rate_hz.value_or(0)};
}

Result<void> ReplayCamera::start() {
  if (state_->phase != Phase::Configured) return fail(Errc::WrongState, "recording: start before configure");
  state_->next_to_decode = 0;
  state_->next_to_give = 0;
  state_->stopping = false;
  state_->failed.reset();
  for (Slot& slot : state_->slots) slot.state = Slot::State::Free;
  for (int i = 0; i < state_->decode_threads; ++i) {
    state_->decoders.emplace_back([state = state_.get()] { state->decode(); });
  }
  state_->phase = Phase::Running;
  return {};
}

Result<FrameView> ReplayCamera::next_frame(Nanoseconds timeout) {
  State& state = *state_;
  if (state.phase != Phase::Running) return fail(Errc::WrongState, "recording: next_frame before start");
  std::unique_lock lock{state.mutex};
  if (state.failed) return tl::unexpected<Error>{*state.failed};
  if (state.next_to_give == state.frame_count()) return fail(Errc::Timeout, "recording is at its end");
  const std::size_t frame = state.next_to_give;
  Slot& slot = state.slot_of(frame);
  if (!state.changed.wait_for(lock, timeout, [&] { return slot.state == Slot::State::Ready; })) {
    return fail(Errc::Timeout, "recording: no picture decoded in time");
  }
  if (slot.error) {
    state.failed = slot.error;
    return tl::unexpected<Error>{*state.failed};
  }
  slot.state = Slot::State::Lent;
  ++state.next_to_give;
  const session::FrameEntry& entry = state.session->frames[frame];
  return FrameView{.pixels = slot.pixels,
                   .width_px = state.width_px(),
                   .height_px = state.rows_of(entry),
                   .first_row_px = entry.first_row_px,
                   .stride_bytes = static_cast<std::size_t>(state.width_px()),
                   .sequence = entry.sequence,
                   .exposure_mid = entry.exposure_mid,
                   .flags = entry.flags};
}

void ReplayCamera::release(const FrameView& frame) noexcept {
  {
    // By its pixels: the camera's own count has gaps where frames were lost.
    const std::lock_guard lock{state_->mutex};
    const auto slot = std::find_if(state_->slots.begin(), state_->slots.end(),
                                   [&](const Slot& s) { return s.pixels.data() == frame.pixels.data(); });
    BITELINE_EXPECTS(slot != state_->slots.end() && slot->state == Slot::State::Lent);
    slot->state = Slot::State::Free;
  }
  state_->changed.notify_all();
}

Result<Nanoseconds> ReplayCamera::adjust_exposure(Nanoseconds) {
  if (state_->phase != Phase::Running)
    return fail(Errc::WrongState, "recording: adjust_exposure before start");
  return state_->session->sensor.exposure.value_or(Nanoseconds{0});
}

Result<void> ReplayCamera::stop() {
  state_->stop_decoders();
  if (state_->phase == Phase::Running) state_->phase = Phase::Configured;
  return {};
}

CameraHealth ReplayCamera::health() const noexcept {
  const std::lock_guard lock{state_->mutex};
  CameraHealth health;
  health.frames = state_->next_to_give;
  health.finished = state_->failed.has_value() || state_->next_to_give == state_->frame_count();
  return health;
}

}  // namespace biteline::hal::replay
