// SPDX-License-Identifier: MIT
#pragma once
/// \file What stands round a unit of boards/qemu-virt: the arm on its bus, and the wire from the trigger to
/// the camera.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "common/geometry/se3.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "tests/hal/kernel/gpio_sim.hpp"

namespace biteline::test {

/// The arm on the bus: SYNC and one FD frame every 8 ms, moving at 250 mm/s.
class MovingArm {
 public:
  static constexpr double k_speed_mm_s = 250;
  [[nodiscard]] double x_mm(SensorClock::time_point instant) const {
    return k_speed_mm_s * std::chrono::duration<double>(instant - start_).count();
  }
  void stop() { stop_ = true; }
  ~MovingArm() {
    stop();
    thread_.join();
  }

 private:
  void run();

  SensorClock::time_point start_{hal::monotonic_now()};
  std::atomic<bool> stop_{false};
  std::thread thread_{[this] { run(); }};
};

/// The arm on the bus, at rest: the same frames, and another place at once.
class RestingArm {
 public:
  explicit RestingArm(const SE3& T_base_flange) : T_base_flange_{T_base_flange} {}
  RestingArm(const RestingArm&) = delete;
  RestingArm& operator=(const RestingArm&) = delete;
  void put(const SE3& T_base_flange) {
    const std::lock_guard lock{mutex_};
    T_base_flange_ = T_base_flange;
  }
  ~RestingArm() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run();

  std::mutex mutex_;
  SE3 T_base_flange_;  ///< guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread thread_{[this] { run(); }};
};

/// The kernel's PWM has registers and no pin, and its video driver runs by itself: while the sensor has the
/// PWM on, each frame of the driver makes an edge on the line of the strobe echo, as the pulse that asked for
/// it would.
class TriggerWire {
 public:
  explicit TriggerWire(const GpioSim& gpio) : gpio_{gpio} {}
  void on_frame();
  [[nodiscard]] std::uint64_t pulses() const { return pulses_; }

 private:
  const GpioSim& gpio_;
  std::atomic<std::uint64_t> pulses_{0};
};

}  // namespace biteline::test
