// SPDX-License-Identifier: MIT
#pragma once
/// \file Wall time of an algorithm's stages, in order.

#include <chrono>
#include <utility>
#include <vector>

namespace biteline::report {

struct StageTime {
  const char* name;
  double seconds;
};

/// Not thread-safe.
class StageClock {
 public:
  /// Runs `work`, notes its time under `name` (a literal) and hands on what it returns.
  template <class Work>
  auto run(const char* name, Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    times_.push_back({name, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
    return result;
  }
  [[nodiscard]] std::vector<StageTime> take() { return std::move(times_); }

 private:
  std::vector<StageTime> times_;
};

}  // namespace biteline::report
