// SPDX-License-Identifier: MIT
// bench_film [SHOES [SEED]]: how even the film is that a path lays in the simulated cell, and where it begins
// and ends.  Made shoes before a UR10e; each line is the true one.  Cement and spray with zones at a fifth of
// the speed, once with the tool's output alone and once with the process's flow.  Each shoe's gun and pump
// differ from what the process was told: delays by 1.5 ms, the pump's lag by a twentieth (one standard
// deviation), as from test lines.  A bead's width goes with the root of its cross-section; all of it is
// simulated.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "hal/sim/glue/film.hpp"
#include "host/robot/link/ur/flow_script.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/bench/robot/shoe_in_reach.hpp"

namespace biteline::bench {
namespace {

constexpr const char* k_arm = "ur10e";
constexpr double k_bin_mm = 1, k_step_s = 0.002;
/// The bars.
constexpr double k_width_mm = 0.2, k_ends_mm = 1;
constexpr double k_delay_sigma_s = 0.0015, k_lag_sigma_ratio = 0.05;

struct Shoe : ShoeInReach {
  cloud::ClosedLine line;
};

cloud::ClosedLine true_line(const sim::MadeScene& scene) {
  cloud::ClosedLine line;
  constexpr std::size_t k_each = 2;  // of points half a millimetre apart
  for (std::size_t i = 0; i < scene.line.size(); i += k_each) {
    line.points.push_back({.position = scene.T_base_shoe * scene.line[i].point_shoe,
                           .normal = Vec3::UnitX(),
                           .tangent = Vec3::UnitY(),
                           .confidence = 1,
                           .u95_mm = 0.1});
  }
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    cloud::LinePoint& point = line.points[i];
    point.tangent =
        (line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position).normalized();
    point.normal = point.tangent.cross(Vec3::UnitZ()).normalized();
  }
  return line;
}

Result<Shoe> make_shoe(std::uint64_t seed, const sim::ArmKinematics& arm) {
  BITELINE_ASSIGN(ShoeInReach placed, shoe_in_reach(seed, arm, k_arm));
  cloud::ClosedLine line = true_line(*placed.scene);
  return Shoe{std::move(placed), std::move(line)};
}

path::Process with_slow_zones(path::Process process) {
  path::Zone toe{.name = "toe", .where = path::Zone::Where::Toe, .reach_ratio = 0.2, .speed_ratio = 0.2};
  path::Zone side{.name = "side", .from_ratio = 0.3, .to_ratio = 0.45, .speed_ratio = 0.4};
  process.motion.minimum_speed_mm_s = 0.1 * process.motion.speed_mm_s;
  process.zones = {toe, side};
  return process;
}

/// Of one shoe.
struct Film {
  double within_ratio{0};         ///< of the film's length, whose width is as it ought to be
  double begin_mm{0}, end_mm{0};  ///< from where it ought to begin and end
  double speeds{0};               ///< fastest over slowest place
};

struct Wanted {
  double width_mm;
  double end_mm;  ///< of the way, from the run's beginning
};

/// Evenly over the way of one cycle; all at one place where it stands.
void spread(std::vector<double>& bins, double from_mm, double way_mm, double film_mm) {
  const auto bin_of = [](double mm) { return static_cast<std::size_t>(mm / k_bin_mm); };
  const double to_mm = from_mm + way_mm;
  for (std::size_t bin = bin_of(from_mm); bin <= bin_of(to_mm) && bin < bins.size(); ++bin) {
    const double begin = std::max(from_mm, k_bin_mm * static_cast<double>(bin));
    const double end = std::min(to_mm, k_bin_mm * static_cast<double>(bin + 1));
    bins[bin] += way_mm > 0 ? film_mm * (end - begin) / way_mm : film_mm;
  }
}

Film judged(const std::vector<sim::FilmStep>& steps, const Wanted& wanted) {
  std::vector<double> bins(static_cast<std::size_t>(wanted.end_mm / k_bin_mm) + 100, 0.0);
  double way_mm = 0, slowest = 1e9, fastest = 0;
  Film film{.begin_mm = wanted.end_mm, .end_mm = -wanted.end_mm};
  bool begun = false;
  for (const sim::FilmStep& step : steps) {
    begun = begun || step.gun_wanted;
    if (!begun) continue;
    spread(bins, way_mm, step.way_mm, step.film_mm);
    const bool lays = step.film_mm > 0.5 * step.way_mm && step.film_mm > 0;
    if (lays) film.begin_mm = std::min(film.begin_mm, way_mm);
    way_mm += step.way_mm;
    if (lays) film.end_mm = way_mm - wanted.end_mm;
    const double speed = step.way_mm / k_step_s;
    if (way_mm > 10 && way_mm < wanted.end_mm - 20) {
      slowest = std::min(slowest, speed);
      fastest = std::max(fastest, speed);
    }
  }
  film.speeds = fastest / slowest;
  const auto whole = static_cast<std::size_t>(wanted.end_mm / k_bin_mm);
  std::size_t within = 0;
  for (std::size_t i = 0; i < whole; ++i) {
    const double width_mm = wanted.width_mm * std::sqrt(std::max(0.0, bins[i] / k_bin_mm));
    if (std::abs(width_mm - wanted.width_mm) <= k_width_mm) ++within;
  }
  film.within_ratio = static_cast<double>(within) / static_cast<double>(whole);
  return film;
}

Result<Film> lay(const Shoe& shoe, const path::Process& process, const sim::ArmKinematics& arm,
                 const sim::GunFacts& gun) {
  const sim::MadeScene& scene = *shoe.scene;
  const path::PlanOutcome planned = path::plan(
      {.line = shoe.line,
       .process = process,
       .arm = *kinematics::arm_model("UR10e"),
       .table_z_mm = 0,
       .fixture = path::Fixture{.top_z_mm = scene.T_base_shoe.translation().z(),
                                .beyond_mm = sim::plate_beyond_line_mm(scene.shoe.outline(), scene.line)},
       .shoe = {},
       .from_rad = shoe.from_rad,
       .cloud = {},
       .seek_remedy = false});
  if (!planned.path) return fail(Errc::CheckFailed, "%s", planned.reason().c_str());
  const path::PlannedPath& path = planned.path->path();
  BITELINE_ASSIGN(sim::Script script, sim::parse_script(robot::ur::urscript(*planned.path)));
  script.start_rad = shoe.from_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, arm, arm.T_base_flange(*script.start_rad), SE3::Identity()));
  path::PlannedPath told = path;
  if (!told.flow) told.flow = path::Flow{.film_overlap_mm = path.overlap_mm};
  const path::PathRun run = path::runs_of(path, path::Segment::Line).front();
  const sim::FilmTool tool{.standoff_mm = process.placement.standoff_mm,
                           .digital_output = process.digital_output,
                           .analog_output = process.flow ? process.flow->analog_output : -1,
                           .full_mm_s = process.flow ? process.flow->full_mm_s : process.motion.speed_mm_s,
                           .gun = gun};
  return judged(sim::lay_film(program, tool, k_step_s),
                {.width_mm = path::covered_width_mm(process),
                 .end_mm = robot::ur::film_end(told, run, path.overlap_mm > 0).way_mm});
}

/// Standard deviations away from what the process is told.
sim::GunFacts drawn_gun(const path::Flow& told, std::mt19937_64& random) {
  std::normal_distribution<double> delay{0, k_delay_sigma_s}, ratio{1, k_lag_sigma_ratio};
  return {.opens_s = told.gun_on_s + delay(random),
          .closes_s = told.gun_off_s + delay(random),
          .pump_lag_s = told.lag_s * ratio(random)};
}

struct Sum {
  int shoes{0}, refused{0};
  double within{0}, least_within{1}, begin{0}, end{0}, speeds{0};
  void take(const Film& film) {
    ++shoes;
    within += film.within_ratio;
    least_within = std::min(least_within, film.within_ratio);
    begin = std::max(begin, std::abs(film.begin_mm));
    end = std::max(end, std::abs(film.end_mm));
    speeds += film.speeds;
  }
};

void tell(const std::string& what, const Sum& sum) {
  std::printf(
      "{\"bench\":\"film\",\"what\":\"%s\",\"shoes\":%d,\"refused\":%d,\"within\":%.4f,\"least_within\":%.4f,"
      "\"begin_mm\":%.2f,\"end_mm\":%.2f,\"speeds\":%.2f}\n",
      what.c_str(), sum.shoes, sum.refused, sum.within / std::max(1, sum.shoes), sum.least_within, sum.begin,
      sum.end, sum.speeds / std::max(1, sum.shoes));
  std::fflush(stdout);
}

int run(int shoes, std::uint64_t seed) {
  const auto arm = sim::ArmKinematics::named(k_arm);
  const path::Flow flow{
      .gun_on_s = 0.040, .gun_off_s = 0.025, .film_overlap_mm = 2, .analog_output = 0, .lag_s = 0.030};
  std::array<std::array<Sum, 2>, 2> sums{};
  const std::array names{"cement", "spray"};
  for (int i = 0; i < shoes; ++i) {
    const Result<Shoe> shoe = make_shoe(seed + static_cast<std::uint64_t>(i), *arm);
    if (!shoe) {
      std::fprintf(stderr, "bench_film: shoe %d: %s\n", i, to_line(shoe.error()).c_str());
      continue;
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Result<path::Process> read =
          path::read_process(std::filesystem::path{BITELINE_PROCESSES} / (std::string{names[k]} + ".yaml"));
      if (!read) return 1;
      std::mt19937_64 random{seed + static_cast<std::uint64_t>(i)};
      sim::GunFacts gun = drawn_gun(flow, random);
      for (const bool flows : {false, true}) {
        path::Process process = with_slow_zones(*read);
        process.flow.reset();
        if (flows) {
          process.flow = flow;
          process.flow->full_mm_s = process.motion.speed_mm_s;
        }
        gun.metered = flows;
        const Result<Film> film = lay(*shoe, process, *arm, gun);
        Sum& sum = sums[k][flows ? 1 : 0];
        if (film) {
          sum.take(*film);
        } else {
          ++sum.refused;
          std::fprintf(stderr, "bench_film: %s, shoe %d: %s\n", names[k], i, to_line(film.error()).c_str());
        }
      }
    }
  }
  bool good = true;
  for (std::size_t k = 0; k < names.size(); ++k) {
    tell(std::string{names[k]} + ", output alone", sums[k][0]);
    tell(std::string{names[k]} + ", with its flow", sums[k][1]);
    const Sum& sum = sums[k][1];
    good = good && sum.shoes > 0 && sum.within / sum.shoes >= 0.98 && sum.begin <= k_ends_mm &&
           sum.end <= k_ends_mm;
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  const int shoes = argc > 1 ? std::atoi(argv[1]) : 30;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 6001);
  if (shoes < 1) {
    std::fprintf(stderr, "usage: bench_film [SHOES [SEED]]\n");
    return 2;
  }
  return biteline::bench::run(shoes, seed);
}
