// SPDX-License-Identifier: MIT
// bench_identify [SHOES] [MODELS]: every made sample against every upper.  How near a wrong model's surface
// comes, how far off the right one's lies, what the rough fit sets aside of those that align() takes (none),
// and what one comparison costs.  Then the first SHOES uppers against a library of MODELS samples on disk.
// host/transfer/identify.cpp and align/rough_fit.hpp take their figures from here.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "host/cloud/ply.hpp"
#include "host/transfer/align/alignment.hpp"
#include "host/transfer/align/rough_fit.hpp"
#include "host/transfer/identify.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void row(const char* metric, double value, const char* unit) {
  std::printf(R"({"bench":"identify","what":"%s","ours":%.4g,"unit":"%s"})"
              "\n",
              metric, value, unit);
}

test::MadePair pair_of(int i) {
  return test::made_pair(
      {.seed = 500 + static_cast<std::uint64_t>(i), .scan = {.profile_step_mm = 1.5, .column_step_mm = 0.2}});
}

void all_pairs(int shoes) {
  std::vector<transfer::Sample> samples;
  std::vector<transfer::RoughShape> shapes;
  std::vector<transfer::Upper> uppers;
  for (int i = 0; i < shoes; ++i) {
    const test::MadePair pair = pair_of(i);
    auto sample = transfer::prepare_sample(pair.sample_cloud, pair.sample_line);
    auto upper = transfer::prepare_upper(pair.upper_cloud);
    if (!sample || !upper) continue;
    shapes.push_back(transfer::rough_shape_of(*sample));
    samples.push_back(std::move(*sample));
    uppers.push_back(std::move(*upper));
  }
  double right_mm = 0, wrong_mm = 1e9, rough_right_mm = 0, rough_ms = 0, align_ms = 0;
  int wrong_pairs = 0, wrong_taken = 0, right_taken = 0, wrong_compared = 0, taken_set_aside = 0;
  for (std::size_t k = 0; k < uppers.size(); ++k) {
    const Clock::time_point target_begin = Clock::now();
    const transfer::RoughTarget target{uppers[k]};
    rough_ms += ms_since(target_begin);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Clock::time_point begin = Clock::now();
      const double rough_mm = transfer::rough_fit(shapes[i], target).off_mm;
      rough_ms += ms_since(begin);
      const Clock::time_point align_begin = Clock::now();
      const transfer::Alignment alignment = transfer::align(samples[i], uppers[k], {});
      align_ms += ms_since(align_begin);
      const bool set_aside = rough_mm > transfer::k_most_rough_mm;
      taken_set_aside += set_aside && alignment.accepted() ? 1 : 0;
      if (i == k) {
        right_mm = std::max(right_mm, alignment.shape_rms_mm);
        rough_right_mm = std::max(rough_right_mm, rough_mm);
        right_taken += alignment.accepted() ? 1 : 0;
      } else {
        // Zero: they differ too much to be compared at all.
        if (alignment.shape_rms_mm > 0) wrong_mm = std::min(wrong_mm, alignment.shape_rms_mm);
        wrong_taken += alignment.accepted() ? 1 : 0;
        wrong_compared += set_aside ? 0 : 1;
        ++wrong_pairs;
      }
    }
  }
  const double pairs = std::max<double>(1, static_cast<double>(samples.size() * uppers.size()));
  row("wrong pairs", wrong_pairs, "");
  row("wrong pairs taken", wrong_taken, "");
  row("nearest wrong residual", wrong_mm, "mm");
  row("right pairs taken",
      static_cast<double>(right_taken) / static_cast<double>(std::max<std::size_t>(1, samples.size())), "");
  row("farthest right residual", right_mm, "mm");
  row("taken but set aside by the rough fit", taken_set_aside, "");
  row("farthest right rough fit", rough_right_mm, "mm");
  row("wrong pairs that the rough fit lets through", wrong_compared, "");
  row("one rough fit", rough_ms / pairs, "ms");
  row("one comparison", align_ms / pairs, "ms");
}

void whole_library(int shoes, int models) {
  const test::TemporaryFolder folder;
  const transfer::Library library{folder.path() / "models"};
  std::vector<cloud::PointCloud> uppers;
  for (int i = 0; i < models; ++i) {
    const test::MadePair pair = pair_of(i);
    const std::filesystem::path sample = folder.path() / "sample";
    std::filesystem::create_directories(sample);
    const bool saved = cloud::write_cloud(sample / transfer::k_cloud_file, pair.sample_cloud) &&
                       cloud::write_line(sample / transfer::k_line_file, pair.sample_line) &&
                       library.save("shoe-" + std::to_string(i), sample);
    if (!saved) {
      std::fprintf(stderr, "bench_identify: model %d could not be saved\n", i);
      std::exit(1);
    }
    if (i < shoes) uppers.push_back(pair.upper_cloud);
  }
  const Clock::time_point first = Clock::now();
  (void)transfer::identify(library, uppers.front(), {});
  row("first recognition in a new library", ms_since(first), "ms");
  double most_ms = 0, sum_ms = 0;
  const std::clock_t used = std::clock();
  int named = 0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < uppers.size(); ++i) {
    const Clock::time_point begin = Clock::now();
    const auto found = transfer::identify(library, uppers[i], {});
    const double ms = ms_since(begin);
    most_ms = std::max(most_ms, ms);
    sum_ms += ms;
    if (!found) continue;
    named += found->name == "shoe-" + std::to_string(i) ? 1 : 0;
    if (found->refusal) std::fprintf(stderr, "upper %zu: %s\n", i, found->refusal->reason.c_str());
    for (const transfer::Match& match : found->matches) compared += match.compared ? 1 : 0;
  }
  const auto count = static_cast<double>(uppers.size());
  row("recognition, processor time", 1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC / count,
      "ms");
  row("models in the library", models, "");
  row("uppers named rightly", named / count, "");
  row("models compared for one upper", static_cast<double>(compared) / count, "");
  row("recognition, mean", sum_ms / count, "ms");
  row("recognition, longest", most_ms, "ms");
}

}  // namespace
}  // namespace biteline

int main(int argc, char** argv) {
  const int shoes = std::max(1, argc > 1 ? std::atoi(argv[1]) : 8);
  const int models = std::max(shoes, argc > 2 ? std::atoi(argv[2]) : 16);
  biteline::all_pairs(shoes);
  biteline::whole_library(shoes, models);
}
