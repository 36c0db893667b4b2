// SPDX-License-Identifier: MIT
#pragma once
/// \file Shortest, mean and longest time of one stage, measured where it runs and read from anywhere.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>

#include "common/rt/annotations.hpp"
#include "common/time/clocks.hpp"

namespace biteline::runtime {

/// Thread: one writer, any reader (a reader may see a count one ahead of its sum: telemetry).  RT: rt_
/// members.
class StageMeter {
 public:
  struct Summary {
    std::uint64_t count{0};
    Nanoseconds min{0}, mean{0}, max{0};
  };

  void rt_add(Nanoseconds duration) noexcept BITELINE_RT {
    // relaxed: one writer, and readers want no order between the numbers.
    const std::int64_t ns = duration.count();
    count_.store(count_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    sum_ns_.store(sum_ns_.load(std::memory_order_relaxed) + ns, std::memory_order_relaxed);
    min_ns_.store(std::min(min_ns_.load(std::memory_order_relaxed), ns), std::memory_order_relaxed);
    max_ns_.store(std::max(max_ns_.load(std::memory_order_relaxed), ns), std::memory_order_relaxed);
  }

  [[nodiscard]] Summary summary() const {
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    if (count == 0) return {};
    const std::int64_t sum_ns = sum_ns_.load(std::memory_order_relaxed);
    return {.count = count,
            .min = Nanoseconds{min_ns_.load(std::memory_order_relaxed)},
            .mean = Nanoseconds{sum_ns / static_cast<std::int64_t>(count)},
            .max = Nanoseconds{max_ns_.load(std::memory_order_relaxed)}};
  }

 private:
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> sum_ns_{0};
  std::atomic<std::int64_t> min_ns_{std::numeric_limits<std::int64_t>::max()};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace biteline::runtime
