// SPDX-License-Identifier: MIT
// bench_identify [SHOES]: every made sample against every upper.  How near a wrong model's surface comes, how
// far off the right one's lies, and what one comparison costs.  host/transfer/identify.cpp takes its figures
// from here.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <algorithm>
#include <vector>

#include "host/transfer/align/alignment.hpp"
#include "tests/support/made_pair.hpp"

int main(int argc, char** argv) {
  using namespace biteline;
  using Clock = std::chrono::steady_clock;
  const int shoes = argc > 1 ? std::atoi(argv[1]) : 8;
  const sim::ScanSettings scan{.profile_step_mm = 1.5, .column_step_mm = 0.2};
  std::vector<transfer::Sample> samples;
  std::vector<transfer::Upper> uppers;
  for (int i = 0; i < shoes; ++i) {
    const test::MadePair pair = test::made_pair({.seed = 500 + static_cast<std::uint64_t>(i), .scan = scan});
    auto sample = transfer::prepare_sample(pair.sample_cloud, pair.sample_line);
    auto upper = transfer::prepare_upper(pair.upper_cloud);
    if (!sample || !upper) continue;
    samples.push_back(std::move(*sample));
    uppers.push_back(std::move(*upper));
  }
  double right_mm = 0, wrong_mm = 1e9;
  int wrong_pairs = 0, wrong_taken = 0, right_taken = 0;
  const Clock::time_point begin = Clock::now();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t k = 0; k < uppers.size(); ++k) {
      const transfer::Alignment alignment = transfer::align(samples[i], uppers[k], {});
      if (i == k) {
        right_mm = std::max(right_mm, alignment.shape_rms_mm);
        right_taken += alignment.accepted() ? 1 : 0;
      } else {
        // Zero: they differ too much to be compared at all.
        if (alignment.shape_rms_mm > 0) wrong_mm = std::min(wrong_mm, alignment.shape_rms_mm);
        wrong_taken += alignment.accepted() ? 1 : 0;
        ++wrong_pairs;
      }
    }
  }
  const double each_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count() /
                         std::max<double>(1, static_cast<double>(samples.size() * uppers.size()));
  const auto row = [](const char* metric, double value, const char* unit) {
    std::printf(R"({"bench":"identify","what":"%s","ours":%.4g,"unit":"%s"})"
                "\n",
                metric, value, unit);
  };
  row("wrong pairs", wrong_pairs, "");
  row("wrong pairs taken", wrong_taken, "");
  row("nearest wrong residual", wrong_mm, "mm");
  row("right pairs taken",
      static_cast<double>(right_taken) / static_cast<double>(std::max<std::size_t>(1, samples.size())), "");
  row("farthest right residual", right_mm, "mm");
  row("one comparison", each_ms, "ms");
}
