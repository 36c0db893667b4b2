// SPDX-License-Identifier: MIT
#pragma once
/// \file Doors for the line's control: Modbus TCP and plain text, without a login.
///
/// They choose a job, ask for a start, stop and read.  They have no word for more: no approval, no laser.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/apps/biteline-web/service_door.hpp"

namespace biteline::web {

struct LineListener {
  std::string address;    ///< the number of one interface, IPv6 without brackets
  std::uint16_t port{0};  ///< 0: any free one
};

/// What peers may take of the doors.
struct LineLimits {
  int peers{16};  ///< of each door; for more, one that asks nothing must go, or they are turned away
  std::chrono::milliseconds request_time{5'000};  ///< from a request's first byte to its last
  std::chrono::milliseconds idle_time{60'000};    ///< without a request
};

struct LineDoorsConfig {
  std::optional<LineListener> modbus{}, text{};
  std::vector<std::string> peers{};  ///< addresses that may connect; compulsory beyond loopback
  LineLimits limits{};
};

/// Thread: one of its own ("bl-doors"), which waits for nobody: a peer that is slow, silent or garbled loses
/// its connection.
class LineDoors {
 public:
  /// Listens when it returns.  Errc::AuthenticationFailed: an address beyond loopback without a list of
  /// peers, or every interface at once; Errc::PeerRefused: the port is taken.
  [[nodiscard]] static Result<std::unique_ptr<LineDoors>> open(const LineDoorsConfig& config,
                                                               std::unique_ptr<ServiceDoor> service);
  ~LineDoors();

  /// 0: this door is closed.
  [[nodiscard]] std::uint16_t modbus_port() const;
  [[nodiscard]] std::uint16_t text_port() const;

 private:
  struct State;
  explicit LineDoors(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::web
