// SPDX-License-Identifier: MIT
#pragma once
/// \file Decides, and nothing else does, whether the laser may be on.

#include <cstdint>

#include "common/time/clocks.hpp"

namespace biteline::runtime {

/// Why the laser is off.
enum class LaserOff : std::uint8_t {
  NotAsked,       ///< no scan is on
  InterlockOpen,  ///< or unknown
  KeyOff,
  TooHot,           ///< the head is beyond its limit
  FramesStopped,    ///< the camera gives no frames: nobody would see what the laser does
  WatchdogStarved,  ///< the software that processes frames does not report
  StreamStarved,    ///< the thread that hears the hosts does not report: nobody could ask for darkness
  DriverFailed,     ///< the output did not do as told
  SafetyHung,       ///< the safety thread itself did not look in time; another thread turned the laser off
  Stopped,          ///< end of program, signal, broken contract: for good
};

[[nodiscard]] const char* text(LaserOff reason);

/// What is known at one look.
struct LaserInputs {
  SensorClock::time_point now;
  bool scan_on{false};
  bool interlock_closed{false};  ///< unknown counts as open
  bool key_on{false};
  bool too_hot{false};
  SensorClock::time_point last_frame;    ///< newest frame that was processed
  SensorClock::time_point watchdog_fed;  ///< newest sign of life of the processing
  SensorClock::time_point stream_alive;  ///< newest sign of life of the thread that hears the hosts
  bool driver_failed{false};             ///< last write or read-back of the output went wrong
  bool looks_missed{false};              ///< since the last look another thread found the looks missing
};

/// State machine.  Off by default; On only while everything in LaserInputs allows it; any fault leads to
/// Latched, and back to Off only when the scan was switched off (a person or the host has to ask again).
///
/// | state   | scan off | scan on, all well | scan on, a fault             | stop()  |
/// |---------|----------|-------------------|------------------------------|---------|
/// | Off     | Off      | On                | Off: not yet (driver, looks missed: Latched) | Stopped |
/// | On      | Off      | On                | Latched                      | Stopped |
/// | Latched | Off      | Latched           | Latched                      | Stopped |
/// | Stopped | Stopped  | Stopped           | Stopped                      | Stopped |
///
/// The camera runs before the light: frames must already flow when it comes on.
/// The limit of 100 ms from fault to darkness: 75 ms at most until a silent camera counts (one and a half
/// frames at the slowest rate in use, 20 Hz), plus two periods of the thread that looks (10 ms,
/// thread_table.hpp; one may be missed), plus the output's write. Thread: one owner (safety); pure, no clock
/// of its own.
class LaserGuard {
 public:
  struct Config {
    Nanoseconds frames_within{std::chrono::milliseconds{75}};
    Nanoseconds watchdog_within{std::chrono::milliseconds{50}};
    Nanoseconds stream_within{std::chrono::milliseconds{75}};
    /// Six looks of the safety thread in a row (laser_watch).  The frame thread notices within its 20 ms turn
    /// and a frame's 5 ms: dark after 85 ms at most.
    Nanoseconds looks_within{std::chrono::milliseconds{60}};
  };
  enum class State : std::uint8_t { Off, On, Latched, Stopped };

  explicit LaserGuard(const Config& config) : config_{config} {}

  /// True: the output shall be on until the next look.
  bool look(const LaserInputs& inputs);

  /// For good.
  void stop() {
    state_ = State::Stopped;
    reason_ = LaserOff::Stopped;
  }

  [[nodiscard]] State state() const { return state_; }
  /// Of the present darkness, or of the last one.
  [[nodiscard]] LaserOff reason() const { return reason_; }

 private:
  [[nodiscard]] bool forbidden(const LaserInputs& inputs, LaserOff& why) const;

  Config config_;
  State state_{State::Off};
  LaserOff reason_{LaserOff::NotAsked};
};

}  // namespace biteline::runtime
