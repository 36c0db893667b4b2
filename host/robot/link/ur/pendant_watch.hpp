// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether somebody at the pendant takes the arm.

#include <atomic>
#include <functional>
#include <thread>

#include "host/robot/link/ur/controller_door.hpp"

namespace biteline::robot::ur {

/// Asks the controller on a thread of its own, whatever the service does meanwhile.  A controller that is
/// away is called again; one that was in remote control before and is in local control after it was taken,
/// too.
class PendantWatch {
 public:
  struct Config {
    DoorPlaces doors;
    Nanoseconds period{500'000'000};      ///< between two questions
    Nanoseconds patience{1'000'000'000};  ///< for connection and answer
    Nanoseconds retry{2'000'000'000};     ///< after a connection that failed
  };
  /// `taken`: on the watch's thread, once each time that remote control was on and is off.  A controller that
  /// is in local control from the beginning on was taken by nobody.
  PendantWatch(const Config& config, std::function<void()> taken);
  ~PendantWatch();
  PendantWatch(const PendantWatch&) = delete;
  PendantWatch& operator=(const PendantWatch&) = delete;

  /// Whoever follows a path asks more often.  While one of these lives the watch asks nothing; nullptr: there
  /// is no watch.
  class Rest {
   public:
    explicit Rest(PendantWatch* watch) : watch_{watch} {
      if (watch_ != nullptr) ++watch_->resting_;
    }
    ~Rest() {
      if (watch_ != nullptr) --watch_->resting_;
    }
    Rest(const Rest&) = delete;
    Rest& operator=(const Rest&) = delete;

   private:
    PendantWatch* watch_;
  };
  /// What the follower has seen: `taken` is called at once, on this thread, and not for the same deed again.
  void tell_taken();

 private:
  void run();
  [[nodiscard]] Result<void> watch(ControllerDoor& door);
  /// Two "no" in a row are one; nothing: the controller does not tell.
  [[nodiscard]] Result<std::optional<bool>> ask(ControllerDoor& door) const;
  void sleep(Nanoseconds time) const;

  Config config_;
  std::function<void()> taken_;
  std::atomic<int> resting_{0};
  std::atomic<bool> remote_{false};  ///< when it was told last
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::robot::ur
