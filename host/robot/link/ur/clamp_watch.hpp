// SPDX-License-Identifier: MIT
#pragma once
/// \file Since when the clamp holds the shoe, by a digital input of the controller.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::rtde {
class ClientSession;
}

namespace biteline::robot::ur {

/// Reads the standard digital input over a connection of its own, whatever the service does meanwhile.  What
/// was not seen may have been anything: a state without the input, a gap between two states by the
/// controller's own clock, and a connection that was made anew each begin the time afresh.  Thread: one of
/// its own; held_since() from any.
class ClampWatch {
 public:
  struct Config {
    std::string host{"127.0.0.1"};
    std::uint16_t rtde_port{30004};
    int input{0};  ///< standard digital input, 0 to 7: true while the clamp holds the shoe
    /// Between two states: 25 of them.  A clamp needs longer to let go of a shoe and to take another.
    Nanoseconds most_gap{200'000'000};
  };
  explicit ClampWatch(const Config& config);
  ~ClampWatch();
  ClampWatch(const ClampWatch&) = delete;
  ClampWatch& operator=(const ClampWatch&) = delete;

  /// Nothing: it is open, or nobody knows at this moment.
  [[nodiscard]] std::optional<HostClock::time_point> held_since() const;

 private:
  class Reader;
  void run();
  [[nodiscard]] Result<void> watch(rtde::ClientSession& session);
  void take(double stamp_s, std::uint64_t inputs);
  void begin_afresh();

  Config config_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<double> stamp_s_;  ///< of the newest state; by the controller's clock
  std::optional<HostClock::time_point> since_;
  HostClock::time_point heard_{};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::robot::ur
