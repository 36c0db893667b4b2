// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's own line to the broker for Sparkplug B: a line has one will, and the uplink's is taken.

#include <chrono>
#include <filesystem>
#include <memory>

#include "host/fleet/broker.hpp"
#include "host/fleet/sparkplug/node.hpp"

namespace biteline::fleet::sparkplug {

/// Thread: one owner.
class Line {
 public:
  /// `broker`: address and TLS; the rest is set here.  `count`: a file with the number of the last line, so
  /// that a death that comes late is never taken for this line's.
  Line(BrokerConfig broker, Node node, std::filesystem::path count)
      : config_{std::move(broker)}, node_{std::move(node)}, count_{std::move(count)} {}
  /// Of the file; 255: there is none.
  [[nodiscard]] static std::uint8_t last_line(const std::filesystem::path& count);
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
  std::filesystem::path count_;
  CellState state_;
  std::unique_ptr<Broker> broker_;
  std::chrono::steady_clock::time_point tried_{};
  bool born_{false};
};

}  // namespace biteline::fleet::sparkplug
