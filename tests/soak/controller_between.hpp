// SPDX-License-Identifier: MIT
#pragma once
/// \file Between the host service and the simulated controller: hears every script, and makes the wire lie.

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/rtde/data.hpp"
#include "common/rtde/messages.hpp"
#include "hal/linux/posix/descriptor.hpp"
#include "hal/sim/robot/tcp.hpp"
#include "hal/sim/robot/ur_controller.hpp"

namespace biteline::soak {

/// What becomes of the controller's states on their way to the host.
enum class Lie : int {
  None,
  Silent,      ///< connections stand, nothing comes
  Cut,         ///< each connection ends at once
  TipAside,    ///< the tip 80 mm below where it is
  NotANumber,  ///< the tip NaN
  OtherTool,   ///< another tip is set
  PowerOff,    ///< robot mode 3
  Unplugged,   ///< connections stand, nothing passes either way, and no new one is answered
  DeafDoors,   ///< states pass; script port and dashboard take words and pass none
  SaysEnded,   ///< runtime_state 1: no program runs
  ToolOn,      ///< output 0 is on
  Lagging,     ///< states come later and later, by 0.12 s more each second
};

/// Relays RTDE, script port and dashboard.  Thread: one of its own; public methods from any.
class ControllerBetween {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ControllerBetween>> open(sim::UrController::Ports controller);
  ~ControllerBetween();
  ControllerBetween(const ControllerBetween&) = delete;
  ControllerBetween& operator=(const ControllerBetween&) = delete;

  [[nodiscard]] std::uint16_t rtde_port() const { return doors_[0].listener.port; }
  [[nodiscard]] std::uint16_t script_port() const { return doors_[1].listener.port; }
  [[nodiscard]] std::uint16_t dashboard_port() const { return doors_[2].listener.port; }

  std::atomic<Lie> lie{Lie::None};

  /// The whole scripts that passed since the last call.
  [[nodiscard]] std::vector<std::string> take_scripts();
  /// How often the word that stops the arm passed.
  [[nodiscard]] std::uint64_t stops() const { return stops_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Kind { Rtde, Script, Dashboard };
  struct Door {
    Kind kind;
    sim::TcpListener listener;
    std::uint16_t controller_port;
  };
  /// One connection through a door.
  struct Pair {
    Kind kind{};
    hal::Descriptor host, controller;
    std::vector<std::uint8_t> to_host, to_controller;
    std::deque<std::pair<Clock::time_point, std::vector<std::uint8_t>>>
        held;           ///< for the host, and until when
    std::string words;  ///< of the host, not yet whole
    // RTDE only; large, so there is one only where it is needed.
    std::unique_ptr<rtde::PackageSplitter> from_host, from_controller;
    std::vector<rtde::Recipe> recipes;
    std::vector<std::string> asked;  ///< names of the recipe that is being set up
    rtde::ProtocolVersion version{rtde::ProtocolVersion::V1};
  };

  ControllerBetween() = default;
  void relay(const std::stop_token& stop);
  void accept();
  /// false: one end is gone.
  [[nodiscard]] bool pass(Pair& pair);
  void hear_host(Pair& pair, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool hear_controller(Pair& pair, std::span<const std::uint8_t> bytes);
  void take_reply(Pair& pair, const rtde::Package& package);
  void pass_state(Pair& pair, const rtde::Package& package);
  void hold_back(Pair& pair);

  std::vector<Door> doors_;
  std::vector<std::unique_ptr<Pair>> pairs_;
  std::mutex scripts_mutex_;
  std::vector<std::string> scripts_;
  std::atomic<std::uint64_t> stops_{0};
  std::optional<Clock::time_point> lagging_since_;
  std::jthread thread_;  ///< last: it uses the rest
};

}  // namespace biteline::soak
