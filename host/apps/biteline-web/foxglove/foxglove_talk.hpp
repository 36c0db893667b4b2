// SPDX-License-Identifier: MIT
#pragma once
/// \file What is said to a client of Foxglove or Lichtblick: their WebSocket protocol, version 1, without any
/// socket.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/apps/biteline-web/live_messages.hpp"

namespace biteline::web {

/// Clients offer one of these, older or newer; both speak what is said here.
inline constexpr std::array<std::string_view, 2> k_foxglove_protocols{"foxglove.websocket.v1",
                                                                      "foxglove.sdk.v1"};

/// The offered name that is to be echoed; empty: none of ours.  `offer`: Sec-WebSocket-Protocol, a list.
[[nodiscard]] std::string_view choose_foxglove_protocol(std::string_view offer);

/// One client.  Points are in metres, as Foxglove wants them.  Thread: one owner.
class FoxgloveTalk {
 public:
  /// Sent first, one text each: who this is, and its channels /camera and /cloud.
  [[nodiscard]] static std::vector<std::string> first_words();

  /// A text of the client; what is not understood is left out.
  void hear(std::string_view text);

  /// The binary messages that carry `bytes` (of /api/v1/live): one for each subscription to its channel.
  [[nodiscard]] std::vector<std::string> messages(const std::string& bytes, std::uint64_t now_ns) const;

 private:
  static constexpr std::size_t k_most_subscriptions = 64;
  std::map<std::uint32_t, std::uint32_t> channel_of_;  ///< by the client's subscription
};

}  // namespace biteline::web
