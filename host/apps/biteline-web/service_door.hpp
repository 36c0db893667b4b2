// SPDX-License-Identifier: MIT
#pragma once
/// \file The service as the web server sees it: asked, and telling what happens.

#include <functional>
#include <memory>
#include <optional>

#include "host/interfaces/control/client.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

/// Thread: the callbacks must not block.  They come on another thread than the caller's; only a `hello` that
/// came before listen() is told within it.
class ServiceDoor {
 public:
  using OnAnswer = std::function<void(control::Answer)>;
  using OnEvent = std::function<void(const control::Event&)>;

  virtual ~ServiceDoor() = default;
  /// Exactly one answer comes: of the service, or 503 (`host_away`) or 504 (`host_late`).
  virtual void ask(control::Request request, OnAnswer on_answer) = 0;
  /// To be called once, before the first ask().
  virtual void listen(OnEvent on_event) = 0;
};

/// The real one, over the control end.  Connects in the background, again for ever.
[[nodiscard]] Result<std::unique_ptr<ServiceDoor>> open_service_door(const control::ClientConfig& config);

/// Without a service: every question is answered 503.
[[nodiscard]] std::unique_ptr<ServiceDoor> closed_service_door();

}  // namespace biteline::web
