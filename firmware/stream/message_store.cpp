// SPDX-License-Identifier: MIT
#include "firmware/stream/message_store.hpp"

#include <algorithm>
#include <utility>

#include "common/core/contracts.hpp"

namespace biteline::stream {

std::uint64_t MessageStore::clear() {
  const std::uint64_t unacknowledged = held_to() - std::clamp(acknowledged_, held_from_, held_to());
  messages_.clear();
  held_bytes_ = 0;
  held_from_ = 0;
  acknowledged_ = 0;
  return unacknowledged;
}

bool MessageStore::has_room(std::size_t size_bytes) const {
  std::size_t kept_bytes = held_bytes_;
  std::uint64_t sequence = held_from_;
  for (const wire::Bytes& message : messages_) {
    if (kept_bytes + size_bytes <= capacity_bytes_) return true;
    if (sequence >= acknowledged_) return false;
    kept_bytes -= message.size();
    ++sequence;
  }
  return true;  // an empty store takes any one message
}

std::uint64_t MessageStore::push(wire::Bytes message) {
  std::uint64_t lost = 0;
  while (!messages_.empty() && held_bytes_ + message.size() > capacity_bytes_) {
    if (held_from_ >= acknowledged_) ++lost;
    held_bytes_ -= messages_.front().size();
    messages_.pop_front();
    ++held_from_;
  }
  held_bytes_ += message.size();
  messages_.push_back(std::move(message));
  return lost;
}

std::span<const std::uint8_t> MessageStore::at(std::uint64_t sequence) const {
  BITELINE_EXPECTS(sequence >= held_from() && sequence < held_to());
  return messages_[static_cast<std::size_t>(sequence - held_from_)];
}

}  // namespace biteline::stream
