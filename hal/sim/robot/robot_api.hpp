// SPDX-License-Identifier: MIT
#pragma once
/// \file The Robot API of a simulated PolyScope X: what it answers by HTTP, without sockets.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace biteline::sim::robot_api {

struct Request {
  std::string method, target, body;
};

/// The first whole one in `bytes`, which is taken from there.  Nothing: it has not arrived whole.
[[nodiscard]] std::optional<Request> take_request(std::vector<std::uint8_t>& bytes);

/// What it tells about itself.
struct State {
  std::array<int, 3> version{10, 14, 0};
  bool remote{true}, powered{true}, protective_stop{false}, program_running{false};
  std::string model, serial;
};

enum class Order : std::uint8_t { None, Stop, PowerOff, PowerOn, UnlockProtectiveStop };

struct Answer {
  int status{404};
  std::string body;
  Order order{Order::None};  ///< to be carried out
};

/// As PolyScope X `state.version` has it: program state and orders from 10.11 on, modes from 10.12,
/// information and versions from 10.14.  In local control it answers questions and refuses orders (403).
[[nodiscard]] Answer answer_to(const Request& request, const State& state);

/// As it goes over the wire; the connection ends behind it.
[[nodiscard]] std::string http_text(const Answer& answer);

}  // namespace biteline::sim::robot_api
