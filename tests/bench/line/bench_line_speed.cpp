// SPDX-License-Identifier: MIT
// Cloud to line: wall time and memory, for made shoes scanned with more and more points.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include <malloc.h>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "host/groove/extract.hpp"

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

cloud::PointCloud scan(double points) {
  const sim::MadeShoe shoe{sim::draw_shoe(sim::ShoeClass::Deep, 7)};
  // Points grow with the square of the fineness; the usual scan of this shoe has about 560 000.
  const sim::ScannedCloud first = sim::scan_quickly(shoe, {}, SE3::Identity());
  const double finer = std::sqrt(static_cast<double>(first.points.size()) / points);
  sim::ScannedCloud made = sim::scan_quickly(shoe, {.profile_step_mm = 1.0 * finer, .column_step_mm = 0.073 * finer}, SE3::Identity());
  cloud::PointCloud cloud;
  cloud.points = std::move(made.points);
  return cloud;
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
    double best = 1e9;
    bool found = true;
    for (int round = 0; round < size.rounds; ++round) {
      const auto begin = std::chrono::steady_clock::now();
      const groove::Extraction extraction = groove::extract(cloud, {.keep_products = false});
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      found = found && extraction.found;
    }
    const auto points = static_cast<double>(cloud.size());
    std::printf("{\"bench\":\"line.speed\",\"what\":\"cloud to line, %.0f points%s\",\"ours\":%.4f,\"unit\":\"s\",\"target\":%.2f}\n", points,
                found ? "" : " (NOT FOUND)", best, size.target_s);
    std::printf("{\"bench\":\"line.memory\",\"what\":\"beyond the cloud itself, %.0f points\",\"ours\":%.0f,\"unit\":\"bytes/point\",\"target\":200}\n",
                points, peak.bytes() / points);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main() { return biteline::bench::run(); }
