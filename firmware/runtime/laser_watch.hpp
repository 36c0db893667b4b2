// SPDX-License-Identifier: MIT
#pragma once
/// \file The safety thread: asks the guard a hundred times a second and makes the laser's output obey.

#include <atomic>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/runtime/laser_guard.hpp"
#include "firmware/runtime/realtime.hpp"
#include "hal/api/clock.hpp"
#include "hal/api/gpio_out.hpp"
#include "hal/api/safety_in.hpp"
#include "hal/api/watchdog.hpp"

namespace biteline::runtime {

/// Owns the laser's output.  Off before start(), after stop(), when the object goes, and on a broken contract
/// anywhere in the process; when the process dies the kernel lets go of the line, whose pull is off
/// (hal/api/gpio_out.hpp). Thread: note_* and ask_* from any thread; start() and stop() from one.
class LaserWatch {
 public:
  LaserWatch(std::unique_ptr<hal::GpioOut> laser, std::unique_ptr<hal::SafetyIn> safety,
             const hal::Clock& clock, const LaserGuard::Config& config);
  LaserWatch(const LaserWatch&) = delete;
  LaserWatch& operator=(const LaserWatch&) = delete;
  ~LaserWatch();

  /// An armed watchdog, fed at every look from start() on and disarmed by stop(): what it does when this
  /// thread hangs or the process dies darkens the laser too, and so it is not fed while the output does not
  /// do as told.  Before start() only.
  void feed(std::unique_ptr<hal::Watchdog> watchdog) { watchdogs_.push_back(std::move(watchdog)); }

  [[nodiscard]] Result<void> start(RealtimeDemand demand);
  /// Dark for good.
  void stop();

  /// A scan wants light, or no longer does.  Frames of the scan before do not count for the next.
  void ask_for_light(bool scan_on) {
    if (scan_on) store(last_frame_ns_, SensorClock::time_point::min());
    scan_on_.store(scan_on, std::memory_order_release);
  }
  void note_frame(SensorClock::time_point processed) { store(last_frame_ns_, processed); }
  /// The thread that hears the hosts lives.
  void note_stream(SensorClock::time_point now) { store(stream_ns_, now); }
  /// The frame thread lives.  It looks after this one in turn: when the looks of the safety thread stay out
  /// while the laser is on, it turns the laser off itself.
  void note_alive(SensorClock::time_point now);

  /// So long a camera may be silent.
  [[nodiscard]] Nanoseconds frames_within() const { return frames_within_; }

  struct Status {
    /// Never while the line is dark: said before it goes dark, whoever darkens it.
    bool on{false};
    LaserGuard::State state{LaserGuard::State::Off};
    LaserOff reason{LaserOff::NotAsked};
    bool output_lost{false};        ///< the output could not be told or read back: its level is unknown
    std::uint64_t feeds_failed{0};  ///< a watchdog did not take its food: it will bite
    /// Finished looks so far.  Two more than at some moment: the second began after it and saw what was so
    /// then.
    std::uint64_t looks{0};
  };
  [[nodiscard]] Status status() const;

  /// One look; the thread's own step, and the tests'.
  void step();

 private:
  static void store(std::atomic<std::int64_t>& where, SensorClock::time_point instant) {
    where.store(instant.time_since_epoch().count(), std::memory_order_relaxed);
  }
  static SensorClock::time_point load(const std::atomic<std::int64_t>& from) {
    return SensorClock::time_point{Nanoseconds{from.load(std::memory_order_relaxed)}};
  }
  void run(RealtimeDemand demand);
  void drive(bool on);
  void publish(bool on, LaserOff reason);
  void feed_watchdogs();

  std::unique_ptr<hal::GpioOut> laser_;
  std::unique_ptr<hal::SafetyIn> safety_;
  const hal::Clock& clock_;
  Nanoseconds looks_within_, frames_within_;
  LaserGuard guard_;
  std::vector<std::unique_ptr<hal::Watchdog>> watchdogs_;
  std::thread thread_;
  bool driver_failed_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> scan_on_{false};
  std::atomic<std::int64_t> last_frame_ns_{SensorClock::time_point::min().time_since_epoch().count()};
  std::atomic<std::int64_t> stream_ns_{SensorClock::time_point::min().time_since_epoch().count()};
  std::atomic<std::int64_t> alive_ns_{SensorClock::time_point::min().time_since_epoch().count()};
  std::atomic<bool> may_shine_{
      false};  ///< from before the output is told to shine until it is known to be dark
  // Published for the others.
  std::atomic<bool> on_{false};
  std::atomic<LaserGuard::State> state_{LaserGuard::State::Off};
  std::atomic<LaserOff> reason_{LaserOff::NotAsked};
  std::atomic<bool> output_lost_{false};
  std::atomic<std::uint64_t> feeds_failed_{0};
  std::atomic<std::int64_t> looked_ns_{SensorClock::time_point::min().time_since_epoch().count()};
  std::atomic<std::uint64_t> looks_{0};
  // How often the frame thread darkened the output for want of looks, and how much of that is in the
  // published status.  They differ: the status is older than the darkness.
  std::atomic<std::uint64_t> misses_{0}, misses_published_{0};
  std::atomic<int> start_error_{-1};
};

}  // namespace biteline::runtime
