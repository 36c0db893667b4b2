// SPDX-License-Identifier: MIT
#pragma once
/// \file A CAN bus of a queue: what the test puts in comes out, and time moves only by waiting.

#include <algorithm>
#include <deque>
#include <span>

#include "hal/api/can_bus.hpp"
#include "hal/api/virtual_clock.hpp"

namespace biteline::hal {

class FakeCanBus final : public CanBus {
 public:
  explicit FakeCanBus(VirtualClock& clock) : clock_{clock} {}

  Result<void> set_filters(std::span<const CanFilter> filters) override {
    filters_.assign(filters.begin(), filters.end());
    return {};
  }
  Result<CanFrame> receive(Nanoseconds timeout) override {
    while (!queue.empty()) {
      const CanFrame frame = queue.front();
      queue.pop_front();
      if (passes(frame)) return frame;
    }
    clock_.advance(std::max(timeout, Nanoseconds{0}));
    return fail(Errc::Timeout, "fake bus");
  }
  Result<void> send(const CanFrame& frame) override {
    queue.push_back(frame);
    return {};
  }
  CanHealth health() const noexcept override { return {}; }

  void put(std::uint32_t id, std::span<const std::uint8_t> data) {
    CanFrame frame{.id = id, .size_bytes = static_cast<std::uint8_t>(data.size()), .received = clock_.now()};
    std::copy(data.begin(), data.end(), frame.data.begin());
    queue.push_back(frame);
  }

  std::deque<CanFrame> queue;

 private:
  [[nodiscard]] bool passes(const CanFrame& frame) const {
    return filters_.empty() || std::any_of(filters_.begin(), filters_.end(), [&](const CanFilter& filter) {
             return (frame.id & filter.mask) == (filter.id & filter.mask);
           });
  }

  VirtualClock& clock_;
  std::deque<CanFilter> filters_;
};

}  // namespace biteline::hal
