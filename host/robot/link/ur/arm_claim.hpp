// SPDX-License-Identifier: MIT
#pragma once
/// \file One service at a time holds an arm, also where services run on several machines: the controller
/// itself sees to it.

#include <atomic>
#include <condition_variable>
#include <memory>
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

/// A controller gives an RTDE input to one client and answers IN_USE to all others (RTDE guide, control
/// package setup inputs).  This keeps an integer register for as long as it lives, and writes to it only what
/// beat() counts: a program of this service that looks at it ends where the count stands still (script.hpp).
/// What a dead holder had is free once the controller finds its connection closed.
///
/// Thread: one of its own that comes back after a lost connection; state() from any.
class ArmClaim {
 public:
  struct Config {
    std::string host{"127.0.0.1"};
    std::uint16_t rtde_port{30004};
    int input_register{47};  ///< input_int_register_N; 24 to 47 are for RTDE clients
    double patience_s{3};    ///< for a first verdict, and for a predecessor's connection to be found closed
  };
  enum class State {
    Away,    ///< no connection: not known
    Held,    ///< by this
    Taken,   ///< by another client
    Lacking  ///< a controller without such registers (before 3.9): nobody can hold it so
  };

  /// Errc::PeerRefused: another client has held it all the time.  A controller that is away is asked on and
  /// on.
  [[nodiscard]] static Result<std::unique_ptr<ArmClaim>> take(const Config& config);
  ~ArmClaim();
  ArmClaim(const ArmClaim&) = delete;
  ArmClaim& operator=(const ArmClaim&) = delete;

  [[nodiscard]] State state() const { return state_; }
  /// Nobody else can hold it as this does.
  [[nodiscard]] bool safe() const { return state_ == State::Held || state_ == State::Lacking; }

  /// Somebody watches the arm: the count goes up, and is written within k_write.  Never waits.
  void beat() { ++beats_; }
  /// That is counted up; nothing while it is not held.
  [[nodiscard]] std::optional<int> beat_register() const {
    return state_ == State::Held ? std::optional{config_.input_register} : std::nullopt;
  }
  static constexpr Nanoseconds k_write{20'000'000};

 private:
  explicit ArmClaim(const Config& config) : config_{config} {}
  void run();
  [[nodiscard]] Result<void> keep(rtde::ClientSession& session);
  void set(State state);

  Config config_;
  std::atomic<State> state_{State::Away};
  std::atomic<std::uint32_t> beats_{0};
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace biteline::robot::ur
