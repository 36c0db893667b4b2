// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's control end: hears doors, answers them, tells them what happens.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::control {

struct ServerConfig {
  wire::Endpoint endpoint;  ///< port 0: any free one
  /// Compulsory beyond loopback, as on the wire.  The listening end's files are the wire's: sensor.public,
  /// sensor.secret, hosts.allowed.
  std::optional<wire::SensorKeys> keys;
  Json hello;  ///< what a door is told first: version, results folder, ...
};

/// What answers.  All may be called at the same time.
struct Handlers {
  /// On the end's own thread, at once: only what must not wait (Stop, Laser off).  Nothing: not urgent.
  std::function<std::optional<Answer>(const Request&)> urgent;
  /// On a worker's thread, one after the other; what is_long() has a worker of its own beside the others'.
  std::function<Answer(const Request&)> ordinary;
  /// It takes seconds: a file to look through, an arm or a sensor to ask.  None: nothing does.
  std::function<bool(const Request&)> is_long{};
  /// Asked the moment a request is heard: Request::stops.  None: nobody counts.
  std::function<std::uint64_t()> stops{};
};

struct ServerCounters {
  std::uint64_t requests{0};
  std::uint64_t refused_messages{0};  ///< broken, too long, too many at once
  std::uint64_t dropped_events{0};    ///< for doors that read too slowly
  std::uint64_t refused_doors{0};     ///< keys that are not in the list
};

/// Thread: three of its own ("bl-control" for the socket, "bl-control-work" and "bl-control-long" for the
/// handler); its methods are safe from any.  Nobody who is slow, silent or hostile holds it up: what a door
/// does not take is dropped and counted, at most 128 requests wait for each worker, 32 of one door, a message
/// has at most 512 KiB.
class Server {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Server>> open(const ServerConfig& config, Handlers handlers);
  ~Server();

  /// Where it listens.
  [[nodiscard]] const std::string& address() const;

  /// To every door that has said hello within the last 5 s; returns at once.
  void publish(const std::string& name, Json data);

  /// Of the last event.
  [[nodiscard]] std::uint64_t last_seq() const;

  [[nodiscard]] ServerCounters counters() const;
  [[nodiscard]] int doors() const;

 private:
  struct State;
  explicit Server(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::control
