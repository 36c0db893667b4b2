// SPDX-License-Identifier: MIT
// Does U95 hold the true line with 95 %, and is confidence the probability of 0.3 mm?  Made shoes of all
// classes, each scanned by a head of its own that is not known exactly.
//
// --points: what the model of a point's error is fitted to (fit_spread.py), one row for each station.
// One head scans all points of a shoe, so they are off together: shoes are drawn anew for the intervals.
// The last two stand apart: designed soles that wrap up over the toe (`guard`), and such with a sector
// missing on a flank of the guard (`hidden`).  `steep` are points of both where the line climbs by more than
// 30 degrees.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/bite_line/live_scan.hpp"
#include "tests/bench/line/drawn_anew.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::bench {
namespace {

constexpr double k_confident_mm = 0.3;

/// From the nearest place of the closed line to a point.
Vec3 offset_mm(const Vec3& point, const cloud::ClosedLine& line) {
  Vec3 best = Vec3::Constant(1e9);
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Vec3& a = line.points[i].position;
    const Vec3 d = line.points[(i + 1) % line.points.size()].position - a;
    const double share = std::clamp((point - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    const Vec3 offset = point - (a + share * d);
    if (offset.squaredNorm() < best.squaredNorm()) best = offset;
  }
  return best;
}

struct Tenth {
  double claimed{0}, held{0}, points{0};
};

struct Tally {
  int shoes{0}, refused{0}, wrong{0};
  double within{0}, u95_sum_mm{0};
  std::vector<ShoeShare> lines{};  ///< points within their U95
  std::vector<double> errors_mm{};
  std::array<Tenth, 10> tenths{};

  void add(double error_mm, double u95_mm, double confidence) {
    errors_mm.push_back(error_mm);
    within += error_mm <= u95_mm ? 1 : 0;
    u95_sum_mm += u95_mm;
    Tenth& tenth = tenths.at(static_cast<std::size_t>(std::clamp(confidence * 10, 0.0, 9.0)));
    tenth.claimed += confidence;
    tenth.held += error_mm <= k_confident_mm ? 1 : 0;
    tenth.points += 1;
  }
  void add(const Tally& other) {
    shoes += other.shoes;
    refused += other.refused;
    wrong += other.wrong;
    within += other.within;
    lines.insert(lines.end(), other.lines.begin(), other.lines.end());
    u95_sum_mm += other.u95_sum_mm;
    errors_mm.insert(errors_mm.end(), other.errors_mm.begin(), other.errors_mm.end());
    for (std::size_t i = 0; i < tenths.size(); ++i) {
      tenths.at(i).claimed += other.tenths.at(i).claimed;
      tenths.at(i).held += other.tenths.at(i).held;
      tenths.at(i).points += other.tenths.at(i).points;
    }
  }
  [[nodiscard]] double per_point(double sum) const {
    return errors_mm.empty() ? 0 : sum / static_cast<double>(errors_mm.size());
  }
  [[nodiscard]] double mean_mm() const {
    double sum = 0;
    for (const double error_mm : errors_mm) sum += error_mm;
    return per_point(sum);
  }
  [[nodiscard]] double p95_mm() const {
    if (errors_mm.empty()) return 0;
    std::vector<double> sorted = errors_mm;
    const auto at =
        sorted.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  }
};

/// One row for each station: class, seed, what it measured, and its error outwards and up.
void write_points(std::ostream& out, const std::string& row, const bite_line::Workings& workings,
                  const bite_line::Extraction& found, const cloud::ClosedLine& truth) {
  const auto& placed = workings.placed.points;
  for (std::size_t i = 0; i < placed.size(); i += 4) {
    const bite_line::PlacedStation& p = placed[i];
    const Vec3 offset =
        found.T_base_shoe.linear().transpose() * offset_mm(found.T_base_shoe * p.position, truth);
    const Vec3 along =
        (placed[(i + 1) % placed.size()].position - placed[(i + placed.size() - 1) % placed.size()].position)
            .normalized();
    const Vec3 outwards = along.cross(Vec3::UnitZ()).normalized();
    char text[300];
    std::snprintf(text, sizeof text, "%s,%.6f,%.4f,%.5f,%.5f,%.4f,%.4f,%.3f,%.5f,%.5f,%d\n", row.c_str(),
                  p.noise.outward_mm, p.noise.slope, p.scatter_mm, p.doubt, p.sharp, p.hold, p.other_mm,
                  offset.dot(outwards), offset.z(), p.to_visible_mm > 0 ? 1 : 0);
    out << text;
  }
}

void tell_row(const char* bench, const std::string& what, double ours, const char* unit) {
  std::printf("{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"%s\"}\n", bench, what.c_str(), ours,
              unit);
}

void tell(const std::string& what, const Tally& t) {
  const std::array<double, 2> about = drawn_anew(t.lines);
  std::printf(
      "{\"bench\":\"line.u95.coverage\",\"what\":\"%s\",\"ours\":%.4f,\"interval\":[%.4f,%.4f],"
      "\"unit\":\"share of points\"}\n",
      what.c_str(), t.per_point(t.within), about[0], about[1]);
  tell_row("line.u95.ratio", what + ", mean U95 to 95th percentile of the errors",
           t.per_point(t.u95_sum_mm) / std::max(t.p95_mm(), 1e-9), "");
}

/// A row of the table.
struct Class {
  std::string name;
  bool apart{false};  ///< not among all: a class of hard cases
  std::function<test::UncertainScanSettings(std::uint64_t seed)> settings;
};

/// All classes with a line; those whose sole is drawn from a formula in turn with a sector missing; and
/// designed soles with a guard on the toe.
std::vector<Class> classes() {
  constexpr auto k_classes = static_cast<std::size_t>(sim::ShoeClass::Bare);
  const auto sector_mm = [](std::uint64_t seed) { return 8 + static_cast<double>(seed * 7 % 33); };
  std::vector<Class> all;
  for (std::size_t c = 0; c < sim::k_first_thing; ++c) {
    if (static_cast<sim::ShoeClass>(c) == sim::ShoeClass::Bare) continue;
    all.push_back({.name = std::string{sim::k_shoe_class_names[c]}, .settings = [c](std::uint64_t seed) {
                     return test::UncertainScanSettings{.shoe_class = static_cast<sim::ShoeClass>(c),
                                                        .seed = seed};
                   }});
  }
  all.push_back({.name = "sector", .settings = [sector_mm](std::uint64_t seed) {
                   return test::UncertainScanSettings{
                       .shoe_class = static_cast<sim::ShoeClass>(seed % k_classes),
                       .seed = seed + 1000,
                       .missing_mm = sector_mm(seed)};
                 }});
  for (const bool hidden : {false, true}) {
    all.push_back({.name = hidden ? "hidden" : "guard",
                   .apart = true,
                   .settings = [hidden, sector_mm](std::uint64_t seed) {
                     constexpr std::size_t k_designed = sim::k_first_thing - sim::k_first_designed;
                     return test::UncertainScanSettings{
                         .shoe_class = static_cast<sim::ShoeClass>(sim::k_first_designed + seed % k_designed),
                         .seed = seed + 2000,
                         .missing_mm = hidden ? sector_mm(seed) : 0,
                         .toe_guard = true};
                   }});
  }
  return all;
}

void print(const std::string& name, const Tally& t) {
  std::fprintf(
      stderr, "%-10s %4d shoes %3d refused %3d wrong  mean %.4f  p95 %.4f  U95 %.4f  ratio %.2f  within %.4f",
      name.c_str(), t.shoes, t.refused, t.wrong, t.mean_mm(), t.p95_mm(), t.per_point(t.u95_sum_mm),
      t.per_point(t.u95_sum_mm) / std::max(t.p95_mm(), 1e-9), t.per_point(t.within));
  if (t.lines.size() > 1) {
    const std::array<double, 2> about = drawn_anew(t.lines);
    std::fprintf(stderr, " (%.4f to %.4f)", about[0], about[1]);
  }
  std::fprintf(stderr, "\n");
}

struct Asked {
  std::uint64_t seeds{6}, from{1};
  std::string only{}, points_file{};
  double step_mm{1};
  bool exact{false}, rows{false};
};

int run(const Asked& asked) {
  std::ofstream points;
  if (!asked.points_file.empty()) {
    points.open(asked.points_file);
    points << "class,seed,outward_mm,slope,scatter_mm,doubt,sharp,hold,other_mm,error_out_mm,"
              "error_up_mm,bridged\n";
  }
  Tally all, steep, bridged;
  double least_class = 1;
  bool any = false;
  for (const Class& kind : classes()) {
    if (!asked.only.empty() && asked.only != kind.name) continue;
    any = true;
    Tally tally;
    for (std::uint64_t seed = asked.from; seed < asked.from + asked.seeds; ++seed) {
      test::UncertainScanSettings settings = kind.settings(seed);
      settings.profile_step_mm = asked.step_mm;
      settings.errors = asked.exact ? 0 : 1;
      const test::UncertainScan made = test::uncertain_scan(settings);
      std::optional<bite_line::Workings> workings;
      const bite_line::Extraction found = test::line_of(made, &workings);
      ++tally.shoes;
      if (!found.found) {
        ++tally.refused;
        continue;
      }
      Tally one;
      one.wrong =
          test::judge({.cloud = {}, .truth = made.truth}, found).judged == test::Judged::Wrong ? 1 : 0;
      for (const cloud::LinePoint& p : found.line.points) {
        const double error_mm = offset_mm(p.position, made.truth).norm();
        one.add(error_mm, p.u95_mm.value_or(0), p.confidence);
        if (kind.apart && p.source == cloud::PointSource::Bridged)
          bridged.add(error_mm, p.u95_mm.value_or(0), p.confidence);
        constexpr double k_steep = 0.5;  // sine of 30 degrees
        if (kind.apart && std::abs(p.tangent.z()) > k_steep)
          steep.add(error_mm, p.u95_mm.value_or(0), p.confidence);
      }
      if (points.is_open())
        write_points(points, kind.name + "," + std::to_string(seed), *workings, found, made.truth);
      if (asked.rows) print(kind.name + " " + std::to_string(seed), one);
      one.lines = {{.part = one.within, .whole = static_cast<double>(one.errors_mm.size())}};
      tally.add(one);
    }
    print(kind.name, tally);
    if (kind.apart) {
      tell(kind.name + ": " + std::to_string(tally.shoes) + " made shoes with a toe guard", tally);
      continue;
    }
    if (!tally.errors_mm.empty()) least_class = std::min(least_class, tally.per_point(tally.within));
    all.add(tally);
  }
  if (!any) {
    std::fprintf(stderr, "no class %s\n", asked.only.c_str());
    return 2;
  }
  const std::string what =
      std::to_string(all.shoes) + " made shoes, " + (asked.exact ? "heads exact" : "each head known so far");
  if (all.shoes > 0) {
    print("all", all);
    tell(what, all);
    tell_row("line.u95.coverage", what + ", least class", least_class, "share of points");
  }
  if (!steep.errors_mm.empty()) {
    print("steep", steep);
    print("bridged", bridged);
    tell("made shoes with a toe guard, where they climb by more than 30 degrees", steep);
  }
  for (const Tenth& tenth : all.tenths) {
    if (tenth.points < 1) continue;
    std::printf(
        "{\"bench\":\"line.confidence\",\"what\":\"%s: share within 0.3 mm of points that claim %.3f\","
        "\"ours\":%.4f,\"unit\":\"share\",\"target\":%.4f,\"points\":%.0f}\n",
        what.c_str(), tenth.claimed / tenth.points, tenth.held / tenth.points, tenth.claimed / tenth.points,
        tenth.points);
  }
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  namespace bench = biteline::bench;
  bench::Asked asked;
  biteline::options::Command command{"Does U95 hold the true line?  Made shoes of all classes, a head each",
                                     "bench_line_u95"};
  command.add_option("--seeds", asked.seeds, "so many shoes of each class")->capture_default_str();
  command.add_option("--from", asked.from, "the first seed")->capture_default_str();
  command.add_option("--class", asked.only, "this class alone");
  command.add_option("--step", asked.step_mm, "between profiles, mm")->capture_default_str();
  command.add_option("--points", asked.points_file, "a row for each station goes to this file");
  command.add_flag("--exact", asked.exact, "calibration, poses and clock without error");
  command.add_flag("--rows", asked.rows, "a row for each shoe, on stderr");
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  return bench::run(asked);
}
