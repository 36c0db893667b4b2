// SPDX-License-Identifier: MIT
#pragma once
/// \file Frames as packets, sent as they come together, and kept to be sent again.  Without sockets.

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "common/gige/packets.hpp"

namespace biteline::gige {

struct StreamCounts {
  std::uint64_t frames{0};
  std::uint64_t packets{0};      ///< sent for the first time
  std::uint64_t resent{0};       ///< asked for and sent again
  std::uint64_t unavailable{0};  ///< asked for and no longer kept
};

/// Thread: one owner.
class StreamChannel {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;
  explicit StreamChannel(Send send) : send_{std::move(send)} {}

  /// Frames count from 1 again, and nothing is kept.  `packet_bytes`: with the headers of IP, UDP and stream.
  void restart(std::size_t packet_bytes);
  /// Sends the leader.  The block number is filled in.
  void begin(FrameFacts frame);
  /// Sends what fills packets.
  void append(std::span<const std::uint8_t> bytes);
  /// Sends the rest and the trailer; see trailer() for `chunk_bytes`.
  void finish(std::uint32_t chunk_bytes);
  [[nodiscard]] bool in_frame() const { return !frames_.empty() && !frames_.back().finished; }

  void send_again(const ResendWish& wish);
  [[nodiscard]] const StreamCounts& counts() const { return counts_; }

 private:
  /// More than a second of frames at any rate that a network takes; a longer wait is no resend.
  static constexpr std::size_t k_kept_bytes = 32U << 20U;

  struct Kept {
    FrameFacts facts;
    std::vector<std::uint8_t> payload;
    std::uint32_t sent{0};  ///< packets of the payload
    std::uint32_t chunk_bytes{0};
    bool finished{false};
  };
  [[nodiscard]] std::vector<std::uint8_t> packet_of(const Kept& frame, std::uint32_t number) const;
  void send_payload(Kept& frame, bool all);
  void send_first(std::span<const std::uint8_t> packet);

  Send send_;
  std::deque<Kept> frames_;
  std::size_t kept_bytes_{0};
  std::size_t data_bytes_{1};  ///< of the payload in one packet
  std::uint16_t next_block_{1};
  StreamCounts counts_;
};

}  // namespace biteline::gige
