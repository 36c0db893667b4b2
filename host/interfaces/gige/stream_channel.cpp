// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/stream_channel.hpp"

#include <algorithm>

#include "common/core/contracts.hpp"

namespace biteline::gige {

void StreamChannel::restart(std::size_t packet_bytes) {
  BITELINE_EXPECTS(packet_bytes > k_ip_udp_bytes + k_stream_header_bytes);
  data_bytes_ = packet_bytes - k_ip_udp_bytes - k_stream_header_bytes;
  frames_.clear();
  kept_bytes_ = 0;
  next_block_ = 1;
}

void StreamChannel::begin(FrameFacts frame) {
  while (kept_bytes_ > k_kept_bytes && frames_.size() > 1) {
    kept_bytes_ -= frames_.front().payload.size();
    frames_.pop_front();
  }
  frame.block = next_block_;
  // 0 is no frame's number.
  next_block_ = next_block_ == 0xffff ? std::uint16_t{1} : static_cast<std::uint16_t>(next_block_ + 1);
  frames_.push_back({.facts = frame, .payload = {}});
  send_first(leader(frame));
}

void StreamChannel::append(std::span<const std::uint8_t> bytes) {
  BITELINE_EXPECTS(in_frame());
  Kept& frame = frames_.back();
  frame.payload.insert(frame.payload.end(), bytes.begin(), bytes.end());
  kept_bytes_ += bytes.size();
  send_payload(frame, false);
}

void StreamChannel::finish(std::uint32_t chunk_bytes) {
  BITELINE_EXPECTS(in_frame());
  Kept& frame = frames_.back();
  send_payload(frame, true);
  frame.chunk_bytes = chunk_bytes;
  frame.finished = true;
  send_first(packet_of(frame, frame.sent + 1));
  ++counts_.frames;
}

void StreamChannel::send_payload(Kept& frame, bool all) {
  while (frame.sent * data_bytes_ + (all ? 1 : data_bytes_) <= frame.payload.size()) {
    ++frame.sent;
    send_first(packet_of(frame, frame.sent));
  }
}

void StreamChannel::send_first(std::span<const std::uint8_t> packet) {
  ++counts_.packets;
  send_(packet);
}

std::vector<std::uint8_t> StreamChannel::packet_of(const Kept& frame, std::uint32_t number) const {
  if (number == 0) return leader(frame.facts);
  if (number > frame.sent) return trailer(frame.facts, number, frame.chunk_bytes);
  const std::size_t from = (number - 1) * data_bytes_;
  const std::size_t bytes = std::min(data_bytes_, frame.payload.size() - from);
  return payload_packet(frame.facts.block, number, std::span{frame.payload}.subspan(from, bytes));
}

void StreamChannel::send_again(const ResendWish& wish) {
  const auto frame =
      std::ranges::find_if(frames_, [&](const Kept& kept) { return kept.facts.block == wish.block; });
  if (frame == frames_.end()) {
    // A frame that is still to come is no lost one: the client is early.
    constexpr std::uint16_t k_half_round = 0x8000;
    if (static_cast<std::uint16_t>(wish.block - next_block_) < k_half_round) return;
    ++counts_.unavailable;
    return send_(unavailable_packet(wish.block, wish.first));
  }
  // Nor are packets.
  const std::uint32_t last = std::min(wish.last, frame->finished ? frame->sent + 1 : frame->sent);
  for (std::uint32_t number = wish.first; number <= last; ++number) {
    ++counts_.resent;
    send_(packet_of(*frame, number));
  }
}

}  // namespace biteline::gige
