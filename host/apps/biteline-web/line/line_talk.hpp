// SPDX-License-Identifier: MIT
#pragma once
/// \file A protocol of the line's control as bytes in and bytes out, without a network.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/interfaces/line_control/line_state.hpp"

namespace biteline::web {

/// One whole request of a peer.
struct LineCommand {
  std::vector<std::uint8_t> bytes;    ///< as it came
  std::optional<int> job{};           ///< to be chosen, before the start
  std::optional<std::string> part{};  ///< of the next shoe, before the start; empty: it has none
  std::optional<int> start{};         ///< a request number
  bool stop{false};                   ///< and then nothing else
  bool asks_part{false};              ///< which part the last scan was of
  int fault{0};                       ///< the protocol's own; above 0 nothing is done
};

/// What stands at the beginning of a peer's bytes.
struct LineCut {
  std::size_t used{0};   ///< 0: more must come
  bool garbled{false};   ///< no request of this protocol: the connection ends
  bool farewell{false};  ///< the peer is done
  bool last{false};      ///< it is answered, and then the connection ends
  LineCommand command{};
};

/// What a door knows when it answers.
struct LineNews {
  line_control::LineState state{};
  std::uint16_t heartbeat{0};
  line_control::Refusal refusal{line_control::Refusal::None};  ///< of the door's last command
};

/// Thread: one owner.
class LineTalk {
 public:
  LineTalk() = default;
  LineTalk(const LineTalk&) = delete;
  LineTalk& operator=(const LineTalk&) = delete;
  virtual ~LineTalk() = default;

  /// Of the door in requests and in the log: "modbus", "text".
  [[nodiscard]] virtual const char* name() const = 0;
  [[nodiscard]] virtual LineCut cut(std::span<const std::uint8_t> bytes) const = 0;
  /// Empty: it cannot be answered, the connection ends.
  [[nodiscard]] virtual std::string answer(const LineCommand& command, const LineNews& news) = 0;
};

/// Longer than any request of either protocol.
inline constexpr std::size_t k_most_request_bytes = 260;

[[nodiscard]] std::unique_ptr<LineTalk> text_talk();
[[nodiscard]] Result<std::unique_ptr<LineTalk>> modbus_talk();

}  // namespace biteline::web
