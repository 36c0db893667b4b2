// SPDX-License-Identifier: MIT
#pragma once
/// \file Looks at a sensor beside the host that owns its scan: health, events, the newest profiles, live
/// pictures.

#include <memory>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "common/wire/messages.hpp"

namespace biteline::wire {

struct ObserverConfig {
  Endpoint sensor;
  std::optional<HostKeys> keys;  ///< compulsory beyond loopback
  ObserverHello wish;            ///< its `received` is filled in here
  /// Connected for so long without a hello of the sensor: it is older than protocol 1.1.
  Nanoseconds patience{std::chrono::seconds{5}};
};

/// An observer acknowledges nothing, keeps no laser alive, holds no scan up and commands nothing.  What it is
/// too slow for is left out by the sensor: it always gets the newest.
///
///     BITELINE_ASSIGN(auto observer, wire::Observer::open(config));
///     while (...) {
///       BITELINE_ASSIGN(const std::optional<wire::Message> message, observer->next(100ms));
///       if (message) std::visit(..., message->body);   // or std::get_if<wire::Picture>(&message->body)
///     }
///
/// Thread: one owner.  Call next() at least once a second.
class Observer {
 public:
  /// Starts to connect, in the background and for ever.
  [[nodiscard]] static Result<std::unique_ptr<Observer>> open(const ObserverConfig& config);
  ~Observer();  ///< says goodbye
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;

  /// The next message, or nothing within `timeout`: SensorHello (on each connection and when a scan begins),
  /// Health, Profile, Picture, EndOfScan, and Bye when the sensor stops (it may come back).  What does not
  /// pass verification is left out and counted.  An Error ends the link: refused key, other version, no
  /// place, a sensor that knows no observers.
  [[nodiscard]] Result<std::optional<Message>> next(Nanoseconds timeout);

  /// From now on; takes effect with the next call of next().
  void wish_for(const PictureWish& picture);
  void wish_for_profiles(double rate_hz);

  /// There is a sensor at the other end, and it has answered.
  [[nodiscard]] bool connected() const;
  [[nodiscard]] std::uint64_t rejected() const;

 private:
  struct State;
  explicit Observer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::wire
