// SPDX-License-Identifier: MIT
// bench_takt [SHOES [SPEED [CLASS [SIZE [FIRST]]]]]: what a whole shoe takes in made time, for each shipped
// process: made shoes, if not told otherwise deep ones of size 42 from seed 5 on, before a UR10e, scanned at
// SPEED mm/s (400).  The scan is the one that the simulated cell makes; its profiles come in at the camera's
// rate, and the line is the one found in them; the path is the planner's, from where the scan leaves the arm,
// laid out in time by the simulated controller's program.  After the spray the arm goes back to where the
// scan ended and scans the worked shoe the other way round; wet glue lies on it, all of the band.  Line, path
// and look are timed as computed, on this machine.  Ends with 1 where a bar is missed, a path refused, or a
// look tells anything but that all is worked.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "hal/sim/robot/program.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "hal/sim/shoe/worked_band.hpp"
#include "host/intake/live_line.hpp"
#include "host/records/look/planned_band.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/path/checks/way_there.hpp"
#include "host/robot/path/plan.hpp"

namespace biteline::bench {
namespace {

constexpr const char* k_arm = "ur10e";
/// The bars of a factory's takt: the spray's whole shoe, without a look and with one; of the others all but
/// the work along the line.
constexpr double k_whole_s = 11, k_with_look_s = 16, k_others_s = 6, k_scan_s = 3, k_line_and_path_s = 0.2;
/// Profiles of a look must not hide a gap of 2 mm between them: at 400 mm/s they are 1.6 mm apart.
constexpr double k_rate_hz = 250;
/// Of the arm's poses, as the simulated cell has them.
constexpr double k_pose_sigma_mm = 0.010, k_pose_sigma_rad = 5.2e-5;
/// The arm stands on the table, the shoe on a fixture.
constexpr double k_table_z_mm = 0;
/// Of the way round: in the waist, where the wrist is slow as the scan begins and ends.
constexpr double k_scan_begin_ratio = 0.25;

/// Which shoes, and how fast they are scanned.
struct Asked {
  int shoes{3};
  double speed_mm_s{400};
  sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
  int size{42};
  std::uint64_t first_seed{5};
};

struct Shoe {
  std::unique_ptr<sim::MadeScene> scene;
  std::shared_ptr<const sim::ArmScan> scan;
  cloud::ClosedLine line;
  double line_s{0};  ///< computed, from the last profile to the line
  cloud::PointCloud cloud;
};

sim::ScannedCloud scan_of(const sim::MadeShoe& made, const SE3& T_base_shoe, double speed_mm_s,
                          std::uint64_t seed) {
  return sim::scan_quickly(made, {.profile_step_mm = speed_mm_s / k_rate_hz, .seed = seed, .stripe = true},
                           T_base_shoe);
}

cloud::PointCloud cloud_of(sim::ScannedCloud scan) {
  cloud::PointCloud cloud;
  cloud.points = std::move(scan.points);
  cloud.profile = std::move(scan.profile);
  cloud.column = std::move(scan.column);
  cloud.amplitude = std::move(scan.amplitude);
  cloud.width_px = std::move(scan.width_px);
  return cloud;
}

/// As the service finds it: profile after profile, as they come.
Result<void> find_line(Shoe& shoe, double speed_mm_s) {
  const sim::MadeScene& scene = *shoe.scene;
  sim::ScannedCloud scan = scan_of(scene.shoe, scene.T_base_shoe, speed_mm_s, 1);
  const SE3 T_cam_flange = scene.head.model.T_flange_cam.inverse(Eigen::Isometry);
  intake::LiveLine line{{}};
  auto due = std::chrono::steady_clock::now();
  for (std::size_t first = 0; first < scan.points.size();) {
    const std::uint32_t profile = scan.profile[first];
    std::size_t end = first;
    while (end < scan.points.size() && scan.profile[end] == profile) ++end;
    const double time_s = profile / k_rate_hz;
    const SE3 T_base_cam = scene.T_base_shoe * scene.path.T_shoe_cam_at(time_s * speed_mm_s);
    due += std::chrono::microseconds{std::llround(1e6 / k_rate_hz)};
    std::this_thread::sleep_until(due);
    line.add_profile(profile, {scan.points.data() + first, end - first},
                     uncertainty::ProfilePose{.T_base_flange = T_base_cam * T_cam_flange, .time_s = time_s});
    first = end;
  }
  line.close(std::make_shared<const uncertainty::KnownHead>(
      uncertainty::KnownHead{.model = scene.head.model,
                             .uncertainty = {.pose_sigma_mm = k_pose_sigma_mm,
                                             .pose_sigma_rad = k_pose_sigma_rad,
                                             .arm_give_mm_per_m_s2 = 0}}));  // this scan's arm gives nothing
  intake::LiveLine::Outcome found = line.wait();
  if (!found.extraction.found)
    return fail(Errc::CheckFailed, "no line: %s", found.extraction.reason().c_str());
  shoe.line = std::move(found.extraction.line);
  shoe.line_s = found.last_profile_to_line_s;
  shoe.cloud = cloud_of(std::move(scan));
  return {};
}

Result<Shoe> make_shoe(std::uint64_t seed, const Asked& asked, const sim::ArmKinematics& arm) {
  const sim::SceneSettings settings{
      .shoe = sim::draw_shoe(asked.shoe_class, seed, sim::length_of_size_mm(asked.size)),
      .place_seed = seed,
      .places = sim::places_within_reach_of(k_arm),
      .holder = sim::Holder::Bracket,
      .scan_speed_mm_s = asked.speed_mm_s,
      .scan_begin_ratio = k_scan_begin_ratio,
      .scan_clockwise = true,
      .fineness = {.column_mm = 2, .fine_row_mm = 1, .fine_band_mm = 4, .coarse_row_mm = 2}};
  Shoe shoe;
  BITELINE_ASSIGN(shoe.scene, sim::make_scene(settings));
  BITELINE_ASSIGN(const sim::ReachableScan reachable, sim::place_within_reach(*shoe.scene, arm, k_arm));
  shoe.scan = reachable.scan;
  BITELINE_TRY(find_line(shoe, asked.speed_mm_s));
  return shoe;
}

/// Seconds of made time.
struct Takt {
  double scan_s{0};      ///< of the stripe, from begin to end
  double rest_s{0};      ///< from there until the arm stands
  double computed_s{0};  ///< line and path, meanwhile
  double there_s{0}, approach_s{0}, work_s{0}, retreat_s{0};
  double planned_s{0};                                     ///< approach to retreat as the planner has them
  kinematics::Joints end_rad{kinematics::Joints::Zero()};  ///< where the retreat ends
  second_look::PlannedBand band{};
  [[nodiscard]] double path_s() const { return approach_s + work_s + retreat_s; }
  [[nodiscard]] double whole_s() const { return scan_s + std::max(rest_s, computed_s) + there_s + path_s(); }
};

/// How long the program's first `steps` steps last.
double lasts_s(const sim::Script& script, std::size_t steps, const sim::ArmKinematics& arm) {
  sim::Script part = script;
  part.steps.resize(steps);
  return sim::Program::plan(part, arm, arm.T_base_flange(*script.start_rad), SE3::Identity()).duration_s();
}

/// Step behind the last move of this kind; 0: there is none.
std::size_t behind_last(const sim::Script& script, sim::MoveStep::Kind kind) {
  std::size_t behind = 0;
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    const auto* move = std::get_if<sim::MoveStep>(&script.steps[i]);
    if (move != nullptr && move->kind == kind) behind = i + 1;
  }
  return behind;
}
std::size_t first_of(const sim::Script& script, sim::MoveStep::Kind kind) {
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    const auto* move = std::get_if<sim::MoveStep>(&script.steps[i]);
    if (move != nullptr && move->kind == kind) return i;
  }
  return script.steps.size();
}

Result<Takt> takt_of(const Shoe& shoe, const path::Process& process, const sim::ArmKinematics& arm) {
  const path::PlanRequest request{
      .line = shoe.line,
      .process = process,
      .arm = *kinematics::arm_model("UR10e"),
      .T_line_base = SE3::Identity(),
      .table_z_mm = k_table_z_mm,
      .fixture =
          path::Fixture{.top_z_mm = shoe.scene->T_base_shoe.translation().z(),
                        .beyond_mm = sim::plate_beyond_line_mm(shoe.scene->shoe.outline(), shoe.scene->line)},
      .shoe = {},
      .from_rad = shoe.scan->q_rad_at(shoe.scan->duration_s()),
      .cloud = shoe.cloud.points,
      .seek_remedy = false};
  const auto begin = std::chrono::steady_clock::now();
  const path::PlanOutcome planned = path::plan(request);
  const double path_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!planned.path) return fail(Errc::CheckFailed, "%s", planned.reason().c_str());
  BITELINE_ASSIGN(sim::Script script, sim::parse_script(robot::ur::urscript(*planned.path)));
  script.start_rad = request.from_rad;
  BITELINE_ASSIGN(const second_look::PlannedBand band, look::planned_band(shoe.line, process, {}));
  using Kind = sim::MoveStep::Kind;
  const double there_s = lasts_s(script, behind_last(script, Kind::Joint), arm),
               line_s = lasts_s(script, first_of(script, Kind::Process), arm),
               worked_s = lasts_s(script, behind_last(script, Kind::Process), arm),
               all_s = lasts_s(script, script.steps.size(), arm);
  return Takt{.scan_s = shoe.scan->full_until_s() - shoe.scan->full_from_s(),
              .rest_s = shoe.scan->duration_s() - shoe.scan->full_until_s(),
              .computed_s = shoe.line_s + path_s,
              .there_s = there_s,
              .approach_s = line_s - there_s,
              .work_s = worked_s - line_s,
              .retreat_s = all_s - worked_s,
              .planned_s = planned.path->duration_s(),
              .end_rad = planned.path->path().waypoints.back().q_rad,
              .band = band};
}

/// What a second look adds.
struct Look {
  double back_s{0};      ///< from the retreat's end to the nearer end of the first scan
  double begin_s{0};     ///< from rest until the stripe is on the line
  double scan_s{0};      ///< as the first one
  double computed_s{0};  ///< from the last profile to the verdict
  second_look::Findings found{};
  [[nodiscard]] double all_s() const { return back_s + begin_s + scan_s + computed_s; }
};

/// Up above that end of the scan and down there, as the simulated cell goes.
double way_back_s(const Shoe& shoe, const Takt& takt, const sim::ArmKinematics& arm) {
  const sim::ArmScan& scan = *shoe.scan;
  const auto over = [&](const sim::JointVector& above_rad, const sim::JointVector& at_rad) {
    return sim::JointEase{takt.end_rad, above_rad, arm.limits()}.duration_s() +
           sim::JointEase{above_rad, at_rad, arm.limits()}.duration_s();
  };
  return std::min(over(scan.above_begin_rad(), scan.q_rad_at(0)),
                  over(scan.above_end_rad(), scan.q_rad_at(scan.duration_s())));
}

Look look_after(const Shoe& shoe, const Takt& takt, const Asked& asked, const sim::ArmKinematics& arm) {
  const sim::MadeScene& scene = *shoe.scene;
  const sim::ArmScan& scan = *shoe.scan;
  const second_look::PlannedBand& band = takt.band;
  sim::ShoeParameters parameters = scene.settings.shoe;
  parameters.worked =
      sim::lay_band(scene.shoe, scene.line,
                    {.offset_mm = (band.low_mm + band.high_mm) / 2, .width_mm = band.high_mm - band.low_mm},
                    sim::draw_film(sim::Work::WetGlue, parameters.seed));
  const sim::MadeShoe worked{parameters};
  const cloud::PointCloud second =
      cloud_of(scan_of(worked, scene.T_base_shoe, asked.speed_mm_s, parameters.seed + 1));
  Look look{.back_s = way_back_s(shoe, takt, arm),
            .begin_s = scan.duration_s() - scan.full_until_s(),
            .scan_s = scan.full_until_s() - scan.full_from_s()};
  const auto begin = std::chrono::steady_clock::now();
  look.found = second_look::look_again(shoe.cloud, second, shoe.line, band);
  look.computed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return look;
}

/// What was missed so far.
int misses = 0;

/// `target`: none is 0.
void row(const std::string& part, const std::string& what, double seconds, double target) {
  if (target > 0 && seconds > target) {
    ++misses;
    std::fprintf(stderr, "bench_takt: missed: %s: %.2f s, not %.2f\n", what.c_str(), seconds, target);
  }
  std::printf("{\"bench\":\"takt.%s\",\"what\":\"%s\",\"ours\":%.3f,\"unit\":\"s\",\"target\":%.3g}\n",
              part.c_str(), what.c_str(), seconds, target);
  std::fflush(stdout);
}

void rows_of(const std::string& process, const std::string& shoe, const Takt& takt) {
  const std::string what = process + ", " + shoe;
  row("line_and_path", what + ": computed, from the last profile to the checked path", takt.computed_s,
      k_line_and_path_s);
  row("way_there", what + ": from the scan's end to the path's beginning", takt.there_s, 0);
  row("approach", what, takt.approach_s, 0);
  row("work", what, takt.work_s, 0);
  row("retreat", what, takt.retreat_s, 0);
  row("path_planned", what + ": approach to retreat as planned", takt.planned_s, 0);
  const bool spray = process == "spray";
  const double counts_s = spray ? takt.whole_s() : takt.whole_s() - takt.work_s;
  const std::string words = spray ? ": scan, rest, way there, approach, work, retreat"
                                  : ": scan, rest, way there, approach, retreat";
  const double bar_s = spray ? k_whole_s : k_others_s;
  row(spray ? "whole" : "without_work", what + words, counts_s, bar_s);
  row(spray ? "whole_but_the_way_there" : "without_work_and_way_there", what, counts_s - takt.there_s, bar_s);
}

/// Of the spray alone: the others have no whole shoe's bar.
void rows_of_look(const std::string& shoe, const Takt& takt, const Look& look) {
  const std::string what = "spray, " + shoe;
  row("look_way_back", what + ": from the retreat's end to the second scan's begin",
      look.back_s + look.begin_s, 0);
  row("look_scan", what + ": of the stripe, from there", look.scan_s, 0);
  row("look", what + ": computed, from the last profile to the verdict", look.computed_s, 0);
  row("whole_with_look", what + ": scan to verdict", takt.whole_s() + look.all_s(), k_with_look_s);
  const second_look::Findings& found = look.found;
  if (!found.refusal && found.faults.empty() && found.unclear_mm == 0) return;
  ++misses;
  std::fprintf(stderr, "bench_takt: %s: the look tells %zu faults, and of %.0f of %.0f mm nothing%s%s\n",
               what.c_str(), found.faults.size(), found.unclear_mm, found.planned_mm,
               found.refusal ? ": " : "", found.refusal ? found.refusal->reason.c_str() : "");
}

int run(const Asked& asked) {
  const auto arm = sim::ArmKinematics::named(k_arm);
  for (int i = 0; i < asked.shoes; ++i) {
    const std::uint64_t seed = asked.first_seed + static_cast<std::uint64_t>(i);
    const Result<Shoe> shoe = make_shoe(seed, asked, *arm);
    if (!shoe) {
      std::fprintf(stderr, "bench_takt: shoe %d: %s\n", static_cast<int>(seed),
                   to_line(shoe.error()).c_str());
      return 1;
    }
    const std::string name = std::string{sim::name_of(asked.shoe_class)} + " shoe " + std::to_string(seed) +
                             " of size " + std::to_string(asked.size) + ", UR10e";
    row("scan", name + ": of the stripe, from begin to end",
        shoe->scan->full_until_s() - shoe->scan->full_from_s(), k_scan_s);
    row("scan_comes_to_rest", name, shoe->scan->duration_s() - shoe->scan->full_until_s(), 0);
    row("line", name + ": computed, from the last profile on", shoe->line_s, 0);
    for (const char* file : {"spray", "cement", "grind", "rough"}) {
      const Result<path::Process> process =
          path::read_process(std::filesystem::path{BITELINE_PROCESSES} / (std::string{file} + ".yaml"));
      const Result<Takt> takt =
          process ? takt_of(*shoe, *process, *arm) : Result<Takt>{tl::unexpected<Error>{process.error()}};
      if (takt) {
        rows_of(file, name, *takt);
        if (std::string_view{file} == "spray")
          rows_of_look(name, *takt, look_after(*shoe, *takt, asked, *arm));
      } else {
        ++misses;
        std::fprintf(stderr, "bench_takt: %s, %s: %s\n", file, name.c_str(), to_line(takt.error()).c_str());
      }
    }
  }
  return misses == 0 ? 0 : 1;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  biteline::bench::Asked asked;
  const auto number = [&](int place, double usual) { return argc > place ? std::atof(argv[place]) : usual; };
  asked.shoes = static_cast<int>(number(1, asked.shoes));
  asked.speed_mm_s = number(2, asked.speed_mm_s);
  const auto shoe_class = biteline::sim::shoe_class_named(argc > 3 ? argv[3] : "deep");
  asked.size = static_cast<int>(number(4, asked.size));
  asked.first_seed = static_cast<std::uint64_t>(number(5, static_cast<double>(asked.first_seed)));
  if (asked.shoes < 1 || !(asked.speed_mm_s > 0) || !shoe_class || asked.size < 1) {
    std::fprintf(stderr, "usage: bench_takt [SHOES [SPEED [CLASS [SIZE [FIRST]]]]]\n");
    return 2;
  }
  asked.shoe_class = *shoe_class;
  return biteline::bench::run(asked);
}
