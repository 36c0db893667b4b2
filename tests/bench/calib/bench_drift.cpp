// SPDX-License-Identifier: MIT
// How soon a drifted calibration is named, and how often a sound one is called drifted: shoes on an elastic
// arm, scanned with a check lap by exact rays, with noise of pixels and poses drawn anew for each shoe.
//
//     bench_drift [SOUND SHOES [TRIALS [SPEED [takt]]]]
//
// takt: scanned as the takt does, from the waist and clockwise.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/shoe/random.hpp"
#include "host/calibration/drift/watch.hpp"
#include "tests/support/drift_scan.hpp"

namespace biteline::bench {
namespace {

constexpr int k_learnt = 30, k_bar = 5, k_most = 12;
/// Rays are shot once for each of so many places where a fixture lets a shoe stand.
constexpr int k_places = 6;

int number_of(int argc, char** argv, int at, int otherwise) {
  if (argc <= at) return otherwise;
  int value = otherwise;
  std::from_chars(argv[at], argv[at] + std::strlen(argv[at]), value);
  return value;
}

/// As a fixture lets it: some tenths of a millimetre and of a degree.
SE3 put_by(sim::Random& random) {
  Twist xi = Twist::Zero();
  xi[0] = random.gaussian() * 0.5;
  xi[1] = random.gaussian() * 0.5;
  xi[5] = random.gaussian() * 0.3 * std::numbers::pi / 180;
  return geometry::exp_se3(xi);
}

/// A cell's shoes, one after the other.
class Shoes {
 public:
  using Looks = std::vector<test::DriftCell::Look>;

  Shoes(std::vector<test::DriftCell> cells, std::uint64_t seed) : cells_{std::move(cells)}, random_{seed} {
    sound_ = looks_of(drift::Vector::Zero());
  }
  /// Rays of this drift, for each model in each place.
  [[nodiscard]] std::vector<Looks> looks_of(const drift::Vector& drifted) {
    sim::Random places{7};
    std::vector<Looks> looks;
    for (int place = 0; place < k_places; ++place)
      for (const test::DriftCell& cell : cells_)
        looks.push_back(cell.looks({.drifted = drifted, .T_shoe_put = put_by(places)}));
    return looks;
  }
  void next(drift::Watch& watch) { next(watch, sound_, 0); }
  void next(drift::Watch& watch, const std::vector<Looks>& looks, double late_s) {
    const test::DriftCell& cell = cells_[count_ % cells_.size()];
    // Places come by chance, models in turn.
    const auto place = static_cast<std::size_t>(random_.uniform({0, k_places - 1e-9}));
    const test::DriftScan scan = cell.scan(looks[place * cells_.size() + count_ % cells_.size()],
                                           {.late_s = late_s, .seed = 1'000'003 * (count_ + 1)});
    const auto evidence = drift::look_at(scan.view(), cell.calibrated());
    const std::string model = std::to_string(count_ % cells_.size()), name = std::to_string(++count_);
    if (evidence) {
      watch.take(name, *evidence, model);
    } else {
      watch.pass(name);
    }
  }
  [[nodiscard]] test::DriftScan first() const { return cells_.front().scan(sound_.front(), {}); }
  [[nodiscard]] const test::DriftCell& cell() const { return cells_.front(); }

 private:
  std::vector<test::DriftCell> cells_;
  sim::Random random_;
  std::vector<Looks> sound_;
  std::uint64_t count_{0};
};

void print(const std::string& bench, const std::string& what, double ours, double bar, const char* unit) {
  std::printf(
      "{\"bench\":\"drift.%s\",\"what\":\"%s\",\"ours\":%.4g,\"peer\":\"bar\",\"peer_value\":%.4g,"
      "\"unit\":\"%s\",\"ratio\":%.4g,\"target\":1}\n",
      bench.c_str(), what.c_str(), ours, bar, unit, bar > 0 ? ours / bar : ours);
  std::fflush(stdout);
}

struct Told {
  int in_time{0}, right{0}, alone{0}, shoes{0};
};

Told name_fault(Shoes& shoes, const drift::Watch& learnt, int quantity, int trials) {
  const std::string part{drift::k_part_names.at(
      static_cast<std::size_t>(drift::k_table.at(static_cast<std::size_t>(quantity)).part))};
  Told told;
  for (const double sign : {1.0, -1.0}) {
    const drift::Vector drifted = sign * drift::Vector::Unit(quantity);
    const auto looks = shoes.looks_of(drifted);
    const double late_s = drift::parameters_of(drifted)[uncertainty::k_clock_at];
    for (int trial = sign > 0 ? 0 : 1; trial < trials; trial += 2) {
      drift::Watch watch = learnt;
      int after = 0;
      while (after < k_most && watch.verdict().status != drift::Status::Drifted) {
        shoes.next(watch, looks, late_s);
        ++after;
      }
      told.shoes += after;
      if (watch.verdict().status != drift::Status::Drifted) continue;
      told.in_time += after <= k_bar ? 1 : 0;
      // Each shoe of the drift sharpens the name.
      for (int shoe = after; shoe < k_bar; ++shoe) shoes.next(watch, looks, late_s);
      const std::string words = drift::words_of(*watch.verdict().named);
      std::fprintf(stderr, "%s %+.0f: %d shoes: %s\n",
                   std::string(drift::k_table.at(static_cast<std::size_t>(quantity)).name).c_str(), sign,
                   after, watch.verdict().words.c_str());
      told.right += words.find(part) != std::string::npos ? 1 : 0;
      told.alone += words == part ? 1 : 0;
    }
  }
  return told;
}

void name_faults(Shoes& shoes, const drift::Watch& learnt, const std::string& cell, int trials) {
  for (int i = 0; i < drift::k_head_quantities; ++i) {
    const drift::Quantity& quantity = drift::k_table.at(static_cast<std::size_t>(i));
    const Told told = name_fault(shoes, learnt, i, trials);
    const std::string what = cell + ": " + std::string(quantity.name) + " off by " +
                             std::to_string(quantity.size).substr(0, 4) + " " + std::string(quantity.unit);
    const double share = 1.0 / trials;
    print("shoes_until_told", what, told.shoes * share, k_bar, "shoes");
    print("told_within_five", what, told.in_time * share, 1, "share");
    print("right_part_named", what, told.right * share, 1, "share");
    print("named_alone", what, told.alone * share, 1, "share");
  }
}

void run(const std::string& cell, std::vector<test::DriftCell> cells, int sound, int trials) {
  const bool several = cells.size() > 1;
  Shoes shoes(std::move(cells), 1);
  const test::DriftScan first = shoes.first();
  const auto begun = std::chrono::steady_clock::now();
  const auto looked = drift::look_at(first.view(), shoes.cell().calibrated());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  if (!looked) {
    std::fprintf(stderr, "%s: %s\n", cell.c_str(), to_line(looked.error()).c_str());
    return;
  }
  print("look_s", cell + ": " + std::to_string(looked->pairs) + " places", took.count(), 0, "s");
  const drift::Blind blind = drift::blind_of(*looked);
  for (const std::string& unseen : blind.unseen) print("cannot_see", cell + ": " + unseen, 1, 0, "");
  for (const std::string& mistaken : blind.mistaken)
    print("cannot_tell_apart", cell + ": " + mistaken, 1, 0, "");
  drift::Watch watch;
  // Each model's first shoes tell what is usual of it.
  const int learnt = k_learnt + (several ? k_learnt : 0);
  for (int i = 0; i < learnt; ++i) shoes.next(watch);
  if (trials > 0) name_faults(shoes, watch, cell, trials);
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

Result<std::vector<test::DriftCell>> cells_of(double speed_mm_s, bool takt, bool table) {
  std::vector<test::DriftCell> cells;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    BITELINE_ASSIGN(
        test::DriftCell made,
        test::DriftCell::make({.shoe_seed = seed, .speed_mm_s = speed_mm_s, .takt = takt, .table = table}));
    if (table) {
      BITELINE_ASSIGN(
          const test::DriftCell plain,
          test::DriftCell::make({.shoe_seed = seed, .speed_mm_s = speed_mm_s, .takt = takt, .check = {}}));
      const std::string what = "model " + std::to_string(seed);
      constexpr double k_longer_s = 0.3;
      print("scan_s", what, made.rest_to_rest_s(), plain.rest_to_rest_s(), "s");
      print("lap_s", what + ": from rest to rest", made.rest_to_rest_s() - plain.rest_to_rest_s(), k_longer_s,
            "s");
      print("lap_s", what + ": until the last profile", made.last_profile_s() - plain.last_profile_s(),
            k_longer_s, "s");
    }
    cells.push_back(std::move(made));
  }
  return cells;
}

int run_all(int argc, char** argv) {
  const int sound = number_of(argc, argv, 1, 1000), trials = number_of(argc, argv, 2, 10);
  const double speed_mm_s = number_of(argc, argv, 3, 250);
  const bool takt = argc > 4 && std::string_view{argv[4]} == "takt";
  for (const bool table : {true, false}) {
    auto cells = cells_of(speed_mm_s, takt, table);
    if (!cells) {
      std::fprintf(stderr, "%s\n", to_line(cells.error()).c_str());
      return 1;
    }
    const std::string words = table ? "on a table" : "no table in view";
    run("one model, " + words, {cells->front()}, sound, trials);
    run("four models in turn, " + words, std::move(*cells), sound, trials);
  }
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run_all(argc, argv);
}
