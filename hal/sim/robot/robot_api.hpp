// SPDX-License-Identifier: MIT
#pragma once
/// \file The Robot API of a simulated PolyScope X: what it answers by HTTP, without sockets.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/robot/power.hpp"

namespace biteline::sim::robot_api {

struct Request {
  std::string method, target, body;
};

/// The first whole one in `bytes`, which is taken from there.  Nothing: it has not arrived whole.
[[nodiscard]] std::optional<Request> take_request(std::vector<std::uint8_t>& bytes);

/// What it tells about itself.
struct State {
  std::array<int, 3> version{10, 14, 0};
  bool remote{true}, protective_stop{false};
  RobotMode mode{RobotMode::Running};
  const char* program{"STOPPED"};  ///< or PLAYING, PAUSED
  std::string model, serial;
};

/// What clients have set; the controller's own, for all of them.
struct Memory {
  std::string loaded{"Default program"};
  std::map<std::string, std::string> uploaded{};  ///< programs as they came, by their names
};

enum class Order : std::uint8_t { None, Load, Play, Pause, Stop, PowerOff, PowerOn, ReleaseBrakes, Unlock };

struct Answer {
  int status{404};
  std::string body;
  Order order{Order::None};  ///< to be carried out
};

/// As PolyScope X `state.version` has it: program state and orders from 10.11 on, modes, the loaded program
/// and the list of programs from 10.12, information and versions from 10.14.  In local control it answers
/// questions, keeps programs and refuses orders (403).  `scripts`: what can be run, by name.
[[nodiscard]] Answer answer_to(const Request& request, const State& state,
                               const std::map<std::string, std::string>& scripts, Memory& memory);

/// As it goes over the wire; the connection ends behind it.
[[nodiscard]] std::string http_text(const Answer& answer);

}  // namespace biteline::sim::robot_api
