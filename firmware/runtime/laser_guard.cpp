// SPDX-License-Identifier: MIT
#include "firmware/runtime/laser_guard.hpp"

namespace biteline::runtime {

const char* text(LaserOff reason) {
  switch (reason) {
    case LaserOff::NotAsked:
      return "no scan is on";
    case LaserOff::InterlockOpen:
      return "the interlock is open";
    case LaserOff::KeyOff:
      return "the key switch is off";
    case LaserOff::TooHot:
      return "the head is too hot";
    case LaserOff::FramesStopped:
      return "the camera gives no frames";
    case LaserOff::WatchdogStarved:
      return "the frame processing hangs";
    case LaserOff::StreamStarved:
      return "the stream thread hangs";
    case LaserOff::DriverFailed:
      return "the laser's output does not do as told";
    case LaserOff::SafetyHung:
      return "the safety thread hung";
    case LaserOff::Stopped:
      return "the sensor stops";
  }
  return "for an unknown reason";
}

bool LaserGuard::forbidden(const LaserInputs& inputs, LaserOff& why) const {
  const auto found = [&](LaserOff reason) {
    why = reason;
    return true;
  };
  // First: the thread that found the looks missing has changed the output, so the driver must seem to have
  // failed.
  if (inputs.looks_missed) return found(LaserOff::SafetyHung);
  if (inputs.driver_failed) return found(LaserOff::DriverFailed);
  if (!inputs.interlock_closed) return found(LaserOff::InterlockOpen);
  if (!inputs.key_on) return found(LaserOff::KeyOff);
  if (inputs.too_hot) return found(LaserOff::TooHot);
  // Compared with an instant and not by a difference: "never" is the smallest time point there is.
  if (inputs.watchdog_fed < inputs.now - config_.watchdog_within) return found(LaserOff::WatchdogStarved);
  if (inputs.stream_alive < inputs.now - config_.stream_within) return found(LaserOff::StreamStarved);
  if (inputs.last_frame < inputs.now - config_.frames_within) return found(LaserOff::FramesStopped);
  return false;
}

bool LaserGuard::look(const LaserInputs& inputs) {
  if (state_ == State::Stopped) return false;
  if (!inputs.scan_on) {
    // A latched fault stays readable as the reason until the next scan is asked for.
    if (state_ != State::Latched) reason_ = LaserOff::NotAsked;
    state_ = State::Off;
    return false;
  }
  if (state_ == State::Latched) return false;
  LaserOff why = LaserOff::NotAsked;
  if (forbidden(inputs, why)) {
    // Before the first light an open interlock or a camera that has just started is no fault: not yet.
    if (state_ == State::On || why == LaserOff::DriverFailed || why == LaserOff::SafetyHung)
      state_ = State::Latched;
    reason_ = why;
    return false;
  }
  state_ = State::On;
  return true;
}

}  // namespace biteline::runtime
