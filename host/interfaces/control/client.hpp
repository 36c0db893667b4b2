// SPDX-License-Identifier: MIT
#pragma once
/// \file A door's end: asks the service, hears its events.

#include <functional>
#include <memory>
#include <optional>

#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::control {

struct ClientConfig {
  wire::Endpoint endpoint;
  std::optional<wire::HostKeys> keys;  ///< compulsory beyond loopback
  std::string door{"web"};             ///< said with the hello, and with each request that names none
  Nanoseconds patience{std::chrono::seconds{10}};  ///< for an answer; 504 then
};

/// Thread: one of its own ("bl-door"); the callbacks run there and must not block.  Its methods are safe from
/// any thread.  Connects in the background, again for ever.
class Client {
 public:
  using OnAnswer = std::function<void(Answer)>;
  using OnEvent = std::function<void(const Event&)>;
  /// True: the service has answered the hello; false: nothing was heard of it for 5 s.
  using OnLink = std::function<void(bool connected)>;

  [[nodiscard]] static Result<std::unique_ptr<Client>> open(const ClientConfig& config, OnEvent on_event = {},
                                                            OnLink on_link = {});
  ~Client();  ///< what was not answered gets 503

  /// The answer comes exactly once: of the service, or 503 (too many wait, or the end of this client) or 504
  /// (no word within `patience`).  `id` is set here; the answer has the caller's.
  void ask(Request request, OnAnswer on_answer);
  /// The same, waiting.  Not from a callback.
  [[nodiscard]] Answer ask(Request request);

  [[nodiscard]] bool connected() const;

 private:
  struct State;
  explicit Client(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::control
