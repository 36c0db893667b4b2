// SPDX-License-Identifier: MIT
#pragma once
/// \file Who only looks: observers, what they want, and what is due to whom.  Without sockets.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/wire/messages.hpp"
#include "firmware/stream/outbox.hpp"

namespace biteline::stream {

/// A live picture as a message, ready to be sent to everybody with that wish.
struct MadePicture {
  wire::PictureWish wish;
  std::uint64_t scan_id{0};
  wire::Bytes packet;
};

struct ObserversConfig {
  std::size_t max_observers{8};
  /// Sent and not yet taken, profiles and pictures together: more would be old when they are seen.
  std::uint64_t window{4};
  /// An observer says something at least once a second.
  Nanoseconds forgotten_after{2'000'000'000};
};

/// Each gets the newest, as often as it asks for and as it takes it; what comes meanwhile is left out for it.
/// Thread: one owner (the stream thread).
class Observers {
 public:
  Observers(ObserversConfig config, Outbox& outbox) : config_{config}, outbox_{outbox} {}

  enum class Welcome { Known, New, NoPlace };
  Welcome on_hello(const PeerId& peer, const wire::ObserverHello& hello, SensorClock::time_point now);
  [[nodiscard]] bool contains(const PeerId& peer) const { return observers_.contains(peer); }
  void erase(const PeerId& peer);
  void drop_silent(SensorClock::time_point now);

  /// To every observer, whatever it has taken: hellos, health, a scan's end, a farewell.
  void tell(std::span<const std::uint8_t> packet);

  /// A new scan: what is numbered begins anew.
  void begin_scan() { newest_sent_.clear(); }
  /// The newest profile, where one is due.
  void offer_profile(std::uint64_t sequence, std::span<const std::uint8_t> packet,
                     SensorClock::time_point now);
  void offer_picture(const MadePicture& picture);

  /// Different ones only; `wishes_version` counts their changes.
  [[nodiscard]] std::vector<wire::PictureWish> picture_wishes() const;
  [[nodiscard]] std::uint64_t wishes_version() const { return wishes_version_; }
  [[nodiscard]] std::size_t count() const { return observers_.size(); }

 private:
  struct Observer {
    wire::ObserverHello hello;
    SensorClock::time_point heard;
    SensorClock::time_point profile_due;
    std::uint64_t sent{0}, taken{0};  ///< counted on from what it had taken when it came
  };
  [[nodiscard]] bool ready(const Observer& observer) const;

  ObserversConfig config_;
  Outbox& outbox_;
  std::map<PeerId, Observer> observers_;
  std::map<PeerId, std::uint64_t> newest_sent_;  ///< profile by its number in the scan
  std::uint64_t wishes_version_{0};
};

}  // namespace biteline::stream
