// SPDX-License-Identifier: MIT
#pragma once
/// \file Store and forward: the encoded messages of a scan, kept until their room is needed and they are
/// acknowledged.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "common/wire/messages.hpp"

namespace biteline::stream {

/// Messages are numbered from 0 without gaps.  Acknowledged ones stay too, as long as there is room: a second
/// host that starts in the middle of a scan gets its beginning from here. Thread: one owner (the stream
/// thread).
class MessageStore {
 public:
  explicit MessageStore(std::size_t capacity_bytes) : capacity_bytes_{capacity_bytes} {}

  /// Forgets everything and numbers from 0 again.  Returns how many messages went unacknowledged.
  std::uint64_t clear();

  /// True when `size_bytes` more fit without losing a message that is not acknowledged.
  [[nodiscard]] bool has_room(std::size_t size_bytes) const;

  /// Always takes the message; the oldest go when it does not fit.  Returns how many of those were not
  /// acknowledged: losses, for the caller to count.
  std::uint64_t push(wire::Bytes message);

  /// Every message below `sequence` has arrived where it should.  May move back (another host lacks more).
  void set_acknowledged(std::uint64_t sequence) { acknowledged_ = sequence; }
  [[nodiscard]] std::uint64_t acknowledged() const { return acknowledged_; }

  [[nodiscard]] std::uint64_t held_from() const { return held_from_; }
  [[nodiscard]] std::uint64_t held_to() const { return held_from_ + messages_.size(); }

  /// Pre: held_from() <= sequence < held_to().
  [[nodiscard]] std::span<const std::uint8_t> at(std::uint64_t sequence) const;

  [[nodiscard]] std::size_t held_bytes() const { return held_bytes_; }

 private:
  std::size_t capacity_bytes_;
  std::size_t held_bytes_{0};
  std::uint64_t held_from_{0};
  std::uint64_t acknowledged_{0};
  std::deque<wire::Bytes> messages_;
};

}  // namespace biteline::stream
