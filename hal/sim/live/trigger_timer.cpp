// SPDX-License-Identifier: MIT
#include "hal/sim/live/trigger_timer.hpp"

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::sim {

TriggerTimer::TriggerTimer(OnEdge on_edge) : on_edge_(std::move(on_edge)), thread_([this] { run(); }) {}

TriggerTimer::~TriggerTimer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void TriggerTimer::configure(Nanoseconds period, Nanoseconds pulse) {
  {
    const std::lock_guard lock(mutex_);
    period_ = period;
    pulse_ = pulse;
    ++generation_;
  }
  changed_.notify_one();
}

void TriggerTimer::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    changed_.wait(lock, [this] { return stopping_ || period_.count() > 0; });
    const std::uint64_t generation = generation_;
    const Nanoseconds period = period_, pulse = pulse_;
    auto edge = hal::monotonic_now();
    while (!stopping_ && generation == generation_) {
      edge += period;
      const std::chrono::steady_clock::time_point wake{edge.time_since_epoch()};
      if (changed_.wait_until(lock, wake, [&] { return stopping_ || generation != generation_; })) break;
      lock.unlock();
      ++edges_;
      on_edge_(edge, pulse);
      lock.lock();
    }
  }
}

}  // namespace biteline::sim
