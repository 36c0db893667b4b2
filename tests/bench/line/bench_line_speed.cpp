// SPDX-License-Identifier: MIT
// Cloud to line: wall time and memory, for made shoes scanned with more and more points.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <string>

#include <malloc.h>
#include <tbb/global_control.h>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/live_scan.hpp"

namespace biteline::bench {
namespace {

/// A line of /proc/self/status in bytes; 0 where there is none.
double status_bytes(const char* key) {
  std::ifstream status{"/proc/self/status"};
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::strtod(line.c_str() + std::strlen(key) + 1, nullptr) * 1024;
  }
  return 0;
}

/// Peak of the resident memory above what is resident now.  Linux resets the peak when told so.
class PeakMemory {
 public:
  PeakMemory() {
    std::ofstream{"/proc/self/clear_refs"} << "5";
    before_bytes_ = status_bytes("VmRSS");
  }
  [[nodiscard]] double bytes() const { return std::max(0.0, status_bytes("VmHWM") - before_bytes_); }

 private:
  double before_bytes_{0};
};

struct Timed {
  double wall_s{1e9};
  double processor_s{1e9};  ///< summed over the threads: what other load on the machine does not change
  bool found{true};
};

template <class Work>
Timed best_of(int rounds, Work&& work) {
  Timed best;
  for (int round = 0; round < rounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    best.found = work() && best.found;
    best.processor_s =
        std::min(best.processor_s, static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
    best.wall_s = std::min(best.wall_s,
                           std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

cloud::PointCloud scan(double points) {
  const sim::MadeShoe shoe{sim::draw_shoe(sim::ShoeClass::Deep, 7)};
  // Points grow with the square of the fineness; the usual scan of this shoe has about 560 000.
  const sim::ScannedCloud first = sim::scan_quickly(shoe, {}, SE3::Identity());
  const double finer = std::sqrt(static_cast<double>(first.points.size()) / points);
  sim::ScannedCloud made = sim::scan_quickly(
      shoe, {.profile_step_mm = 1.0 * finer, .column_step_mm = 0.073 * finer}, SE3::Identity());
  cloud::PointCloud cloud;
  cloud.points = std::move(made.points);
  return cloud;
}

/// While scanning: from the last profile to the line, and what each step of it takes on one thread.
void live(sim::ShoeClass shoe_class, bool stripe = false) {
  const sim::MadeShoe shoe{sim::draw_shoe(shoe_class, 7)};
  const sim::ScannedCloud scan = sim::scan_quickly(shoe, {.stripe = stripe}, SE3::Identity());
  const std::string name = std::string{sim::name_of(shoe_class)} + (stripe ? " with its stripe" : "");
  const cloud::StripeSpan whole{.amplitude = scan.amplitude, .width_px = scan.width_px};
  bite_line::LiveScan live_scan;
  double longest_s = 0;
  for (std::size_t first = 0; first < scan.points.size();) {
    std::size_t end = first;
    while (end < scan.points.size() && scan.profile[end] == scan.profile[first]) ++end;
    const auto begin = std::chrono::steady_clock::now();
    live_scan.add_profile(scan.profile[first], {scan.points.data() + first, end - first}, {},
                          whole.part(first, end - first));
    longest_s =
        std::max(longest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    first = end;
  }
  const Timed timed = best_of(8, [&] { return live_scan.finish({}).found; });
  std::printf(
      "{\"bench\":\"line.live\",\"what\":\"last profile to line, %s, %zu "
      "points%s\",\"ours\":%.4f,\"unit\":\"s\",\"target\":0.03,\"processor_s\":%.4f}\n",
      name.c_str(), live_scan.points(), timed.found ? "" : " (NOT FOUND)", timed.wall_s, timed.processor_s);
  std::printf(
      "{\"bench\":\"line.live\",\"what\":\"one profile, longest, %s\",\"ours\":%.6f,\"unit\":\"s\"}\n",
      name.c_str(), longest_s);
  const tbb::global_control one{tbb::global_control::max_allowed_parallelism, 1};
  std::map<std::string, double> steps_s;
  for (int round = 0; round < 8; ++round) {
    for (const report::StageTime& stage : live_scan.finish({}).stages) {
      const auto [step, is_new] = steps_s.try_emplace(stage.name, stage.seconds);
      if (!is_new) step->second = std::min(step->second, stage.seconds);
    }
  }
  for (const auto& [step, seconds] : steps_s)
    std::printf("{\"bench\":\"line.step\",\"what\":\"%s, %s, one thread\",\"ours\":%.4f,\"unit\":\"s\"}\n",
                step.c_str(), name.c_str(), seconds);
}

int run() {
  struct Size {
    double points;
    double target_s;
    int rounds;
  };
  for (const Size& size : {Size{200e3, 0.15, 5}, Size{1e6, 0.6, 3}, Size{10e6, 6.0, 2}}) {
    const cloud::PointCloud cloud = scan(size.points);
    malloc_trim(0);  // what the scanner used and freed must not hide what the extraction takes
    const PeakMemory peak;
    const Timed timed = best_of(size.rounds, [&] { return bite_line::find_bite_line(cloud, {}).found; });
    const auto points = static_cast<double>(cloud.size());
    std::printf(
        "{\"bench\":\"line.speed\",\"what\":\"cloud to line, %.0f "
        "points%s\",\"ours\":%.4f,\"unit\":\"s\",\"target\":%.2f,\"processor_s\":%.4f}\n",
        points, timed.found ? "" : " (NOT FOUND)", timed.wall_s, size.target_s, timed.processor_s);
    std::printf(
        "{\"bench\":\"line.memory\",\"what\":\"beyond the cloud itself, %.0f "
        "points\",\"ours\":%.0f,\"unit\":\"bytes/point\",\"target\":200}\n",
        points, peak.bytes() / points);
    std::fflush(stdout);
  }
  // A pump's creases climb along its shank.
  for (const sim::ShoeClass shoe_class : {sim::ShoeClass::Deep, sim::ShoeClass::Pump}) live(shoe_class);
  live(sim::ShoeClass::Deep, true);
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main() {
  return biteline::bench::run();
}
