// SPDX-License-Identifier: MIT
#include "hal/sim/robot/state_teller.hpp"

#include <utility>

namespace biteline::sim {
namespace {

constexpr std::size_t k_most_untaken_bytes = 1U << 16U;

}  // namespace

Result<StateTeller> StateTeller::open(std::uint16_t port) {
  BITELINE_ASSIGN(TcpListener listener, listen_on_loopback(port));
  return StateTeller{std::move(listener)};
}

void StateTeller::tell(const arm_link::State& state) {
  for (hal::Descriptor caller = accept_from(listener_); caller.is_open(); caller = accept_from(listener_)) {
    if (ears_.size() < k_most_listeners) ears_.push_back({.socket = std::move(caller)});
  }
  std::erase_if(ears_, [&](Ear& ear) {
    const arm_link::Message message = arm_link::encode(++ear.said, state);
    ear.outgoing.insert(ear.outgoing.end(), message.begin(), message.end());
    return !write_available(ear.socket, ear.outgoing) || ear.outgoing.size() > k_most_untaken_bytes;
  });
}

}  // namespace biteline::sim
