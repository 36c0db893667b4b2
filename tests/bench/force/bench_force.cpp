// SPDX-License-Identifier: MIT
// bench_force [SHOES [SEED [without-air]]]: how even the force is that a path presses with in the simulated
// cell.  Made shoes of six models, five of each, before a UR10e; grind, rough and roll at 60 mm/s, once by
// the set force alone and once with what an air run and the shoes before have taught.  Contact is MuJoCo's;
// sensor, regulator and upper are simulated: the sensor's error changes with the place by 1.1 N (root mean
// square), as a UR5e's was measured.  Each shoe stands a few mm elsewhere, has its own upper (0.5 to 2
// N/mm3), and its line is off by 0.1 mm.  Grind and rough are run by a simulated constant-force flange, too:
// it needs no air run, and learns from its own reading.  without-air: the arm learns without a run beside the
// shoe, as a service does.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "hal/sim/contact/contact_world.hpp"
#include "hal/sim/robot/press_run.hpp"
#include "host/robot/link/ur/force_script.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/first_run.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/force_learning.hpp"
#include "tests/bench/robot/shoe_in_reach.hpp"

namespace biteline::bench {
namespace {

constexpr const char* k_arm = "ur10e";
constexpr int k_shoes_each = 5;
constexpr double k_speed_mm_s = 60, k_step_s = 0.002;
/// The bars.
constexpr double k_band_ratio = 0.15, k_least_alone = 0.80, k_least_learned = 0.95;
constexpr int k_flange_line = 4;
/// Less than a pass takes off.
constexpr double k_removed_mm = 0.02;

using Model = ShoeInReach;

struct Shoe {
  SE3 T_base_shoe;
  cloud::ClosedLine line;
  sim::UpperStrip strip;
  sim::ForceFacts sensor;
};

/// Waves round the line of one standard deviation, mm.
struct LineError {
  std::array<double, 4> phases{};
  [[nodiscard]] double at(double ratio, double sigma_mm, std::size_t first) const {
    const double turn = 2 * std::numbers::pi * ratio;
    return sigma_mm * (std::sin(3 * turn + phases[first]) + std::sin(8 * turn + phases[first + 1]));
  }
};

cloud::ClosedLine seen_line(const sim::MadeScene& scene, const SE3& T_base_shoe, const LineError& error) {
  constexpr double k_sigma_mm = 0.1;
  constexpr std::size_t k_each = 2;  // of points half a millimetre apart
  cloud::ClosedLine line;
  for (std::size_t i = 0; i < scene.line.size(); i += k_each) {
    const double ratio = static_cast<double>(i) / static_cast<double>(scene.line.size());
    const Vec3 normal = T_base_shoe.linear() * scene.line[i].normal_shoe;
    line.points.push_back({.position = T_base_shoe * scene.line[i].point_shoe +
                                       error.at(ratio, k_sigma_mm, 0) * normal +
                                       error.at(ratio, k_sigma_mm, 2) * Vec3::UnitZ(),
                           .normal = normal,
                           .tangent = Vec3::UnitY(),
                           .confidence = 1,
                           .u95_mm = 0.2});
  }
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    cloud::LinePoint& point = line.points[i];
    point.tangent =
        (line.points[(i + 1) % count].position - line.points[(i + count - 1) % count].position).normalized();
    point.normal = (point.normal - point.normal.dot(point.tangent) * point.tangent).normalized();
  }
  return line;
}

/// `arm_seed`: of the arm's sensor, whose error by place is the same for all its shoes.
Shoe make_shoe(const Model& model, std::uint64_t seed, std::uint64_t arm_seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> place_mm{0, 2}, turn_rad{0, 0.01};
  std::uniform_real_distribution<double> phase{0, 2 * std::numbers::pi},
      softness{std::log(0.5), std::log(2.0)};
  Shoe shoe;
  shoe.T_base_shoe = model.scene->T_base_shoe;
  shoe.T_base_shoe.translation() += Vec3{place_mm(random), place_mm(random), 0};
  shoe.T_base_shoe.linear() =
      Mat3{Eigen::AngleAxisd(turn_rad(random), Vec3::UnitZ()) * shoe.T_base_shoe.linear()};
  LineError error;
  for (double& one : error.phases) one = phase(random);
  shoe.line = seen_line(*model.scene, shoe.T_base_shoe, error);
  shoe.strip = sim::upper_strip(model.scene->shoe, model.scene->line, shoe.T_base_shoe,
                                {.newton_per_mm3 = std::exp(softness(random)), .seed = seed});
  shoe.sensor = sim::common_force_facts(arm_seed);
  shoe.sensor.noise_seed = seed;
  return shoe;
}

struct Job {
  const char* name;
  const char* process;  ///< whose tool and placement it has
  double set_newton;
  double gain_ratio, damping_ratio;  ///< of force mode: more gain for the softer tool
  sim::ContactTool tool;
  bool by_flange{false};  ///< else by the arm's force mode
};

path::Process process_of(const Job& job) {
  path::Process process =
      *path::read_process(std::filesystem::path{BITELINE_PROCESSES} / (std::string{job.process} + ".yaml"));
  process.motion.speed_mm_s = k_speed_mm_s;
  // The face lies against the wall, whichever way that leans.
  process.placement.outwards = path::Outwards::Normal;
  process.force = path::Force{.set_newton = job.set_newton,
                              .damping_ratio = job.damping_ratio,
                              .gain_ratio = job.gain_ratio,
                              .most_newton = 4 * job.set_newton};
  if (job.by_flange) {
    // On a bracket, its stroke along the force: it cannot be turned about the tool.
    process.tool.free_turn_rad = 0;
    process.force->flange = path::Flange{
        .on_output = k_flange_line, .ready_input = k_flange_line, .tilt_rad = process.placement.tilt_rad};
  }
  return process;
}

path::PlanRequest request_of(const Model& model, const Shoe& shoe, const path::Process& process) {
  const sim::MadeScene& scene = *model.scene;
  return {.line = shoe.line,
          .process = process,
          .arm = *kinematics::arm_model("UR10e"),
          .table_z_mm = 0,
          .fixture = path::Fixture{.top_z_mm = scene.T_base_shoe.translation().z(),
                                   .beyond_mm = sim::plate_beyond_line_mm(scene.shoe.outline(), scene.line)},
          .shoe = {},
          .from_rad = model.from_rad,
          .cloud = {},
          .seek_remedy = false};
}

/// What one run gave, by the tip's way on the line.
struct Pressed {
  path::PlannedPath path;
  double begin_ratio{0}, way_mm{1};
  std::vector<path::ForceSample> told{};  ///< between the ramps
  std::vector<double> true_newton{};      ///< likewise
  std::vector<double> width_mm{};         ///< removed
  double most_off_mm{0}, most_depth_mm{0};
  bool halted{false};
  int word{0};
};

/// Places of the way on the first run of the line.
class Way {
 public:
  explicit Way(const path::PlannedPath& path) : path_{path} {
    const path::PathRun run = path::runs_of(path, path::Segment::Line).front();
    first_ = run.first;
    mm_.push_back(0);
    for (std::size_t i = run.first + 1; i <= run.last; ++i)
      mm_.push_back(mm_.back() + (path.waypoints[i].T_base_tcp.translation() -
                                  path.waypoints[i - 1].T_base_tcp.translation())
                                     .norm());
  }
  [[nodiscard]] double length_mm() const { return mm_.back(); }
  [[nodiscard]] const path::Waypoint& at(double way_mm) const {
    const auto after = std::ranges::lower_bound(mm_, way_mm);
    const auto index = static_cast<std::size_t>(std::min(after, mm_.end() - 1) - mm_.begin());
    return path_.waypoints[first_ + index];
  }
  [[nodiscard]] Vec3 begin() const { return path_.waypoints[first_].T_base_tcp.translation(); }

 private:
  const path::PlannedPath& path_;
  std::size_t first_{0};
  std::vector<double> mm_;
};

Result<Pressed> press(const Model& model, const Shoe& shoe, const path::PlanRequest& request, const Job& job,
                      const sim::ArmKinematics& arm) {
  const path::PlanOutcome planned = path::plan(request);
  if (!planned.path) return fail(Errc::CheckFailed, "%s", planned.reason().c_str());
  Pressed out{.path = planned.path->path()};
  BITELINE_ASSIGN(sim::Script script, sim::parse_script(robot::ur::urscript(*planned.path)));
  script.start_rad = model.from_rad;
  const auto program = std::make_shared<const sim::Program>(
      sim::Program::plan(script, arm, arm.T_base_flange(*script.start_rad), SE3::Identity()));
  std::unique_ptr<sim::ContactWorld> world;
  sim::Touch touch;
  std::vector<sim::ContactNow> felt;  // of each cycle
  if (!out.path.tool_off) {
    sim::ContactTool tool = job.tool;
    tool.tilt_rad = request.process.placement.tilt_rad;
    tool.lead_rad = request.process.placement.lead_rad;
    BITELINE_ASSIGN(world, sim::ContactWorld::create(shoe.strip, tool));
    touch = [&](const SE3& T_base_tcp, double step_s) {
      felt.push_back(world->step(T_base_tcp, step_s));
      return felt.back().force_base;
    };
  }
  const auto run_by = [&](const auto& facts) {
    return sim::press_along(program, facts, touch, robot::ur::k_force_register, k_step_s);
  };
  const sim::PressRun run =
      job.by_flange ? run_by(sim::FlangeFacts{.on_output = k_flange_line,
                                              .ready_input = k_flange_line,
                                              .axis_tcp = path::axis_tcp(*request.process.force->flange),
                                              .seed = shoe.sensor.noise_seed})
                    : run_by(shoe.sensor);
  out.halted = run.halted;
  out.word = run.steps.back().told;
  const Way way{out.path};
  out.begin_ratio = way.at(0).round_ratio;
  out.way_mm = way.length_mm();
  const double ramp_mm = request.process.force->ramp_mm;
  double way_mm = -1;
  Vec3 before = Vec3::Zero();
  for (std::size_t i = 0; i < run.steps.size(); ++i) {
    const sim::PressStep& step = run.steps[i];
    const bool at_begin = (step.tip_base - way.begin()).norm() < 0.01;
    if (way_mm < 0 && at_begin && (out.path.tool_off || step.force_mode)) way_mm = 0;
    if (way_mm >= 0) way_mm += way_mm == 0 && at_begin ? 0 : (step.tip_base - before).norm();
    before = step.tip_base;
    if (way_mm < ramp_mm || way_mm > way.length_mm() - ramp_mm) continue;
    const path::Waypoint& here = way.at(way_mm);
    const Mat3 R_tcp_base = here.T_base_tcp.linear().transpose();
    out.told.push_back({here.round_ratio, R_tcp_base * step.told_newton, R_tcp_base * here.press_base});
    if (!world) continue;
    out.true_newton.push_back(felt[i].pressed_newton);
    out.most_off_mm = std::max(out.most_off_mm, step.off_base.norm());
    out.most_depth_mm = std::max(out.most_depth_mm, felt[i].depth_mm);
  }
  if (world) out.width_mm = world->removed_width_mm(k_removed_mm);
  return out;
}

struct Sum {
  int shoes{0}, refused{0}, halted{0};
  double within{0}, least_within{1}, mean_newton{0}, rms_newton{0}, width_mm{0}, width_sd_mm{0};
  double most_off_mm{0}, most_depth_mm{0};
  void take(const Pressed& pressed, double set_newton) {
    ++shoes;
    if (pressed.halted) ++halted;
    double inside = 0, sum = 0, squares = 0;
    for (const double newton : pressed.true_newton) {
      inside += std::abs(newton - set_newton) <= k_band_ratio * set_newton ? 1 : 0;
      sum += newton;
      squares += (newton - set_newton) * (newton - set_newton);
    }
    const double n = std::max<double>(1, static_cast<double>(pressed.true_newton.size()));
    // What was not worked is not within.
    const double share = pressed.halted ? 0 : inside / n;
    within += share;
    least_within = std::min(least_within, share);
    mean_newton += sum / n;
    rms_newton += std::sqrt(squares / n);
    double w = 0, w2 = 0;
    for (const double width : pressed.width_mm) w += width;
    w /= static_cast<double>(pressed.width_mm.size());
    for (const double width : pressed.width_mm) w2 += (width - w) * (width - w);
    width_mm += w;
    width_sd_mm += std::sqrt(w2 / static_cast<double>(pressed.width_mm.size()));
    most_off_mm = std::max(most_off_mm, pressed.most_off_mm);
    most_depth_mm = std::max(most_depth_mm, pressed.most_depth_mm);
  }
  [[nodiscard]] double share() const { return within / std::max(1, shoes); }
};

void tell(const std::string& what, const Sum& sum) {
  const double n = std::max(1, sum.shoes);
  std::printf(
      "{\"bench\":\"force\",\"what\":\"%s\",\"shoes\":%d,\"refused\":%d,\"halted\":%d,\"within\":%.4f,"
      "\"least_within\":%.4f,\"mean_n\":%.2f,\"rms_off_n\":%.2f,\"width_mm\":%.2f,\"width_sd_mm\":%.2f,"
      "\"most_off_mm\":%.2f,\"most_depth_mm\":%.2f}\n",
      what.c_str(), sum.shoes, sum.refused, sum.halted, sum.share(), sum.least_within, sum.mean_newton / n,
      sum.rms_newton / n, sum.width_mm / n, sum.width_sd_mm / n, sum.most_off_mm, sum.most_depth_mm);
  std::fflush(stdout);
}

struct Sums {
  Sum alone, learned;
};

/// The shoes of one model, in their order.
void work(const Model& model, const std::vector<Shoe>& shoes, const Job& job, const sim::ArmKinematics& arm,
          bool air_run, Sums& sums) {
  path::ForceLearned learned{.set_newton = job.set_newton};
  const path::Process process = process_of(job);
  const auto note = [&](const Result<Pressed>& pressed, Sum& sum) {
    if (pressed) {
      sum.take(*pressed, job.set_newton);
      if (pressed->halted)
        std::fprintf(stderr, "bench_force: %s: halted, word %d\n", job.name, pressed->word);
    } else {
      ++sum.refused;
      std::fprintf(stderr, "bench_force: %s: %s\n", job.name, to_line(pressed.error()).c_str());
    }
  };
  // A flange's reading does not change with the place: what it reads beside the shoe teaches nothing.
  if (air_run && !job.by_flange) {
    const Result<Pressed> air =
        press(model, shoes.front(), path::force_air_run(request_of(model, shoes.front(), process)), job, arm);
    if (air) {
      path::learn_air(learned, air->told);
    } else {
      std::fprintf(stderr, "bench_force: %s in the air: %s\n", job.name, to_line(air.error()).c_str());
    }
  }
  for (const Shoe& shoe : shoes) {
    note(press(model, shoe, request_of(model, shoe, process), job, arm), sums.alone);
    path::Process taught = process;
    taught.force_learned = learned;
    const Result<Pressed> pressed = press(model, shoe, request_of(model, shoe, taught), job, arm);
    note(pressed, sums.learned);
    if (pressed && !pressed->halted)
      path::learn_shoe(learned, pressed->told,
                       {.begin_ratio = pressed->begin_ratio,
                        .lead_ratio = path::k_force_lag_s * k_speed_mm_s / pressed->way_mm});
  }
}

int run(int count, std::uint64_t seed, bool air_run) {
  const auto arm = sim::ArmKinematics::named(k_arm);
  const std::array jobs{Job{"grind", "grind", 20, 2, 0.3, sim::grinding_disc()},
                        Job{"rough", "rough", 15, 2, 0.15, sim::roughing_brush()},
                        Job{"roll", "grind", 20, 2, 0.3, sim::pressing_roller()},
                        Job{"grind by a flange", "grind", 20, 2, 0.3, sim::grinding_disc(), true},
                        Job{"rough by a flange", "rough", 15, 2, 0.15, sim::roughing_brush(), true}};
  std::array<Sums, jobs.size()> sums;
  for (int done = 0; done < count; done += k_shoes_each) {
    const std::uint64_t of_model = seed + static_cast<std::uint64_t>(done / k_shoes_each);
    const Result<Model> model = shoe_in_reach(of_model, *arm, k_arm);
    if (!model) {
      std::fprintf(stderr, "bench_force: model %d: %s\n", done, to_line(model.error()).c_str());
      continue;
    }
    std::vector<Shoe> shoes;
    for (int i = 0; i < std::min(k_shoes_each, count - done); ++i)
      shoes.push_back(make_shoe(*model, 1000 * of_model + static_cast<std::uint64_t>(i), of_model));
    for (std::size_t k = 0; k < jobs.size(); ++k) work(*model, shoes, jobs[k], *arm, air_run, sums[k]);
  }
  bool good = true;
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    tell(std::string{jobs[k].name} + ", by the set force alone", sums[k].alone);
    tell(std::string{jobs[k].name} + ", with what was learned", sums[k].learned);
    good = good && sums[k].alone.shoes > 0 && sums[k].alone.share() >= k_least_alone &&
           sums[k].learned.share() >= k_least_learned;
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  const int shoes = argc > 1 ? std::atoi(argv[1]) : 30;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 6001);
  const bool without_air = argc == 4 && std::string{argv[3]} == "without-air";
  if (shoes < 1 || argc > 4 || (argc == 4 && !without_air)) {
    std::fprintf(stderr, "usage: bench_force [SHOES [SEED [without-air]]]\n");
    return 2;
  }
  return biteline::bench::run(shoes, seed, !without_air);
}
