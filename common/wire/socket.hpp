// SPDX-License-Identifier: MIT
#pragma once
/// \file ZeroMQ sockets as move-only owners that report errors by Result.
///
/// Over libzmq's C interface and not cppzmq: the firmware is built without exceptions, and cppzmq throws.

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "common/wire/messages.hpp"

namespace biteline::wire {

/// libzmq's background thread and all of its sockets.  Must outlive them.
class SocketContext {
 public:
  [[nodiscard]] static Result<SocketContext> create();
  SocketContext(SocketContext&& other) noexcept;
  SocketContext& operator=(SocketContext&&) = delete;
  ~SocketContext();  ///< waits until what was sent has left, at most the sockets' linger time

  [[nodiscard]] void* handle() const { return handle_; }

 private:
  explicit SocketContext(void* handle) : handle_{handle} {}
  void* handle_;
};

enum class SocketKind {
  Listener,    ///< ROUTER: many peers, each packet with its peer's address in front
  Caller,      ///< DEALER: one peer
  Gatekeeper,  ///< answers libzmq's own questions whom to let in (ZAP, RFC 27)
  Watcher,     ///< hears a caller's connection events
};

/// Thread: one owner.
class Socket {
 public:
  [[nodiscard]] static Result<Socket> open(const SocketContext& context, SocketKind kind);
  Socket(Socket&& other) noexcept;
  Socket& operator=(Socket&& other) noexcept;
  ~Socket();

  [[nodiscard]] Result<void> set(int option, int value);
  [[nodiscard]] Result<void> set(int option, const std::string& value);
  [[nodiscard]] Result<void> bind(const std::string& address);
  /// Stops listening there; who is connected stays until the socket is closed.
  void unbind(const std::string& address);
  [[nodiscard]] Result<void> connect(const std::string& address);
  /// Where a listener that asked for port 0 ended up.
  [[nodiscard]] Result<std::string> bound_address() const;

  /// All parts or none; false when that would block or nobody is there.
  bool send(std::initializer_list<std::span<const std::uint8_t>> parts);

  /// One whole message, if there is one.  Parts beyond the eighth are swallowed and counted in
  /// `surplus_parts`.
  struct Parts {
    std::vector<Bytes> parts;
    int surplus_parts{0};
  };
  [[nodiscard]] std::optional<Parts> receive();

  [[nodiscard]] void* handle() const { return handle_; }

 private:
  explicit Socket(void* handle) : handle_{handle} {}
  void* handle_;
};

/// Returns when one of the sockets can be read, or after `timeout`.
void wait_readable(std::initializer_list<const Socket*> sockets, Nanoseconds timeout);

/// A listener at `endpoint`, with encryption when there are keys.  Beyond loopback keys are compulsory:
/// Errc::AuthenticationFailed without them.  Pre: with keys there is a gatekeeper, opened before and served
/// by the caller.
[[nodiscard]] Result<Socket> open_listener(const SocketContext& context, const Endpoint& endpoint,
                                           const std::optional<KeyPair>& own, const Socket* gatekeeper);

/// The gatekeeper, bound where libzmq looks for it.
[[nodiscard]] Result<Socket> open_gatekeeper(const SocketContext& context);

/// Answers what is waiting.  Only CURVE peers whose key is in `allowed` (Z85) come in.  Returns how many were
/// refused.
[[nodiscard]] int serve_gatekeeper(Socket& gatekeeper, const std::vector<std::string>& allowed);

/// A caller, connecting in the background and again for ever.  The same rule about keys.
[[nodiscard]] Result<Socket> open_caller(const SocketContext& context, const Endpoint& endpoint,
                                         const std::optional<HostKeys>& keys);

enum class LinkEvent {
  Connected,  ///< handshake done
  Disconnected,
  AuthenticationFailed,  ///< refused by the other side's gatekeeper
  HandshakeFailed,       ///< no keys where keys are wanted, or not our protocol at all
  HandshakeBroken,       ///< ended without a word: wrong keys, or a peer that went or was too busy
  ConnectFailed,         ///< nobody listens there (tried again by itself)
};

/// Watches a caller's connection; must be opened before the caller sends.
[[nodiscard]] Result<Socket> open_watcher(const SocketContext& context, const Socket& caller);
[[nodiscard]] std::optional<LinkEvent> next_event(Socket& watcher);

/// Whether broken handshakes mean keys that do not fit.  Such keys break every handshake, the first ones
/// too.  A cable, a restart or a busy machine breaks one now and then, and it is tried again.
class HandshakeRecord {
 public:
  void on_success() { succeeded_ = true; }
  /// true: no handshake has ever come about, and this is the third that broke.
  [[nodiscard]] bool on_broken() { return !succeeded_ && ++broken_ >= k_broken_means_keys; }

 private:
  static constexpr int k_broken_means_keys = 3;
  bool succeeded_{false};
  int broken_{0};
};

}  // namespace biteline::wire
