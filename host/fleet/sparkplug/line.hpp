// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's own line to the broker for Sparkplug B: a line has one will, and the uplink's is taken.

#include <chrono>
#include <memory>

#include "host/fleet/broker.hpp"
#include "host/fleet/sparkplug/node.hpp"

namespace biteline::fleet::sparkplug {

/// Thread: one owner.
class Line {
 public:
  /// `broker`: address and TLS; the rest is set here.
  Line(BrokerConfig broker, Node node) : config_{std::move(broker)}, node_{std::move(node)} {}
  ~Line();  ///< says the death itself: a line that ends in order has no will

  /// Sends, receives, and begins a new line where there is none, not more often than each second.
  [[nodiscard]] Result<void> turn(std::chrono::milliseconds timeout);
  /// Told at once, or with the next birth.
  void show(const CellState& state);

 private:
  [[nodiscard]] Result<void> open();
  void be_born();

  BrokerConfig config_;
  Node node_;
  CellState state_;
  std::unique_ptr<Broker> broker_;
  std::chrono::steady_clock::time_point tried_{};
  bool born_{false};
};

}  // namespace biteline::fleet::sparkplug
