// SPDX-License-Identifier: MIT
#pragma once
/// \file The port of a made controller where its states are heard and nothing can be said.

#include <memory>
#include <vector>

#include "common/arm_link/messages.hpp"
#include "hal/sim/robot/tcp.hpp"

namespace biteline::sim {

/// What docs/other-arms.md asks of the task that tells poses: whoever connects hears each state, and what he
/// says is not read.  Thread: one owner, but for port().
class StateTeller {
 public:
  static constexpr std::size_t k_most_listeners = 4;

  /// \param port on loopback; 0: a free one
  [[nodiscard]] static Result<StateTeller> open(std::uint16_t port);

  [[nodiscard]] std::uint16_t port() const { return listener_.port; }
  /// To all who listen.  Who takes nothing for long, and who comes when there are enough, is cut off.
  void tell(const arm_link::State& state);

 private:
  struct Ear {
    hal::Descriptor socket;
    std::vector<std::uint8_t> outgoing{};
    std::uint32_t said{0};
  };
  explicit StateTeller(TcpListener listener) : listener_{std::move(listener)} {}

  TcpListener listener_;
  std::vector<Ear> ears_;
};

}  // namespace biteline::sim
