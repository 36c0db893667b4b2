// SPDX-License-Identifier: MIT
// How soon a drifted calibration is named, and how often a sound one is called drifted: shoes on an elastic
// arm, scanned with a check lap by exact rays.
//
//     bench_drift [SOUND SHOES [TRIALS [SPEED]]]
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "host/calibration/drift/watch.hpp"
#include "tests/support/drift_scan.hpp"

namespace biteline::bench {
namespace {

constexpr int k_learnt = 30, k_bar = 5, k_most = 12;

int number_of(int argc, char** argv, int at, int otherwise) {
  if (argc <= at) return otherwise;
  int value = otherwise;
  std::from_chars(argv[at], argv[at] + std::strlen(argv[at]), value);
  return value;
}

/// A cell's shoes, one after the other.
class Shoes {
 public:
  Shoes(std::vector<test::DriftCell> cells, std::uint64_t seed) : cells_{std::move(cells)}, seed_{seed} {}
  void next(drift::Watch& watch, const drift::Vector& drifted = drift::Vector::Zero()) {
    const test::DriftCell& cell = cells_[count_ % cells_.size()];
    const test::DriftScan scan = cell.scan({.drifted = drifted, .seed = seed_ * 100'000 + count_});
    const auto evidence = drift::look_at(scan.view(), cell.calibrated());
    const std::string name = std::to_string(++count_);
    if (evidence) {
      watch.take(name, *evidence);
    } else {
      watch.pass(name);
    }
  }
  [[nodiscard]] drift::Evidence evidence() const {
    const auto evidence = drift::look_at(cells_.front().scan({}).view(), cells_.front().calibrated());
    return evidence ? *evidence : drift::Evidence{};
  }

 private:
  std::vector<test::DriftCell> cells_;
  std::uint64_t seed_;
  std::uint64_t count_{0};
};

void print(const std::string& bench, const std::string& what, double ours, double bar, const char* unit) {
  std::printf(
      "{\"bench\":\"drift.%s\",\"what\":\"%s\",\"ours\":%.4g,\"peer\":\"bar\",\"peer_value\":%.4g,"
      "\"unit\":\"%s\",\"ratio\":%.4g,\"target\":1}\n",
      bench.c_str(), what.c_str(), ours, bar, unit, bar > 0 ? ours / bar : ours);
  std::fflush(stdout);
}

void name_faults(Shoes& shoes, const drift::Watch& learnt, const std::string& cell, int trials) {
  for (int i = 0; i < drift::k_quantities; ++i) {
    const drift::Quantity& quantity = drift::k_table.at(static_cast<std::size_t>(i));
    const std::string part{drift::k_part_names.at(static_cast<std::size_t>(quantity.part))};
    int in_time = 0, right = 0, alone = 0, after_sum = 0;
    for (int trial = 0; trial < trials; ++trial) {
      drift::Watch watch = learnt;
      const drift::Vector drifted = (trial % 2 == 0 ? 1 : -1) * drift::Vector::Unit(i);
      int after = 0;
      while (after < k_most && watch.verdict().status != drift::Status::Drifted) {
        shoes.next(watch, drifted);
        ++after;
      }
      after_sum += after;
      const drift::Verdict& verdict = watch.verdict();
      if (verdict.status != drift::Status::Drifted) continue;
      in_time += after <= k_bar ? 1 : 0;
      const std::string words = drift::words_of(*verdict.named);
      right += words.find(part) != std::string::npos ? 1 : 0;
      alone += words == part ? 1 : 0;
    }
    const std::string what = cell + ": " + std::string(quantity.name) + " off by " +
                             std::to_string(quantity.size).substr(0, 4) + " " + std::string(quantity.unit);
    const double share = 1.0 / trials;
    print("shoes_until_told", what, after_sum * share, k_bar, "shoes");
    print("told_within_five", what, in_time * share, 1, "share");
    print("right_part_named", what, right * share, 1, "share");
    print("named_alone", what, alone * share, 1, "share");
  }
}

void run(const std::string& cell, std::vector<test::DriftCell> cells, int sound, int trials) {
  print("scan_s", cell, cells.front().duration_s(), 0, "s");
  const test::DriftScan whole = cells.front().scan({.only_lap = false});
  const auto begun = std::chrono::steady_clock::now();
  const auto looked = drift::look_at(whole.view(), cells.front().calibrated());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  print("look_s", cell + ": " + std::to_string(looked ? looked->pairs : 0) + " places", took.count(), 0, "s");
  Shoes shoes(std::move(cells), 1);
  for (const std::string& unseen : drift::blind_of(shoes.evidence()).unseen)
    print("cannot_see", cell + ": " + unseen, 1, 0, "");
  drift::Watch watch;
  for (int i = 0; i < k_learnt; ++i) shoes.next(watch);
  name_faults(shoes, watch, cell, trials);
  int alarms = 0;
  for (int i = 0; i < sound; ++i) {
    shoes.next(watch);
    if (watch.verdict().status != drift::Status::Drifted) continue;
    ++alarms;
    std::fprintf(stderr, "%s: alarm after %d shoes: %s\n", cell.c_str(), watch.verdict().shoes,
                 watch.verdict().words.c_str());
    watch = drift::Watch{};
  }
  print("false_alarms", cell + ": " + std::to_string(sound) + " sound shoes", alarms, 0, "");
}

int run_all(int argc, char** argv) {
  const int sound = number_of(argc, argv, 1, 1000), trials = number_of(argc, argv, 2, 10);
  const double speed_mm_s = number_of(argc, argv, 3, 250);
  std::vector<test::DriftCell> cells;
  const auto plain = test::DriftCell::make({.speed_mm_s = speed_mm_s, .check = {}});
  if (plain) print("scan_s", "without a check lap", plain->duration_s(), 0, "s");
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto made = test::DriftCell::make({.shoe_seed = seed, .speed_mm_s = speed_mm_s});
    if (!made) {
      std::fprintf(stderr, "%s\n", to_line(made.error()).c_str());
      return 1;
    }
    cells.push_back(std::move(*made));
  }
  run("one model", {cells.front()}, sound, trials);
  run("four models in turn", cells, sound, trials);
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run_all(argc, argv);
}
