// SPDX-License-Identifier: MIT
// Made shoes that are held and looked at again: untouched, nudged by 0.3 mm, turned by as much at the line,
// exchanged by another piece of the same model and size in the same place.
//   bench_moved [first seed] [shoes]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/shoe/random.hpp"
#include "host/transfer/moved.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::bench {
namespace {

using transfer::Moved;

constexpr double k_nudge_mm = 0.3, k_last_difference_mm = 0.15;
constexpr std::array k_classes{sim::ShoeClass::Deep,      sim::ShoeClass::Shallow,    sim::ShoeClass::Step,
                               sim::ShoeClass::Decorated, sim::ShoeClass::Stitched,   sim::ShoeClass::Glossy,
                               sim::ShoeClass::Cupsole,   sim::ShoeClass::Vulcanised, sim::ShoeClass::Midsole,
                               sim::ShoeClass::Boot};

enum Case : std::size_t { Untouched, Nudged, Turned, Exchanged, Cases };
constexpr std::array k_names{"untouched", "nudged", "turned", "exchanged"};

struct Tally {
  std::array<int, 4> told{};             ///< as Moved::Verdict
  std::optional<int> true_within_u95{};  ///< none: the truth is no motion
  std::vector<double> shift_mm{}, u95_mm{}, unexplained_mm{};

  void add(const Moved& moved, std::optional<double> true_mm) {
    ++told[static_cast<std::size_t>(moved.verdict)];
    if (moved.u95_mm <= 0) return;  // nothing to be measured
    shift_mm.push_back(moved.shift_mm);
    u95_mm.push_back(moved.u95_mm);
    unexplained_mm.push_back(moved.unexplained_mm);
    if (!true_mm) return;
    const int within = std::abs(moved.shift_mm - *true_mm) <= moved.u95_mm ? 1 : 0;
    true_within_u95 = true_within_u95.value_or(0) + within;
  }
};

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print(const char* name, const Tally& tally) {
  std::printf("%-10s %7d %6d %6d %9d   %6.3f %6.3f   %6.3f %6.3f   %6.3f %6.3f   %s\n", name, tally.told[0],
              tally.told[1], tally.told[2], tally.told[3], at_share(tally.shift_mm, 0.5),
              at_share(tally.shift_mm, 1), at_share(tally.u95_mm, 0.5), at_share(tally.u95_mm, 1),
              at_share(tally.unexplained_mm, 0.5), at_share(tally.unexplained_mm, 1),
              tally.true_within_u95 ? std::to_string(*tally.true_within_u95).c_str() : "-");
}

cloud::PointCloud moved_by(cloud::PointCloud cloud, const SE3& T) {
  for (Eigen::Vector3f& p : cloud.points) p = (T * p.cast<double>()).cast<float>();
  return cloud;
}

SE3 nudge(sim::Random& random) {
  SE3 T = SE3::Identity();
  const double way_rad = random.uniform({0, 2 * std::numbers::pi});
  T.translation() = k_nudge_mm * Vec3{std::cos(way_rad), std::sin(way_rad), 0};
  return T;
}

/// About the upright through its middle: the line's farthest place moves by the nudge.
SE3 turn(const std::vector<Vec3>& line, sim::Random& random) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : line) middle += p / static_cast<double>(line.size());
  double farthest_mm = 0;
  for (const Vec3& p : line) farthest_mm = std::max(farthest_mm, (p - middle).head<2>().norm());
  const double by_rad = (random.chance(0.5) ? 1 : -1) * k_nudge_mm / farthest_mm;
  SE3 T = SE3::Identity();
  T.linear() = Eigen::AngleAxisd(by_rad, Vec3::UnitZ()).toRotationMatrix();
  T.translation() = middle - T.linear() * middle;
  return T;
}

void run(std::uint64_t first, int shoes) {
  std::array<Tally, Cases> tallies{};
  for (int i = 0; i < shoes; ++i) {
    test::UncertainScanSettings settings{
        .shoe_class = k_classes[static_cast<std::size_t>(i) % k_classes.size()],
        .seed = first + static_cast<std::uint64_t>(i)};
    const test::UncertainScan held = test::uncertain_scan(settings);
    std::vector<Vec3> line;
    for (const cloud::LinePoint& p : held.truth.points) line.push_back(p.position);
    sim::Random random{settings.seed};
    settings.again = settings.seed + 1'000'000;
    const cloud::PointCloud look = test::uncertain_scan(settings).cloud;
    settings.last_difference_mm = k_last_difference_mm;
    const cloud::PointCloud other = test::uncertain_scan(settings).cloud;
    const auto judge = [&](Case which, const cloud::PointCloud& cloud, std::optional<double> true_mm) {
      const Moved moved = transfer::moved_since(held.cloud, cloud, line);
      tallies[which].add(moved, true_mm);
      std::fprintf(stderr, "%d %s: %s\n", i, k_names[which], moved.words.c_str());
    };
    judge(Untouched, look, 0);
    judge(Nudged, moved_by(look, nudge(random)), k_nudge_mm);
    judge(Turned, moved_by(look, turn(line, random)), k_nudge_mm);
    judge(Exchanged, other, std::nullopt);
  }
  std::printf(
      "%d shoes        told as                       shift [mm]      U95 [mm]        unexplained     shift\n",
      shoes);
  std::printf(
      "           unmoved  moved  other  not seen   median   most   median   most   median   most   within "
      "U95\n");
  for (std::size_t which = 0; which < Cases; ++which) print(k_names[which], tallies[which]);
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  biteline::bench::run(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 7001,
                       argc > 2 ? std::atoi(argv[2]) : 20);
}
