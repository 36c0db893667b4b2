// SPDX-License-Identifier: MIT
// The tool's true tip on the true bite line, the whole chain in one process and in no time of its own: a made
// shoe, pictures with true speckle, a head as its calibration knows it, an arm with links of its own that
// gives, a tip taught by touching, the line, the path, the simulated controller's program, the arm that
// follows it.  The host's parts never see what is true.
//
// Drawn, and not run: the calibrated camera, laser plane and clock (as calibrations of made heads state
// them), what its maker's calibration leaves of an arm's links, a hand's touch.
//
// A shoe takes some 10 s of a core, half of it with --own alone, one with a budget some 25 s.  --rows: one
// for each shoe, process and variant, with the bound that was stated before, its parts, and the largest
// distance that came of it.  bound_factor.py makes the bound's factor of them.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>

#include "host/geometry/robust.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/bench/tip/tally.hpp"

namespace biteline::bench {
namespace {

constexpr std::array k_processes{"spray", "grind"};

struct Options {
  std::uint64_t shoes{3}, seed{1}, from{0}, budget{1};
  double speed_mm_s{250}, rate_hz{100}, work_speed_ratio{1}, minutes{0};
  std::string shoe_class{}, rows{}, along{};
  bool own{false};
};

/// All that have a line, one after the other.
std::vector<sim::ShoeClass> classes() {
  std::vector<sim::ShoeClass> all;
  for (auto k = static_cast<int>(sim::ShoeClass::Deep); k <= static_cast<int>(sim::ShoeClass::Wedge); ++k) {
    const auto shoe_class = static_cast<sim::ShoeClass>(k);
    if (shoe_class != sim::ShoeClass::Bare) all.push_back(shoe_class);
  }
  return all;
}

struct TipShoe {
  std::uint64_t index;
  sim::ShoeClass shoe_class;
  std::uint64_t seed;

  [[nodiscard]] std::string class_name() const { return std::string{sim::name_of(shoe_class)}; }
  [[nodiscard]] sim::ShoeParameters drawn() const {
    const double length_mm = sim::length_of_size_mm(sim::Random{seed}.fork(9).integer(36, 46));
    if (!sim::is_designed(shoe_class)) return sim::draw_shoe(shoe_class, seed, length_mm);
    return sim::draw_designed_shoe({.shoe_class = shoe_class, .length_mm = length_mm}, seed);
  }
};

/// Which table a variant is in, and what it is called there.
struct TableRow {
  std::string table;
  Variant variant;
};

std::vector<TableRow> rows_of_all() {
  return {{"class", {.name = "as in life"}},
          {"arm", {.name = "nominal, controller and host", .reckoning = Reckoning::Nominal}}};
}

std::vector<TableRow> rows_of_budget() {
  std::vector<TableRow> rows{{"arm", {.name = "nominal, host alone", .reckoning = Reckoning::NominalHost}},
                             {"budget", {.name = "as in life"}},
                             {"budget", {.name = "nothing off", .sources = no_sources()}}};
  for (const NamedSource& source : k_sources) {
    Sources alone = no_sources(), without;
    alone.*source.is_on = true;
    without.*source.is_on = false;
    rows.push_back({"budget", {.name = std::string{source.name} + " alone", .sources = alone}});
    rows.push_back({"budget", {.name = "without " + std::string{source.name}, .sources = without}});
  }
  return rows;
}

class TipBench {
 public:
  explicit TipBench(const Options& options) : options_{options} {
    if (!options.rows.empty()) file_.reset(std::fopen(options.rows.c_str(), "w"));
    if (!options.along.empty()) along_.reset(std::fopen(options.along.c_str(), "w"));
    if (along_) std::fprintf(along_.get(), "shoe,process,variant,off_mm\n");
    if (file_)
      std::fprintf(
          file_.get(),
          "shoe,class,speed_mm_s,table,variant,process,line_u95_mm,give_mm,tip_u95_mm,sum_mm,bound_mm,"
          "line_s,p95_mm,max_mm,waits,refused\n");
  }

  Result<void> run() {
    for (const char* name : k_processes) {
      BITELINE_ASSIGN(path::Process process, path::read_process(std::filesystem::path{BITELINE_PROCESSES} /
                                                                (std::string{name} + ".yaml")));
      process.motion.speed_mm_s *= options_.work_speed_ratio;
      processes_.push_back(std::move(process));
    }
    const std::vector<sim::ShoeClass> all = classes();
    for (std::uint64_t i = options_.from; i < options_.from + options_.shoes; ++i) {
      if (out_of_time()) {
        std::fprintf(stderr, "bench_tip: out of time before shoe %llu\n", static_cast<unsigned long long>(i));
        break;
      }
      const TipShoe shoe{.index = i, .shoe_class = all[i % all.size()], .seed = options_.seed * 10'000 + i};
      if (!options_.shoe_class.empty() && options_.shoe_class != shoe.class_name()) continue;
      if (const Result<void> made = make(shoe, i < options_.from + options_.budget); !made) {
        ++not_made_;
        std::fprintf(stderr, "%3llu %s: %s\n", static_cast<unsigned long long>(i), shoe.class_name().c_str(),
                     to_line(made.error()).c_str());
      }
    }
    tallies_.print();
    std::printf(
        "{\"bench\":\"tip.class\",\"what\":\"shoes that the arm cannot scan\",\"ours\":%d,\"unit\":"
        "\"shoes\"}\n",
        not_made_);
    return {};
  }

 private:
  [[nodiscard]] bool out_of_time() const {
    return options_.minutes > 0 && std::chrono::steady_clock::now() - begun_ >
                                       std::chrono::duration<double, std::ratio<60>>{options_.minutes};
  }

  Result<void> make(const TipShoe& shoe, bool budget) {
    BITELINE_ASSIGN(const TipScan scan, make_scan({.shoe = shoe.drawn(),
                                                   .seed = shoe.seed,
                                                   .speed_mm_s = options_.speed_mm_s,
                                                   .rate_hz = options_.rate_hz}));
    const Pictures lit = pictures_of(scan, true);
    for (const TableRow& row : rows_of_all()) {
      if (row.variant.reckoning == Reckoning::Own || !options_.own) BITELINE_TRY(add(shoe, scan, lit, row));
    }
    if (!budget) return {};
    const Pictures plain = pictures_of(scan, false);
    for (const TableRow& row : rows_of_budget())
      BITELINE_TRY(add(shoe, scan, row.variant.sources.light ? lit : plain, row));
    return {};
  }

  Result<void> add(const TipShoe& shoe, const TipScan& scan, const Pictures& pictures, const TableRow& row) {
    const Result<HostScan> host = look(scan, pictures, row.variant);
    for (const path::Process& process : processes_) {
      Worked worked{.refused = host ? host->found.reason() : to_line(host.error())};
      if (host && host->found.found) {
        BITELINE_ASSIGN(worked, work(scan, *host, process, row.variant));
      }
      tell(shoe, row, process.name, worked);
      tallies_.add(row.table, process.name + ", " + row.variant.name, worked);
      if (row.table == "class") tallies_.add("class", process.name + ", " + shoe.class_name(), worked);
    }
    return {};
  }

  void tell(const TipShoe& shoe, const TableRow& row, const std::string& process,
            const Worked& worked) const {
    for (const double off_mm : worked.off_mm) {
      if (along_)
        std::fprintf(along_.get(), "%llu,%s,\"%s\",%.4f\n", static_cast<unsigned long long>(shoe.index),
                     process.c_str(), row.variant.name.c_str(), off_mm);
    }
    if (!file_) return;
    std::vector<double> off_mm = worked.off_mm;
    std::fprintf(
        file_.get(), "%llu,%s,%g,%s,\"%s\",%s,%.4f,%.4f,%.4f,%.4f,%.4f,%.2f,%.4f,%.4f,%d,\"%s\"\n",
        static_cast<unsigned long long>(shoe.index), shoe.class_name().c_str(), options_.speed_mm_s,
        row.table.c_str(), row.variant.name.c_str(), process.c_str(), worked.parts.line_u95_mm.value_or(-1),
        worked.parts.give_mm, worked.parts.tip_u95_mm, path::tip_sum_mm(worked.parts).value_or(-1),
        path::tip_bound_mm(worked.parts).value_or(-1), worked.planned_s,
        off_mm.empty() ? -1 : geometry::quantile_of(std::span<double>{off_mm}, 0.95),
        off_mm.empty() ? -1 : std::ranges::max(worked.off_mm), worked.waits ? 1 : 0, worked.refused.c_str());
    std::fflush(file_.get());
  }

  Options options_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_{nullptr, &std::fclose}, along_{nullptr, &std::fclose};
  std::vector<path::Process> processes_;
  TipTallies tallies_;
  std::chrono::steady_clock::time_point begun_{std::chrono::steady_clock::now()};
  int not_made_{0};
};

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  using namespace biteline;
  bench::Options asked;
  options::Command command{"The tool's true tip on the true bite line", "bench_tip"};
  command.add_option("--shoes", asked.shoes, "so many, of one class after the other")->capture_default_str();
  command.add_option("--seed", asked.seed, "of shoes, heads, arms and hands")->capture_default_str();
  command.add_option("--from", asked.from, "the first one's number")->capture_default_str();
  command.add_option("--class", asked.shoe_class, "only of this one");
  command.add_option("--speed", asked.speed_mm_s, "of the scan, mm/s")->capture_default_str();
  command.add_option("--rate", asked.rate_hz, "of the camera, Hz")->capture_default_str();
  command.add_option("--work-speed", asked.work_speed_ratio, "of the processes' own speed")
      ->capture_default_str();
  command.add_option("--budget", asked.budget, "so many of them with each source alone and left out")
      ->capture_default_str();
  command.add_flag("--own", asked.own, "leave the arm out whose links nobody measured");
  command.add_option("--minutes", asked.minutes, "after so many no shoe is begun any more; 0: all are made");
  command.add_option("--rows", asked.rows, "a row for each shoe, process and variant goes there");
  command.add_option("--along", asked.along, "every distance, half a millimetre apart, goes there");
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  if (const Result<void> done = bench::TipBench{asked}.run(); !done) {
    std::fprintf(stderr, "bench_tip: %s\n", to_line(done.error()).c_str());
    return 1;
  }
  return 0;
}
