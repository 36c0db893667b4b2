// SPDX-License-Identifier: MIT
// bench_rework [SHOES [SEED]]: made shoes, worked with three gaps of 1 to 20 mm each and scanned before and
// after.  What the second look misses becomes a path of a UR10e, and the path's program is driven by the
// simulated controller, its gun and its pump.  How much of what was truly missing gets film, and how much of
// the film that was there gets it twice.  Delays as in bench_film; all of it is simulated.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "hal/sim/glue/film.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/plan.hpp"
#include "host/second_look/rework.hpp"
#include "tests/bench/second_look/made_work.hpp"

namespace biteline::bench {
namespace {

using second_look::Arc;

constexpr const char* k_arm = "ur10e";
constexpr double k_step_s = 0.002, k_bin_mm = 0.05;
constexpr double k_delay_sigma_s = 0.0015;
constexpr int k_gaps = 3;

/// Bins round the line.
class Bins {
 public:
  explicit Bins(double line_mm)
      : on_(static_cast<std::size_t>(std::ceil(line_mm / k_bin_mm)), 0), line_mm_{line_mm} {}
  /// The other way round it is nothing.
  void mark(const Arc& arc) {
    if (std::remainder(arc.to_mm - arc.from_mm, line_mm_) < 0) return;
    for (std::size_t i = bin(arc.from_mm); true; i = (i + 1) % on_.size()) {
      on_[i] = 1;
      if (i == bin(arc.to_mm)) return;
    }
  }
  [[nodiscard]] bool at(std::size_t i) const { return on_[i % on_.size()] != 0; }
  [[nodiscard]] std::size_t size() const { return on_.size(); }

 private:
  [[nodiscard]] std::size_t bin(double mm) const {
    return static_cast<std::size_t>(std::fmod(mm + line_mm_, line_mm_) / k_bin_mm) % on_.size();
  }
  std::vector<std::uint8_t> on_;
  double line_mm_;
};

/// Ways along a closed line of close points.
class Along {
 public:
  explicit Along(const cloud::ClosedLine& line) : line_{line} {
    mm_.push_back(0);
    for (std::size_t i = 0; i < line.points.size(); ++i) mm_.push_back(mm_.back() + step(i).norm());
  }
  [[nodiscard]] double total_mm() const { return mm_.back(); }
  [[nodiscard]] double at_mm(const Vec3& place) const {
    double best = 1e9, mm = 0;
    for (std::size_t i = 0; i < line_.points.size(); ++i) {
      const Vec3 d = step(i);
      const double share = std::clamp((place - at(i)).dot(d) / d.squaredNorm(), 0.0, 1.0);
      const double off = (at(i) + share * d - place).squaredNorm();
      if (off >= best) continue;
      best = off;
      mm = mm_[i] + share * d.norm();
    }
    return mm;
  }

 private:
  [[nodiscard]] const Vec3& at(std::size_t i) const { return line_.points[i % line_.points.size()].position; }
  [[nodiscard]] Vec3 step(std::size_t i) const { return at(i + 1) - at(i); }
  const cloud::ClosedLine& line_;
  std::vector<double> mm_;
};

/// Its middle so far before the arm, on a plate: the arm's base in the frame of the scans.
SE3 base_of(const MadeWork& work, double away_mm) {
  Vec3 middle = Vec3::Zero();
  for (const cloud::LinePoint& p : work.line.points)
    middle += work.T_base_shoe.inverse() * p.position / static_cast<double>(work.line.points.size());
  const SE3 T_arm_shoe =
      geometry::make_se3(Eigen::Quaterniond::Identity(), Vec3{away_mm - middle.x(), -middle.y(), 120});
  return work.T_base_shoe * T_arm_shoe.inverse();
}

path::Process process_of(const WorkCase& made) {
  path::Process process = *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "cement.yaml");
  process.placement.up_mm = made.plan.offset_mm;
  process.coverage.contact_width_mm = made.plan.width_mm;
  process.flow = path::Flow{.gun_on_s = 0.040,
                            .gun_off_s = 0.025,
                            .film_overlap_mm = 2,
                            .analog_output = 0,
                            .full_mm_s = process.motion.speed_mm_s,
                            .lag_s = 0.030};
  return process;
}

struct Planned {
  path::PlanOutcome outcome;
  SE3 T_line_base{SE3::Identity()};
};
Planned planned(const WorkCase& made, const MadeWork& work, const second_look::Rework& rework) {
  path::PlanRequest request{.line = work.line,
                            .process = process_of(made),
                            .arm = *kinematics::arm_model("UR10e"),
                            .shoe = {},
                            .cloud = work.first.points,
                            .seek_remedy = false};
  for (const second_look::ReworkPiece& piece : rework.pieces)
    request.process.only.push_back({.from_mm = piece.along.from_mm, .to_mm = piece.along.to_mm});
  request.fixture = path::Fixture{.top_z_mm = work.T_base_shoe.translation().z()};
  Planned planned;
  for (const double away_mm : {600.0, 700.0, 500.0}) {
    request.T_line_base = planned.T_line_base = base_of(work, away_mm);
    request.table_z_mm = request.T_line_base.translation().z();
    planned.outcome = path::plan(request);
    if (planned.outcome.path) break;
  }
  return planned;
}

struct Tally {
  int shoes{0}, refused_looks{0}, refused_paths{0}, nothing{0}, untold_gaps{0};
  int pieces{0}, for_a_person{0};
  double missing_mm{0}, told_mm{0}, asked_mm{0}, covered_mm{0}, twice_mm{0}, beyond_mm{0};
  std::vector<double> ends_mm{}, left_mm{};
  double seconds{0};
};

/// Where film lands, by the simulated controller; on the line.
void film_on_line(const Planned& planned, const Along& along, const sim::GunFacts& gun, Bins& film,
                  double& seconds) {
  const path::PlannedPath& path = planned.outcome.path->path();
  const auto arm = sim::ArmKinematics::named(k_arm);
  Result<sim::Script> script = sim::parse_script(robot::ur::urscript(*planned.outcome.path));
  if (!script) {
    std::fprintf(stderr, "bench_rework: %s\n", to_line(script.error()).c_str());
    std::exit(1);
  }
  script->start_rad = path.waypoints.front().q_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(*script, *arm, arm->T_base_flange(*script->start_rad), SE3::Identity()));
  seconds += program->duration_s();
  // The place that is worked lies beside the line as the process says; its nearest waypoint's does, too.
  std::vector<Vec3> tips, places;
  for (const path::Waypoint& w : path.waypoints) {
    if (w.segment != path::Segment::Line) continue;
    tips.emplace_back(w.T_base_tcp.translation());
    places.push_back(w.line_base);
  }
  const auto on_line_mm = [&](const Vec3& tip) {
    const auto nearest = static_cast<std::size_t>(
        std::ranges::min_element(tips, {}, [&](const Vec3& t) { return (t - tip).squaredNorm(); }) -
        tips.begin());
    const Vec3 place = planned.T_line_base * Vec3{places[nearest] + (tip - tips[nearest])};
    return along.at_mm(place);
  };
  std::optional<double> before_mm;
  for (const sim::FilmStep& step : sim::lay_film(program,
                                                 {.standoff_mm = path.standoff_mm,
                                                 .digital_output = path.digital_output,
                                                 .analog_output = path.flow->analog_output,
                                                 .full_mm_s = path.flow->full_mm_s,
                                                 .gun = gun},
                                                 k_step_s)) {
    if (!(step.film_mm > 0)) {
      before_mm.reset();
      continue;
    }
    const double mm = on_line_mm(step.spot_base);
    film.mark({.from_mm = before_mm.value_or(mm - step.way_mm), .to_mm = mm});
    before_mm = mm;
  }
}

/// Of one run of bins, how long it is; `i` is left behind it.
double run_mm(std::size_t& i, std::size_t end, const auto& is) {
  double mm = 0;
  for (; i < end && is(i); ++i) mm += k_bin_mm;
  return mm;
}

struct Line {
  const Bins &missing, &told, &film;
};

/// What the look has told, and what the film lies on besides.
void count(const Line& line, Tally& tally) {
  const Bins& film = line.film;
  const auto twice = [&](std::size_t i) { return film.at(i) && !line.missing.at(i); };
  const auto left = [&](std::size_t i) { return line.told.at(i) && !film.at(i); };
  // From a bin where nothing is, round to it again.
  std::size_t begin = 0;
  while (begin < film.size() && (film.at(begin) || line.missing.at(begin))) ++begin;
  for (std::size_t i = begin; i < begin + film.size();) {
    if (twice(i)) {
      const double mm = run_mm(i, begin + film.size(), twice);
      tally.ends_mm.push_back(mm);
      tally.twice_mm += mm;
      tally.beyond_mm += std::max(0.0, mm - second_look::k_most_twice_mm);
    } else if (left(i)) {
      tally.left_mm.push_back(run_mm(i, begin + film.size(), left));
      tally.asked_mm += tally.left_mm.back();
    } else {
      if (line.told.at(i)) {
        tally.asked_mm += k_bin_mm;
        tally.covered_mm += k_bin_mm;
      }
      ++i;
    }
  }
}

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

WorkCase gap_case(std::uint64_t seed, int index) {
  WorkCase made = work_case(seed, index);
  made.plan.faults.clear();
  std::mt19937_64 random{made.seed ^ 0x52455750ULL};
  std::uniform_real_distribution<double> length{1, 20}, place{0, 60};
  // As uppers of all sizes have it: some 600 mm round.
  for (int k = 0; k < k_gaps; ++k)
    made.plan.faults.push_back({.kind = sim::WorkFault::Kind::Gap,
                                .s_mm = 60 + 180.0 * k + place(random),
                                .length_mm = length(random)});
  return made;
}

void one(const WorkCase& made, Tally& tally) {
  const MadeWork work = make_work(made);
  const second_look::Findings found = second_look::look_again(work.first, work.second, work.line, work.plan);
  if (found.refusal) {
    ++tally.refused_looks;
    return;
  }
  const second_look::Rework rework = second_look::rework_of(found.faults, work.plan, found.line_mm, {});
  tally.for_a_person += static_cast<int>(rework.for_a_person.size());
  const Along along{work.line};
  Bins missing{along.total_mm()}, told{along.total_mm()}, film{along.total_mm()};
  for (const TrueFault& gap : work.faults) {
    tally.missing_mm += gap.made.length_mm;
    missing.mark(gap.along);
    const bool is_told = std::ranges::any_of(found.faults, [&](const second_look::Fault& fault) {
      return fault.kind == second_look::FaultKind::Missing &&
             std::abs(std::remainder(
                 (fault.along.from_mm + fault.along.to_mm) / 2 - (gap.along.from_mm + gap.along.to_mm) / 2,
                 along.total_mm())) < gap.made.length_mm;
    });
    if (!is_told) ++tally.untold_gaps;
    if (is_told) told.mark(gap.along), tally.told_mm += gap.made.length_mm;
  }
  ++tally.shoes;
  if (rework.pieces.empty()) {
    ++tally.nothing;
    return;
  }
  const Planned path = planned(made, work, rework);
  if (!path.outcome.path) {
    ++tally.refused_paths;
    std::fprintf(stderr, "  no path: %s\n", path.outcome.reason().c_str());
    return;
  }
  tally.pieces += static_cast<int>(rework.pieces.size());
  std::mt19937_64 random{made.seed};
  std::normal_distribution<double> delay{0, k_delay_sigma_s};
  const sim::GunFacts gun{.opens_s = 0.040 + delay(random), .closes_s = 0.025 + delay(random)};
  film_on_line(path, along, gun, film, tally.seconds);
  const std::size_t left = tally.left_mm.size(), ends = tally.ends_mm.size();
  count({.missing = missing, .told = told, .film = film}, tally);
  const auto most = [](const std::vector<double>& values, std::size_t from) {
    return at_share({values.begin() + static_cast<std::ptrdiff_t>(from), values.end()}, 1);
  };
  std::fprintf(stderr, "  %zu pieces; left %.2f mm, twice %.2f mm at most\n", rework.pieces.size(),
               most(tally.left_mm, left), most(tally.ends_mm, ends));
}

void print(const Tally& t) {
  const auto percent = [](double part, double all) { return 100 * part / std::max(1e-9, all); };
  std::printf(
      "{\"bench\":\"rework\",\"shoes\":%d,\"refused_looks\":%d,\"refused_paths\":%d,\"without_pieces\":%d,"
      "\"pieces\":%d,\"for_a_person\":%d,\"path_s\":%.1f}\n",
      t.shoes, t.refused_looks, t.refused_paths, t.nothing, t.pieces, t.for_a_person,
      t.seconds / std::max(1, t.shoes));
  std::printf(
      "missing %.0f mm, of it told %.1f %%, gaps not told %d; where there is a path %.2f %% of %.0f mm "
      "covered\n",
      t.missing_mm, percent(t.told_mm, t.missing_mm), t.untold_gaps, percent(t.covered_mm, t.asked_mm),
      t.asked_mm);
  std::printf("twice [mm]: ends median %.2f, p95 %.2f, most %.2f; beyond 1 mm: %.1f mm of %.1f mm in all\n",
              at_share(t.ends_mm, 0.5), at_share(t.ends_mm, 0.95), at_share(t.ends_mm, 1), t.beyond_mm,
              t.twice_mm);
  std::printf("left [mm]: %zu places, median %.2f, most %.2f\n", t.left_mm.size(), at_share(t.left_mm, 0.5),
              at_share(t.left_mm, 1));
}

void run(int shoes, std::uint64_t seed) {
  Tally tally;
  for (int i = 0; i < shoes; ++i) {
    const WorkCase made = gap_case(seed, i);
    std::fprintf(stderr, "%d %s%s %s\n", i, std::string(sim::name_of(made.shoe_class)).c_str(),
                 made.bare ? " upper" : "",
                 std::string(sim::k_work_names[static_cast<std::size_t>(made.work)]).c_str());
    one(made, tally);
  }
  print(tally);
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  const int shoes = argc > 1 ? std::atoi(argv[1]) : 30;
  if (shoes < 1) {
    std::fprintf(stderr, "usage: bench_rework [SHOES [SEED]]\n");
    return 2;
  }
  biteline::bench::run(shoes, argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 11001);
}
