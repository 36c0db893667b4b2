// SPDX-License-Identifier: MIT
// Does a carried line keep its bound?  Pairs of lasts that differ smoothly, made as clouds: how many points
// lie within `bound_mm` and within their own U95, by what the two scans have in common.
//   bench_transfer_bound [first seed] [pairs of each row] [all: every pair as a row of its own]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "hal/sim/shoe/random.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/last_pair.hpp"
#include "tests/support/line_distance.hpp"

namespace biteline::bench {
namespace {

using test::Collar;
using test::Waves;

/// Of all points of the pairs that got a line.
struct Tally {
  int pairs{0}, refused{0}, rim_used{0};
  double within_bound{0}, within_u95{0}, bound_sum_mm{0}, u95_sum_mm{0};
  std::vector<double> errors_mm{};
  double worst_mean_mm{0};

  void add(const Tally& other) {
    pairs += other.pairs;
    refused += other.refused;
    rim_used += other.rim_used;
    within_bound += other.within_bound;
    within_u95 += other.within_u95;
    bound_sum_mm += other.bound_sum_mm;
    u95_sum_mm += other.u95_sum_mm;
    errors_mm.insert(errors_mm.end(), other.errors_mm.begin(), other.errors_mm.end());
    worst_mean_mm = std::max(worst_mean_mm, other.worst_mean_mm);
  }
  [[nodiscard]] double mean_mm() const {
    double sum = 0;
    for (const double error_mm : errors_mm) sum += error_mm;
    return errors_mm.empty() ? 0 : sum / static_cast<double>(errors_mm.size());
  }
  [[nodiscard]] double p95_mm() const {
    if (errors_mm.empty()) return 0;
    std::vector<double> sorted = errors_mm;
    const auto at =
        sorted.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  }
  [[nodiscard]] double share(double sum) const {
    return errors_mm.empty() ? 0 : sum / static_cast<double>(errors_mm.size());
  }
};

Tally tally(const test::LastPairSettings& settings, bool tell) {
  const test::MadePair pair = test::last_pair(settings);
  const transfer::Transfer transfer =
      transfer::transfer_line({.cloud = pair.sample_cloud, .line = pair.sample_line}, pair.upper_cloud, {});
  Tally tally{.pairs = 1, .refused = transfer.found ? 0 : 1, .rim_used = transfer.alignment.rim_used ? 1 : 0};
  for (const cloud::LinePoint& p : transfer.carried.line.points) {
    const double error_mm = test::distance_mm(p.position, pair.upper_line);
    const double u95_mm = p.u95_mm.value_or(0);
    tally.errors_mm.push_back(error_mm);
    tally.within_bound += error_mm <= transfer.bound_mm ? 1 : 0;
    tally.within_u95 += error_mm <= u95_mm ? 1 : 0;
    tally.bound_sum_mm += transfer.bound_mm;
    tally.u95_sum_mm += u95_mm;
  }
  tally.worst_mean_mm = tally.mean_mm();
  if (tell) {
    const transfer::Alignment& alignment = transfer.alignment;
    std::fprintf(
        stderr,
        "  seed %3llu %-9s %-8s rms %.3f %s mean %.3f p95 %.3f bound %.3f in %.2f u95 %.2f rim %d %s%s\n",
        static_cast<unsigned long long>(settings.seed),
        test::k_collar_names[static_cast<std::size_t>(settings.collar)].data(),
        test::k_waves_names[static_cast<std::size_t>(settings.waves)].data(), settings.difference_rms_mm,
        settings.feather_seen ? "low" : "cut", tally.mean_mm(), tally.p95_mm(), transfer.bound_mm,
        tally.share(tally.within_bound), tally.share(tally.within_u95), tally.rim_used,
        alignment.weakest.words.c_str(), transfer.reason().c_str());
  }
  return tally;
}

void print(const std::string& name, const Tally& t) {
  std::fprintf(stderr, "%-22s %5d %7d %5d %7.3f %7.3f %7.3f %7.3f %6.2f %8.3f %8.3f %9.3f\n", name.c_str(),
               t.pairs, t.refused, t.rim_used, t.mean_mm(), t.worst_mean_mm, t.p95_mm(),
               t.share(t.bound_sum_mm), t.p95_mm() > 0 ? t.share(t.bound_sum_mm) / t.p95_mm() : 0,
               t.share(t.within_bound), t.share(t.within_u95), t.share(t.u95_sum_mm));
}

void print_table(const char* title, const std::map<std::string, Tally>& rows) {
  std::fprintf(stderr, "%-22s %5s %7s %5s %7s %7s %7s %7s %6s %8s %8s %9s\n", title, "pairs", "refused",
               "edge", "mean", "worst", "p95", "bound", "ratio", "in bound", "in U95", "mean U95");
  for (const auto& [name, tally] : rows) print(name, tally);
}

}  // namespace
}  // namespace biteline::bench

int main(int count, char** arguments) {
  using namespace biteline;
  using namespace biteline::bench;
  const auto number = [&](int at, int usual) { return count > at ? std::atoi(arguments[at]) : usual; };
  const int first = number(1, 1), each = number(2, 2);
  const bool tell = count > 3;
  constexpr std::array k_classes{sim::ShoeClass::Deep, sim::ShoeClass::Stitched, sim::ShoeClass::Mixed};
  std::map<std::string, Tally> by_collar, by_waves, by_class, by_feather;
  Tally all;
  for (std::size_t collar = 0; collar < test::k_collar_names.size(); ++collar) {
    for (std::size_t waves = 0; waves < test::k_waves_names.size(); ++waves) {
      for (int i = 0; i < each; ++i) {
        const auto seed = static_cast<std::uint64_t>(first + i);
        test::LastPairSettings settings{.seed = 1 + 4 * seed + waves,
                                        .waves = static_cast<Waves>(waves),
                                        .collar = static_cast<Collar>(collar),
                                        .feather_seen = true};
        sim::Random random{settings.seed * 31 + collar};
        settings.shoe_class = k_classes[static_cast<std::size_t>(random.integer(0, k_classes.size() - 1))];
        settings.feather_seen = random.chance(0.5);
        settings.difference_rms_mm = 0.15 * random.uniform({0.4, 1.1});
        const Tally one = tally(settings, tell);
        by_collar[std::string{"collar "} + test::k_collar_names[collar].data()].add(one);
        by_waves[std::string{"waves "} + test::k_waves_names[waves].data()].add(one);
        by_class[std::string{"class "} + sim::name_of(settings.shoe_class).data()].add(one);
        by_feather[settings.feather_seen ? "lower end seen" : "lower end not seen"].add(one);
        all.add(one);
      }
    }
  }
  print_table("lengths in mm", by_collar);
  for (const auto* rows : {&by_waves, &by_class, &by_feather})
    for (const auto& [name, tally] : *rows) print(name, tally);
  print("all", all);
  const auto row = [](const char* bench, const std::string& what, double ours, const char* unit) {
    std::printf("{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"%s\"}\n", bench, what.c_str(),
                ours, unit);
  };
  const std::string what = std::to_string(all.pairs) + " pairs of lasts that differ by 0.06 to 0.17 mm RMS";
  row("transfer.bound.coverage", what, all.share(all.within_bound), "share of points");
  row("transfer.bound.ratio", what + ", mean bound to 95th percentile of the errors",
      all.share(all.bound_sum_mm) / all.p95_mm(), "");
  row("transfer.u95.coverage", what, all.share(all.within_u95), "share of points");
  row("transfer.same_edge.mean", what + ", of those with one edge in view in both scans",
      by_collar["collar same"].mean_mm(), "mm");
}
