// SPDX-License-Identifier: MIT
#include "host/robot/path/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/fixed_text.hpp"
#include "common/core/plain_number.hpp"
#include "host/robot/path/checks/cloud_check.hpp"
#include "host/robot/path/checks/sight.hpp"
#include "host/robot/path/checks/way_there.hpp"
#include "host/robot/path/entry.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/purge.hpp"
#include "host/robot/path/tip_bound.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::path {
namespace {

cloud::ClosedLine moved(const cloud::ClosedLine& line, const SE3& T_to_from) {
  cloud::ClosedLine out = line;
  for (cloud::LinePoint& p : out.points) {
    p.position = T_to_from * p.position;
    p.normal = T_to_from.linear() * p.normal;
    p.tangent = T_to_from.linear() * p.tangent;
  }
  return out;
}

// Profiles of a scan lie closer than this.
constexpr double k_scan_spacing_mm = 1.5;

/// The request's geometry in the arm's own base.
struct Scene {
  cloud::ClosedLine line;
  Surroundings surroundings;
  Occupancy seen{{}, 0};  ///< the shoe as sight lines meet it; of a scan only
};

Occupancy guessed(const Surroundings& surroundings) {
  std::vector<Eigen::Vector3f> points;
  for (const Vec3& p : surroundings.shoe_points) points.push_back(p.cast<float>());
  return Occupancy{points, surroundings.shoe_spacing_mm};
}

Scene scene_of(const PlanRequest& request) {
  const SE3 T_base_line = request.T_line_base.inverse();
  const double table_z_mm = request.table_z_mm + T_base_line.translation().z();
  Scene scene{.line = moved(request.line, T_base_line), .surroundings = {}};
  std::vector<Eigen::Vector3f> surface;
  scene.surroundings = surroundings_of_line(scene.line, request.shoe, table_z_mm);
  if (!request.cloud.empty()) {
    std::vector<Eigen::Vector3f> cloud = request.cloud;
    const Eigen::Isometry3f T = T_base_line.cast<float>();
    for (Eigen::Vector3f& p : cloud) p = T * p;
    replace_shoe(scene.surroundings, cloud);
    surface = std::move(cloud);
  }
  if (request.fixture) {
    Fixture fixture = *request.fixture;
    fixture.top_z_mm += T_base_line.translation().z();
    add_fixture(scene.surroundings, scene.line, fixture);
  }
  if (request.process.sight)
    scene.seen = request.cloud.empty() ? guessed(scene.surroundings) : Occupancy{surface, k_scan_spacing_mm};
  return scene;
}

Scene shifted(const Scene& scene, const Vec3& by_mm) {
  Scene out{.line = scene.line, .surroundings = scene.surroundings};
  for (cloud::LinePoint& p : out.line.points) p.position += by_mm;
  for (Vec3& p : out.surroundings.shoe_points) p += by_mm;
  if (out.surroundings.fixture) {
    out.surroundings.fixture->top_z_mm += by_mm.z();
    for (Vec2& corner : out.surroundings.fixture->outline) corner += by_mm.head<2>();
  }
  // Raised on a block, the shoe leaves the table where it is.
  return out;
}

/// A place that cannot be reached at all cannot be reached from another beginning either.
bool depends_on_seam(const Blockage& blockage) {
  return blockage.what == Obstacle::Jump || blockage.what == Obstacle::None;
}

bool is_possible(const Scene& scene, const Process& process, const kinematics::ArmModel& arm) {
  // Coarser than the plan itself: a trial, and there are dozens.
  const JointPathOptions trial{
      .knot_spacing_mm = 16, .turns = 18, .least_singularity = 0.06, .least_clearance_mm = 4};
  constexpr std::size_t k_seams = 3;
  const CollisionModel collisions{arm, process.tool, scene.surroundings};
  const std::vector<Seam> seams = seam_candidates(scene.line, process);
  for (std::size_t i = 0; i < std::min(k_seams, seams.size()); ++i) {
    const ToolPath path = make_tool_path(scene.line, process, seams[i].arc_mm);
    const JointPathResult result = find_joint_path(arm, path, process.tool, collisions, trial);
    if (result.path) return true;
    if (!depends_on_seam(result.blockage)) return false;
  }
  return false;
}

/// Shifts of the shoe over the table and on a block, the shortest first.
std::vector<Vec3> shifts() {
  std::vector<Vec3> out;
  for (const double z_mm : {0.0, 100.0}) {
    for (double x_mm = -300; x_mm <= 300; x_mm += 100) {
      for (double y_mm = -300; y_mm <= 300; y_mm += 100) out.emplace_back(x_mm, y_mm, z_mm);
    }
  }
  std::ranges::sort(out, {}, [](const Vec3& v) { return v.norm(); });
  out.erase(out.begin());  // no shift: that is what failed
  return out;
}

/// Tries at most `k_trials` shifts and all tilts.
Remedy find_remedy(const Scene& scene, const Process& process, kinematics::ArmModel arm) {
  constexpr std::size_t k_trials = 60;
  arm.T_fixed = kinematics::nominal_frames(arm.nominal);
  arm.calibrated = false;  // a trial need not be exact, and the closed form is twenty times faster
  Remedy remedy;
  const std::vector<Vec3> candidates = shifts();
  for (std::size_t i = 0; i < std::min(k_trials, candidates.size()) && !remedy.move_shoe_base; ++i) {
    if (is_possible(shifted(scene, candidates[i]), process, arm)) remedy.move_shoe_base = candidates[i];
  }
  constexpr double k_rad_per_deg = std::numbers::pi / 180;
  for (const double by_deg : {10.0, -10.0, 20.0, -20.0, 30.0, -30.0}) {
    Process tilted = process;
    tilted.placement.tilt_rad += by_deg * k_rad_per_deg;
    if (std::abs(tilted.placement.tilt_rad) > std::numbers::pi / 2) continue;
    if (!is_possible(scene, tilted, arm)) continue;
    remedy.tilt_rad = tilted.placement.tilt_rad;
    break;
  }
  return remedy;
}

/// Nothing is left out, so that the first run comes over its own beginning.
bool is_closed(const Process& process) {
  return process.only.empty() && std::ranges::none_of(process.zones, &Zone::left_out);
}

PlannedPath assembled(const PlanRequest& request, const ToolPath& path, const JointPath& joints,
                      const Timing& timing) {
  PlannedPath out{.robot = request.arm.name,
                  .process = request.process.name,
                  .T_flange_tcp = request.process.tool.T_flange_tcp,
                  .payload = carried(request.process, request.mounted),
                  .motion = request.process.motion,
                  .digital_output = request.process.digital_output,
                  .flow = request.process.flow,
                  .force = request.process.force,
                  .standoff_mm = request.process.placement.standoff_mm,
                  .overlap_mm = is_closed(request.process) ? request.process.motion.overlap_mm : 0,
                  .tool_off = request.tool_off,
                  .tip_u95_mm = request.mounted.tip_u95_mm,
                  .waypoints = {}};
  out.motion.spacing_mm = path.spacing_mm;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const ToolPoint& p = path.points[i];
    out.waypoints.push_back(
        {.T_base_tcp = p.T_base_tcp * Eigen::AngleAxisd(joints.turn_rad[i], Vec3::UnitZ()),
         .q_rad = joints.q_rad[i],
         .segment = p.segment,
         .speed_mm_s = timing.speed_mm_s[i],
         .time_s = timing.time_s[i],
         .arc_mm = p.arc_mm,
         .line_base = p.line_base,
         .u95_mm = p.u95_mm,
         .speed_ratio = p.speed_ratio});
    if (!timing.acceleration_mm_s2.empty())
      out.waypoints.back().acceleration_mm_s2 = timing.acceleration_mm_s2[i];
  }
  set_forces(out, path.points, request.process);
  out.give_mm = largest_give_mm(out, request.arm);
  if (purges(out.flow, out.tool_off))
    out.purge_rad = purge_posture(request.arm, request.process.tool, *out.flow, out.waypoints.front().q_rad);
  return out;
}

/// The moves are straight and few: within the process's own accuracy, or there is no path.
Check chord_check(const ToolPath& path, const Motion& motion) {
  Check check{.name = "straight moves",
              .passed = path.chord_error_mm <= motion.chord_error_mm,
              .value = path.chord_error_mm,
              .limit = motion.chord_error_mm,
              .unit = "mm",
              .arc_mm = path.chord_error_arc_mm,
              .detail = {}};
  if (!check.passed)
    check.detail = FixedText<120>::format(
                       "targets %.2f mm apart, as blends and their number need it, cut the "
                       "line's corners",
                       path.spacing_mm)
                       .view();
  return check;
}

/// Of a path that is to touch nothing.
Check air_check(const PlannedPath& path, const Surroundings& surroundings, double least_mm) {
  Check check{.name = "tip in the air",
              .passed = true,
              .value = k_far_mm,
              .limit = least_mm,
              .unit = "mm",
              .arc_mm = -1,
              .detail = {}};
  // The surface may be that much nearer between the points.
  const double gap_mm = 0.5 * surroundings.shoe_spacing_mm;
  for (const Waypoint& waypoint : path.waypoints) {
    if (waypoint.segment != Segment::Line) continue;
    for (const Vec3& point : surroundings.shoe_points) {
      const double mm = (waypoint.T_base_tcp.translation() - point).norm() - gap_mm;
      if (mm >= check.value) continue;
      check.value = mm;
      check.arc_mm = waypoint.arc_mm;
    }
  }
  check.passed = check.value >= least_mm;
  if (!check.passed) check.detail = "the tool's tip comes too near to the shoe";
  return check;
}

/// Of a path that purges before its line.
Check purge_check(const Process& process, const CheckedPath& path, const Surroundings& surroundings) {
  Check check = check_purge(process, surroundings);
  if (path.path().purge_rad) return check;
  check.passed = false;
  check.detail = "the arm does not reach the place of the purge with the tool straight down";
  return check;
}

/// Where the arm stands before, or about so, where that is known.
std::optional<kinematics::Joints> stands_at(const PlanRequest& request) {
  const std::optional<kinematics::Joints>& from_rad = request.from_rad ? request.from_rad : request.near_rad;
  // Any other number is none of a joint, and find_way_there() says so.
  constexpr double k_most_rad = 4 * std::numbers::pi;
  const bool known = from_rad && (from_rad->cwiseAbs().array() <= k_most_rad).all();
  return known ? from_rad : std::nullopt;
}

/// The line entered at one place: how far that gets.
struct Attempt {
  ToolPath tool_path;
  Blockage blockage;
  CheckOutcome outcome;
};
Attempt try_entry(const PlanRequest& request, const Scene& scene, const CollisionModel& collisions,
                  double seam_mm, double farther_back_mm) {
  Attempt attempt{.tool_path = make_tool_path(scene.line, request.process, seam_mm, farther_back_mm),
                  .blockage = {},
                  .outcome = {}};
  const JointPathResult joints = find_joint_path(request.arm, attempt.tool_path, request.process.tool,
                                                 collisions, {.near_rad = stands_at(request)});
  attempt.blockage = joints.blockage;
  if (!joints.path) return attempt;
  const Timing timing = time_path(request.arm, attempt.tool_path, *joints.path, request.process.motion);
  attempt.outcome =
      check_path(assembled(request, attempt.tool_path, *joints.path, timing), request.arm, collisions, {});
  attempt.outcome.checks.push_back(chord_check(attempt.tool_path, request.process.motion));
  if (!attempt.outcome.checks.back().passed) attempt.outcome.path.reset();
  if (request.least_tip_to_shoe_mm > 0 && attempt.outcome.path) {
    attempt.outcome.checks.push_back(
        air_check(attempt.outcome.path->path(), scene.surroundings, request.least_tip_to_shoe_mm));
    if (!attempt.outcome.checks.back().passed) attempt.outcome.path.reset();
  }
  if (purges(request.process.flow, request.tool_off) && attempt.outcome.path) {
    attempt.outcome.checks.push_back(purge_check(request.process, *attempt.outcome.path, scene.surroundings));
    if (!attempt.outcome.checks.back().passed) attempt.outcome.path.reset();
  }
  if (request.process.sight && attempt.outcome.path) {
    attempt.outcome.checks.push_back(
        sight_check(attempt.outcome.path->path(), *request.process.sight, scene.seen));
    if (!attempt.outcome.checks.back().passed) attempt.outcome.path.reset();
  }
  return attempt;
}

std::string words(const Remedy& remedy) {
  std::string out;
  if (remedy.move_shoe_base) {
    const Vec3& m = *remedy.move_shoe_base;
    out += FixedText<120>::format("; it works with the shoe moved by (%.0f, %.0f, %.0f) mm in the arm's base",
                                  m.x(), m.y(), m.z())
               .view();
  }
  if (remedy.tilt_rad) {
    out += FixedText<120>::format("; it works with the tool tilted to %.0f degrees",
                                  *remedy.tilt_rad * 180 / std::numbers::pi)
               .view();
  }
  return out.empty() ? "; no small move of the shoe and no other tilt helps" : out;
}

}  // namespace

std::string failures(const std::vector<Check>& checks) {
  std::string out;
  for (const Check& check : checks) {
    if (check.passed) continue;
    out += out.empty() ? "" : "; ";
    out += FixedText<256>::format("%s: %s (%s, limit %s %s", check.name.c_str(), check.detail.c_str(),
                                  plain_number(check.value).c_str(), plain_number(check.limit).c_str(),
                                  check.unit.c_str())
               .view();
    if (check.arc_mm >= 0) out += FixedText<40>::format(", at %.0f mm", check.arc_mm).view();
    out += ")";
  }
  return out;
}

PlanOutcome plan(const PlanRequest& request) {
  PlanOutcome out;
  out.checks = check_mounted(request.process, request.mounted);
  if (!all_passed(out.checks)) {
    out.refusal = Refusal{.code = Refused::NotAsTaught, .reason = failures(out.checks)};
    return out;
  }
  // First of the line, since what comes after lays grids over the line: how large they get is its matter.
  for (Check& check : check_line(moved(request.line, request.T_line_base.inverse())))
    out.checks.push_back(std::move(check));
  if (all_passed(out.checks) && !request.cloud.empty())
    out.checks.push_back(check_on_cloud(request.line, request.cloud));
  std::vector<Check> path_checks;
  if (!all_passed(out.checks)) {
    out.refusal = Refusal{.code = Refused::LineUnfit, .reason = failures(out.checks)};
    return out;
  }
  for (Check& check : check_zones(request.line, request.process)) out.checks.push_back(std::move(check));
  for (Check& check : check_pieces(request.line, request.process)) out.checks.push_back(std::move(check));
  if (!all_passed(out.checks)) {
    out.refusal = Refusal{.code = Refused::LineUnfit, .reason = failures(out.checks)};
    return out;
  }
  const Scene scene = scene_of(request);
  out.surroundings = scene.surroundings;
  const CollisionModel collisions{request.arm, request.process.tool, scene.surroundings};
  bool first = true;
  const std::optional<kinematics::Joints> from_rad = stands_at(request);
  for (const Seam& seam : seams_in_order(scene.line, request.process, request.arm, from_rad)) {
    const double back_mm =
        from_rad ? farther_back_mm(seam, request.process.tool, request.arm, collisions, *from_rad) : 0;
    Attempt attempt = try_entry(request, scene, collisions, seam.arc_mm, back_mm);
    if (first || attempt.outcome.path) {
      out.tool_path = std::move(attempt.tool_path);
      out.blockage = attempt.blockage;
      path_checks = std::move(attempt.outcome.checks);
      out.path = std::move(attempt.outcome.path);
      first = false;
    }
    if (out.path || !depends_on_seam(out.blockage)) break;
  }
  out.checks.insert(out.checks.end(), path_checks.begin(), path_checks.end());
  if (out.path && request.from_rad) {
    WayThere way = find_way_there(*request.from_rad, *out.path, request.arm, collisions);
    out.checks.push_back(std::move(way.check));
    out.path = std::move(way.path);
    if (!out.path) {
      out.refusal = Refusal{.code = Refused::NoFreeWayToBegin, .reason = failures(out.checks)};
      return out;
    }
  }
  if (out.path) return out;
  if (out.blockage.what == Obstacle::None) {
    out.refusal = Refusal{.code = Refused::PathCheckFailed, .reason = failures(out.checks)};
    return out;
  }
  if (request.seek_remedy) out.remedy = find_remedy(scene, request.process, request.arm);
  const std::string help = request.seek_remedy ? words(out.remedy) : std::string{};
  const auto stuck =
      FixedText<200>::format("%s cannot follow the line: stuck at %.0f mm of the path, %s",
                             request.arm.name.c_str(), out.blockage.arc_mm, out.blockage.detail.c_str());
  out.refusal = Refusal{.code = Refused::CannotFollow, .reason = stuck.c_str() + help};
  return out;
}

}  // namespace biteline::path
