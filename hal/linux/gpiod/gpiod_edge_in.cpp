// SPDX-License-Identifier: MIT
#include "hal/linux/gpiod/gpiod_edge_in.hpp"

#include <linux/gpio.h>
#include <unistd.h>

#include <cerrno>

namespace biteline::hal {

Result<std::unique_ptr<GpiodEdgeIn>> GpiodEdgeIn::open(const GpioLineAddress& address) {
  BITELINE_ASSIGN(Descriptor request, request_edges(address));
  return std::unique_ptr<GpiodEdgeIn>{new GpiodEdgeIn{std::move(request), address.line}};
}

Result<Edge> GpiodEdgeIn::next_edge(Nanoseconds timeout) {
  BITELINE_TRY(wait_readable(request_.number(), timeout, name_.c_str()));
  gpio_v2_line_event event{};
  const ssize_t size = ::read(request_.number(), &event, sizeof event);
  if (size < 0) return device_failure(errno, name_.c_str(), "read edge");
  if (size != sizeof event) return fail(Errc::DeviceError, "%.60s: short edge event", name_.c_str());

  // The kernel drops the oldest events when the queue is full and goes on counting, from 1, modulo 2^32.
  // Edges that come faster than its interrupt thread runs are merged before they are counted: then the same
  // way comes twice.
  const bool rising = event.id == GPIO_V2_LINE_EVENT_RISING_EDGE;
  const std::uint32_t steps = event.line_seqno - last_sequence_;
  const std::uint64_t merged = steps == 1 && last_rising_ == rising ? 1 : 0;
  last_sequence_ = event.line_seqno;
  last_rising_ = rising;
  sequence_ += steps + merged;
  edges_lost_.fetch_add(steps - 1 + merged, std::memory_order_relaxed);
  edges_.fetch_add(1, std::memory_order_relaxed);
  return Edge{.stamp = SensorClock::time_point{Nanoseconds{static_cast<std::int64_t>(event.timestamp_ns)}},
              .rising = rising,
              .sequence = sequence_};
}

Result<bool> GpiodEdgeIn::level() noexcept {
  return read_level(request_.number(), name_.c_str());
}

EdgeHealth GpiodEdgeIn::health() const noexcept {
  return {.edges = edges_.load(std::memory_order_relaxed),
          .edges_lost = edges_lost_.load(std::memory_order_relaxed)};
}

}  // namespace biteline::hal
