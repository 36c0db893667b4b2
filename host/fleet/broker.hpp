// SPDX-License-Identifier: MIT
#pragma once
/// \file A line to the MQTT broker (MQTT 5, TLS) that comes back by itself.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::fleet {

/// PEM files.  The certificate's common name is the user's name at the broker.
struct TlsFiles {
  std::filesystem::path authority, certificate, key;
};

struct BrokerConfig {
  std::string host;
  std::uint16_t port{8883};
  std::optional<TlsFiles> tls;  ///< compulsory beyond loopback
  std::string client;           ///< its name at the broker
  std::vector<std::string> subscriptions;
  std::string will_topic;  ///< empty: no will
  std::string will;        ///< published when this line is cut
  bool will_kept{true};    ///< by the broker, for whoever comes later
};

/// "mqtts://HOST:PORT", or "mqtt://HOST:PORT" on loopback.
[[nodiscard]] Result<BrokerConfig> parse_broker(const std::string& text);

/// Thread: one owner; callbacks come from turn().
class Broker {
 public:
  using OnMessage = std::function<void(std::string_view topic, std::string_view payload)>;
  /// Subscribed, after each connecting.
  using OnReady = std::function<void()>;

  /// Does not connect yet.  Errc::AuthenticationFailed: beyond loopback without TLS; Errc::FileUnreadable: a
  /// PEM file is not there or is none.
  [[nodiscard]] static Result<std::unique_ptr<Broker>> open(const BrokerConfig& config, OnMessage on_message,
                                                            OnReady on_ready);
  ~Broker();  ///< says good-bye: the will is not published

  /// Sends, receives and connects again; returns after `timeout` or earlier.  An Error says why there is no
  /// line; it is tried again by the next call, not more often than each second.
  [[nodiscard]] Result<void> turn(std::chrono::milliseconds timeout);

  [[nodiscard]] bool ready() const;
  /// QoS 0; QoS 1; QoS 1, and kept by the broker for whoever comes later.
  enum class Delivery { AtMostOnce, AtLeastOnce, Kept };
  /// False: there is no line, nothing was sent.
  bool publish(const std::string& topic, const std::string& payload, Delivery delivery);

 private:
  struct State;
  explicit Broker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::fleet
