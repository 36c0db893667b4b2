// SPDX-License-Identifier: MIT
#pragma once
/// \file Real-time priorities of threads that stand for hardware.

#include <sched.h>

namespace biteline::sim {

/// Wires and pulse generator do not wait for the sensor's processor: they are above the sensor's threads (70
/// at most), and their turns are short.  The long turns are below: the robot's, the camera's.
inline constexpr int k_wires_priority = 90, k_trigger_priority = 89, k_robot_priority = 35,
                     k_camera_priority = 30;

/// Of a thread that a real-time one has made: nothing of what it does is hardware's.
inline void be_patient() {
  const sched_param none{.sched_priority = 0};
  (void)sched_setscheduler(0, SCHED_OTHER, &none);
}

/// Threads made while it lives inherit the priority, where this process may have it; else they are as all
/// others.
class Urgently {
 public:
  explicit Urgently(int priority) : policy_before_{sched_getscheduler(0)} {
    sched_getparam(0, &before_);
    const sched_param wanted{.sched_priority = priority};
    (void)sched_setscheduler(0, SCHED_FIFO, &wanted);
  }
  ~Urgently() { (void)sched_setscheduler(0, policy_before_, &before_); }
  Urgently(const Urgently&) = delete;
  Urgently& operator=(const Urgently&) = delete;

 private:
  int policy_before_;
  sched_param before_{};
};

}  // namespace biteline::sim
