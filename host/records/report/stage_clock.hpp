// SPDX-License-Identifier: MIT
#pragma once
/// \file Wall time of an algorithm's stages, in order.

#include <algorithm>
#include <chrono>
#include <string_view>
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
  /// Runs `work`, notes its time under `name` (a literal) and hands on what it returns.  What runs twice
  /// under one name took both times.
  template <class Work>
  auto run(const char* name, Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const auto before = std::ranges::find_if(
        times_, [&](const StageTime& time) { return std::string_view{time.name} == name; });
    if (before == times_.end())
      times_.push_back({name, seconds});
    else
      before->seconds += seconds;
    return result;
  }
  [[nodiscard]] std::vector<StageTime> take() { return std::move(times_); }

 private:
  std::vector<StageTime> times_;
};

}  // namespace biteline::report
