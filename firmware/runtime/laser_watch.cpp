// SPDX-License-Identifier: MIT
#include "firmware/runtime/laser_watch.hpp"

#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::runtime {
namespace {

/// What a broken contract must switch off; there is one laser in a process.
std::atomic<hal::GpioOut*> g_laser{nullptr};

void darken(const char*, const char*, int) noexcept {
  // Nothing can be done about a failure here: the process aborts next, and the kernel lets go of the line.
  if (hal::GpioOut* laser = g_laser.load()) (void)laser->set(false);
}

}  // namespace

LaserWatch::LaserWatch(std::unique_ptr<hal::GpioOut> laser, std::unique_ptr<hal::SafetyIn> safety,
                       const hal::Clock& clock, const LaserGuard::Config& config)
    : laser_{std::move(laser)},
      safety_{std::move(safety)},
      clock_{clock},
      looks_within_{config.looks_within},
      frames_within_{config.frames_within},
      guard_{config} {
  BITELINE_EXPECTS(laser_ != nullptr && safety_ != nullptr);
  g_laser = laser_.get();
  set_contract_handler(darken);
  drive(false);
}

LaserWatch::~LaserWatch() {
  stop();
  set_contract_handler(nullptr);
  g_laser = nullptr;
}

Result<void> LaserWatch::start(RealtimeDemand demand) {
  if (driver_failed_) return fail(Errc::DeviceError, "the laser's output does not do as told");
  thread_ = std::thread{[this, demand] { run(demand); }};
  start_error_.wait(-1);
  if (start_error_ == 0) return {};
  thread_.join();
  return fail(static_cast<Errc>(start_error_.load()), "thread %s (LimitRTPRIO, or --rt=ignore)",
              threads::k_safety.name);
}

void LaserWatch::stop() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
  guard_.stop();
  step();
  for (const std::unique_ptr<hal::Watchdog>& watchdog : watchdogs_) (void)watchdog->disarm();
  watchdogs_.clear();
}

void LaserWatch::run(RealtimeDemand demand) {
  const Result<void> entered = enter_thread(threads::k_safety, demand);
  start_error_ = entered ? 0 : static_cast<int>(entered.error().code);
  start_error_.notify_one();
  if (!entered) return;
  // On a fixed grid: a late look is followed by the next one at its own time, missed ones are skipped.
  auto due = std::chrono::steady_clock::now();
  while (!stopping_) {
    step();
    feed_watchdogs();
    const auto now = std::chrono::steady_clock::now();
    while (due <= now) due += threads::k_safety.period;
    std::this_thread::sleep_until(due);
  }
}

void LaserWatch::note_alive(SensorClock::time_point now) {
  store(alive_ns_, now);
  if (!may_shine_ || load(looked_ns_) >= now - looks_within_) return;
  ++misses_;  // before the line goes dark: who sees that asks for the status next
  // A failure here leaves the watchdog, which that thread does not feed either.
  (void)laser_->set(false);
}

void LaserWatch::step() {
  const std::uint64_t misses = misses_;
  const Result<hal::SafetyInputs> safety = safety_->read();
  LaserInputs inputs;
  inputs.now = clock_.now();
  inputs.scan_on = scan_on_.load(std::memory_order_acquire);
  inputs.interlock_closed = safety && safety->interlock_closed;
  inputs.key_on = safety && safety->key_on;
  inputs.too_hot = !safety || safety->too_hot;
  inputs.last_frame = load(last_frame_ns_);
  inputs.watchdog_fed = load(alive_ns_);
  inputs.stream_alive = load(stream_ns_);
  inputs.driver_failed = driver_failed_;
  inputs.looks_missed = misses != misses_published_;
  store(looked_ns_, inputs.now);
  const bool light = guard_.look(inputs);
  if (light) {
    may_shine_ = true;
    drive(true);
    // This thread stood still since it looked, and the frame thread darkened the output meanwhile: so it
    // stays, and the next look says why.
    if (misses_ != misses) drive(false);
    publish(!driver_failed_, driver_failed_ ? LaserOff::DriverFailed : guard_.reason());
  } else {
    publish(false, guard_.reason());
    drive(false);
    if (!driver_failed_) may_shine_ = false;
  }
  misses_published_ = misses;
  ++looks_;
}

void LaserWatch::publish(bool on, LaserOff reason) {
  state_ = guard_.state();
  reason_ = reason;
  on_ = on;
}

void LaserWatch::drive(bool on) {
  const Result<void> told = laser_->set(on);
  const Result<bool> level = laser_->read_back();
  driver_failed_ = !told || !level || *level != on;
  output_lost_ = driver_failed_;
}

void LaserWatch::feed_watchdogs() {
  if (driver_failed_) return;
  for (const std::unique_ptr<hal::Watchdog>& watchdog : watchdogs_) {
    if (!watchdog->feed()) feeds_failed_.fetch_add(1, std::memory_order_relaxed);
  }
}

LaserWatch::Status LaserWatch::status() const {
  // In this order: what is read first is written last.
  Status status;
  status.looks = looks_;
  const std::uint64_t misses_published = misses_published_;
  const bool missed = misses_ != misses_published;
  status.on = on_ && !missed;
  status.state = missed ? LaserGuard::State::Latched : state_.load();
  status.reason = missed ? LaserOff::SafetyHung : reason_.load();
  status.output_lost = output_lost_;
  status.feeds_failed = feeds_failed_;
  return status;
}

}  // namespace biteline::runtime
