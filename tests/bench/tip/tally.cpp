// SPDX-License-Identifier: MIT
#include "tests/bench/tip/tally.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "host/geometry/robust.hpp"

namespace biteline::bench {

void TipTally::add(const Worked& worked) {
  ++shoes;
  refused += worked.refused.empty() ? 0 : 1;
  waits += worked.waits ? 1 : 0;
  if (worked.waits || worked.off_mm.empty()) return;
  off_mm.insert(off_mm.end(), worked.off_mm.begin(), worked.off_mm.end());
  largest_mm.push_back(std::ranges::max(worked.off_mm));
}

void TipTallies::print() const {
  for (const auto& [key, tally] : tallies_) {
    std::printf(
        "{\"bench\":\"tip.%s\",\"what\":\"%s: p95 of the tip off the line\",\"shoes\":%d,\"refused\":%d,"
        "\"waits\":%d,",
        key.first.c_str(), key.second.c_str(), tally.shoes, tally.refused, tally.waits);
    std::vector<double> off_mm = tally.off_mm;
    if (off_mm.empty()) {
      std::printf("\"unit\":\"mm\"}\n");
      continue;
    }
    const auto mean = [](const std::vector<double>& of) {
      return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
    };
    std::printf(
        "\"ours\":%.3f,\"mean_mm\":%.3f,\"mean_of_largest_mm\":%.3f,\"max_mm\":%.3f,\"unit\":\"mm\"}\n",
        geometry::quantile_of(std::span<double>{off_mm}, 0.95), mean(off_mm), mean(tally.largest_mm),
        std::ranges::max(tally.largest_mm));
  }
}

}  // namespace biteline::bench
