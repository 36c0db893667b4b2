// SPDX-License-Identifier: MIT
// A planned path in the simulated controller's hands: it takes the script of every process and comes by where
// the plan says.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <thread>

#include "hal/sim/robot/program.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/link/ur/told_kinematics.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/first_run.hpp"
#include "host/robot/path/force_told.hpp"
#include "tests/support/timed_test.hpp"
#include "tests/support/transforms.hpp"
#include "tests/unit/host/robot/kinematics/arms.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot {
namespace {

// What issue and method demand of a followed path.
constexpr double k_max_mm = 0.05;
constexpr double k_max_rad = 0.1 * std::numbers::pi / 180;

void check(const char* name, const path::TrackDeviation& d) {
  std::printf(
      "%-12s %zu samples, tip mean %.4f mm, max %.4f mm at %.0f mm, %.4f degrees; line mean %.4f mm, max "
      "%.4f mm\n",
      name, d.samples, d.mean_mm, d.max_mm, d.max_at_mm, d.max_rad * 180 / std::numbers::pi, d.line_mean_mm,
      d.line_max_mm);
  CHECK_TEXT(d.completed, name);
  CHECK_TEXT(d.covered > 0.999, name);
  CHECK_TEXT(d.max_mm <= k_max_mm, name);
  CHECK_TEXT(d.max_rad <= k_max_rad, name);
}

/// A stretched pose above the table, away from the shoe.
SE3 T_base_flange_home(const sim::ArmKinematics& arm) {
  sim::JointVector q_rad;
  q_rad << 0.0, -1.8, 1.6, -1.4, -1.57, 0.0;
  return arm.T_base_flange(q_rad);
}

/// Where the program has the tip, each of the controller's cycles.
std::vector<path::TrackSample> track_of(const sim::Program& program) {
  constexpr double k_cycle_s = 0.002;
  std::vector<path::TrackSample> track;
  for (double time_s = 0; time_s <= program.duration_s() + k_cycle_s; time_s += k_cycle_s) {
    track.push_back(
        {.time_s = time_s, .T_base_tcp = program.T_base_flange_at(time_s) * program.T_flange_tcp_at(time_s)});
  }
  return track;
}

Result<std::unique_ptr<ur::UrLink>> link_to(const sim::UrController& controller) {
  const sim::UrController::Ports ports = controller.ports();
  auto link = ur::UrLink::open({.host = "127.0.0.1",
                                .rtde_port = ports.rtde,
                                .script_port = ports.primary,
                                .dashboard_port = ports.dashboard,
                                .rate_hz = 0,
                                .connect_patience_s = 20});
  CHECK(link.has_value());
  return link;
}

}  // namespace

TEST_GROUP(FollowPath) {
  sim::ArmKinematics kinematics = *sim::ArmKinematics::named("ur5e");
};

TEST(FollowPath, EveryProcessRunsAndStaysOnThePlan) {
  for (const char* name : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    const path::CheckedPath path = test::planned_path(name);
    const auto script = sim::parse_script(ur::urscript(path));
    CHECK_TEXT(script.has_value(), name);
    const sim::Program program =
        sim::Program::plan(*script, kinematics, T_base_flange_home(kinematics), SE3::Identity());
    check(name, path::deviation(path.path(), track_of(program)));
  }
}

TEST(FollowPath, ZonedScriptLiftsTheToolOverWhatIsLeftOutAndKeepsToThePlan) {
  path::PlanRequest request = test::plan_request("grind.yaml");
  request.line = path::test::made_line({.taper = 0.2});  // its heel lies at the least x
  path::Zone heel{.name = "heel", .where = path::Zone::Where::Heel, .reach_ratio = 0.2, .left_out = true};
  // A millimetre in 10: the arm rounds a ramp of the usual 5 mm by 0.053 mm.
  path::Zone side{
      .name = "side", .from_ratio = 0.3, .to_ratio = 0.4, .up_by_mm = 1, .speed_ratio = 0.5, .ramp_mm = 10};
  request.process.zones = {heel, side};
  const path::PlanOutcome outcome = path::plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const path::PlannedPath& path = outcome.path->path();
  const auto script = sim::parse_script(ur::urscript(*outcome.path));
  CHECK(script.has_value());
  const sim::Program program =
      sim::Program::plan(*script, kinematics, T_base_flange_home(kinematics), SE3::Identity());
  const std::vector<path::TrackSample> track = track_of(program);
  check("zones", path::deviation(path, track));
  // The spindle turns at the toe, and nowhere near the heel that is left out.
  const auto by_x = [](const cloud::LinePoint& point) { return point.position.x(); };
  const auto [heel_end, toe_end] = std::ranges::minmax(request.line.points, {}, by_x);
  double least_to_heel_mm = 1e9, least_to_toe_mm = 1e9;
  for (const path::TrackSample& sample : track) {
    if (program.outputs_at(sample.time_s) != 1 << request.process.digital_output) continue;
    const Vec3 tip = sample.T_base_tcp.translation();
    least_to_heel_mm = std::min(least_to_heel_mm, (tip - heel_end.position).norm());
    least_to_toe_mm = std::min(least_to_toe_mm, (tip - toe_end.position).norm());
  }
  CHECK(least_to_heel_mm > 0.15 * 270);  // a fifth of the shoe's length is left out
  CHECK(least_to_toe_mm < 20);           // the tip's place is the process's, beside the line
  // The spindle turns in one stretch of time for each run along the line, and stands between them.
  int starts = 0;
  for (std::size_t i = 1; i < track.size(); ++i) {
    if (program.outputs_at(track[i].time_s) > program.outputs_at(track[i - 1].time_s)) ++starts;
  }
  LONGS_EQUAL(path::runs_of(path, path::Segment::Line).size(), starts);
}

TEST(FollowPath, FromBehindTheShoeOverRaisedPostures) {
  const test::FromBehind behind = test::from_behind("grind.yaml");
  CHECK_TEXT(behind.way.path.has_value(), behind.way.check.detail.c_str());
  const path::PlannedPath& path = behind.way.path->path();
  CHECK(!path.via_rad.empty());
  const auto script = sim::parse_script(ur::urscript(*behind.way.path));
  CHECK(script.has_value());
  const std::vector<path::TrackSample> track = track_of(
      sim::Program::plan(*script, kinematics, kinematics.T_base_flange(behind.from_rad), SE3::Identity()));
  check("from behind", path::deviation(path, track));
  auto from = track.begin();
  for (const kinematics::Joints& via_rad : path.via_rad) {  // it stops at each, in their order
    const Vec3 tip = (kinematics.T_base_flange(via_rad) * path.T_flange_tcp).translation();
    from = std::find_if(from, track.end(), [&](const auto& sample) {
      return (sample.T_base_tcp.translation() - tip).norm() < 0.5;
    });
    CHECK(from != track.end());
  }
}

/// The controller drives as planned, also where that is slow: else following stops an arm that is ahead.
TEST(FollowPath, SlowProcessTakesAsLongAsPlannedAlsoInTheAir) {
  path::PlanRequest request = test::plan_request("grind.yaml");
  request.process.motion.minimum_speed_mm_s = 0.05;
  for (const double speed_mm_s : {0.5, 4.0}) {
    request.process.motion.speed_mm_s = speed_mm_s;
    for (const bool in_air : {false, true}) {
      const path::PlanOutcome outcome = path::plan(in_air ? path::first_run(request) : request);
      CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
      const auto script = sim::parse_script(ur::urscript(*outcome.path));
      CHECK(script.has_value());
      const sim::Program program = sim::Program::plan(
          *script, kinematics, kinematics.T_base_flange(outcome.path->path().waypoints.front().q_rad),
          SE3::Identity());
      // What following allows.
      DOUBLES_EQUAL(outcome.path->duration_s(), program.duration_s(), 0.25 * outcome.path->duration_s());
    }
  }
}

TEST(FollowPath, OutputThatWasLeftOnIsOffInTheAir) {
  const path::PlanRequest request = test::plan_request("grind.yaml");
  const path::PlanOutcome outcome = path::plan(path::first_run(request));
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const auto script = sim::parse_script(ur::urscript(*outcome.path));
  CHECK(script.has_value());
  const auto left_on = static_cast<std::uint8_t>(1U << static_cast<unsigned>(request.process.digital_output));
  const sim::Program program =
      sim::Program::plan(*script, kinematics, T_base_flange_home(kinematics), SE3::Identity(), {}, left_on);
  for (double time_s = 0; time_s <= program.duration_s() + 1; time_s += 0.05)
    LONGS_EQUAL(0, program.outputs_at(time_s));

  // Over the network, after a program that was halted.
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  const auto controller = sim::UrController::open({}, arm, {});
  CHECK(controller.has_value());
  arm.run(*sim::parse_script("def left():\n  set_standard_digital_out(0, True)\nend\n"),
          hal::monotonic_now());
  const auto link = link_to(**controller);
  LONGS_EQUAL(left_on, arm.at(hal::monotonic_now()).outputs);
  CHECK((*link)->send(test::permitted(*outcome.path, (*link)->latest()->q_rad)).has_value());
  const auto runs = [&] {
    const sim::ArmState state = arm.at(hal::monotonic_now());
    return state.program_running && state.program_name == ur::k_program_name;
  };
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds{20};
  while (!runs() && std::chrono::steady_clock::now() < until) std::this_thread::yield();
  CHECK(runs());
  LONGS_EQUAL(0, arm.at(hal::monotonic_now()).outputs);
  // Somebody switches it on by hand in the middle: the way out by a stop ends that, too.
  arm.run(*sim::parse_script("def hand():\n  set_standard_digital_out(0, True)\n  sleep(100)\nend\n"),
          hal::monotonic_now());
  LONGS_EQUAL(left_on, arm.at(hal::monotonic_now()).outputs);
  CHECK((*link)->stop().has_value());
  while (arm.at(hal::monotonic_now()).outputs != 0 && std::chrono::steady_clock::now() < until)
    std::this_thread::yield();
  LONGS_EQUAL(0, arm.at(hal::monotonic_now()).outputs);
}

ORDINARY_TIMED_TEST(FollowPath, SentOverTheNetworkAndFollowedInRealTime) {
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  const auto controller = sim::UrController::open({}, arm, {});
  CHECK(controller.has_value());
  const auto link = link_to(**controller);
  const path::CheckedPath path = test::planned_path("spray.yaml");
  FollowReport report;
  const auto followed = follow(**link, test::permitted(path, (*link)->latest()->q_rad), {}, report);
  CHECK_TEXT(followed.has_value(), followed ? "" : to_line(followed.error()).c_str());
  check("over RTDE", report.deviation);
  CHECK_EQUAL(1U, (*controller)->scripts_run());
  CHECK(report.deviation.samples > 100 * path.duration_s());  // 500 Hz, and a busy machine may lose some
}

/// What the tool's two outputs did, cycle by cycle on the controller's thread.
class FlowSeen {
 public:
  FlowSeen(const path::PlannedPath& path, double full_mm_s) : path_{path}, full_mm_s_{full_mm_s} {}

  std::atomic<double> ratio{0};
  std::atomic<bool> gun{false}, closed_before_the_tool_left{false};
  std::atomic<int> cycles{0}, right{0};  ///< with the gun open and the tip on its way

  void take(SensorClock::time_point instant, const sim::ArmState& state) {
    const SE3 T = state.T_base_flange * state.T_flange_tcp;
    const Vec3 spot = T.translation() + path_.standoff_mm * T.linear().col(2);
    const double speed_mm_s =
        (spot - spot_).norm() / std::chrono::duration<double>(instant - instant_).count();
    spot_ = spot;
    instant_ = instant;
    const bool open = ((state.outputs >> static_cast<unsigned>(path_.digital_output)) & 1U) != 0;
    if (gun && !open && state.moving) closed_before_the_tool_left = true;
    gun = open;
    ratio = state.analog_ratio[0];
    constexpr double k_moves_mm_s = 5;
    if (!open || speed_mm_s < k_moves_mm_s) return;
    ++cycles;
    if (std::abs(state.analog_ratio[0] - speed_mm_s / full_mm_s_) < 0.03) ++right;
  }

 private:
  const path::PlannedPath& path_;
  double full_mm_s_;
  Vec3 spot_{Vec3::Zero()};
  SensorClock::time_point instant_{};
};

/// The gun closes while the tip still goes along its overlap, and a stop in the middle ends both outputs.
ORDINARY_TIMED_TEST(FollowPath, FlowGoesAlongAndEndsWithThePathAndWithAStop) {
  path::PlanRequest request = test::plan_request("spray.yaml");
  request.process.flow = path::Flow{.gun_on_s = 0.04,
                                    .gun_off_s = 0.025,
                                    .film_overlap_mm = 2,
                                    .analog_output = 0,
                                    .full_mm_s = 2 * request.process.motion.speed_mm_s};
  const path::PlanOutcome outcome = path::plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  FlowSeen seen{outcome.path->path(), request.process.flow->full_mm_s};
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  const auto controller = sim::UrController::open(
      {}, arm, [&](SensorClock::time_point instant, const sim::ArmState& state, const sim::ArmReal&) {
        seen.take(instant, state);
      });
  CHECK(controller.has_value());
  const auto link = link_to(**controller);
  FollowReport report;
  const auto followed = follow(**link, test::permitted(*outcome.path, (*link)->latest()->q_rad), {}, report);
  CHECK_TEXT(followed.has_value(), followed ? "" : to_line(followed.error()).c_str());
  check("with flow", report.deviation);
  CHECK(seen.closed_before_the_tool_left);
  // A busy machine skips cycles of the simulated controller, whose thread takes each for one cycle long.
  CHECK(seen.cycles > 100);
  CHECK(seen.right > 0.8 * seen.cycles);
  CHECK_FALSE(seen.gun);
  DOUBLES_EQUAL(0, seen.ratio, 0);

  CHECK((*link)->send(test::permitted(*outcome.path, (*link)->latest()->q_rad)).has_value());
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds{30};
  const auto wait_for = [&](const auto& holds) {
    while (!holds() && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    CHECK(holds());
  };
  wait_for([&] { return seen.gun && seen.ratio > 0.2; });
  CHECK((*link)->stop().has_value());
  wait_for([&] { return !seen.gun && seen.ratio == 0; });
}

/// What a path presses on: 0.3 mm before the planned tip, 20 N/mm.  On the controller's thread.
class ElasticUpper {
 public:
  static constexpr double k_newton_mm = 20, k_before_mm = 0.3;

  explicit ElasticUpper(const path::PlannedPath& path) {
    for (const path::Waypoint& waypoint : path.waypoints)
      if (waypoint.segment == path::Segment::Line) line_.push_back(waypoint);
  }

  std::atomic<bool> ends_halfway{false};
  std::atomic<int> cycles{0}, right{0};  ///< on the middle of the line, and within 15 % of the set force

  [[nodiscard]] Vec3 newton(const SE3& T_base_tcp, double set_newton) {
    const Vec3 tip = T_base_tcp.translation();
    const auto off_mm = [&](const path::Waypoint& w) { return (w.T_base_tcp.translation() - tip).norm(); };
    const auto at = std::ranges::min_element(line_, {}, off_mm);
    const double done = static_cast<double>(at - line_.begin()) / static_cast<double>(line_.size());
    constexpr double k_near_mm = 10;
    if (off_mm(*at) > k_near_mm || (ends_halfway && done > 0.5)) return Vec3::Zero();
    const double pressed_mm = (tip - at->T_base_tcp.translation()).dot(at->press_base) + k_before_mm;
    const double newton = k_newton_mm * std::max(0.0, pressed_mm);
    if (done > 0.15 && done < 0.85) {
      ++cycles;
      if (std::abs(newton - set_newton) < 0.15 * set_newton) ++right;
    }
    return -newton * at->press_base;
  }

 private:
  std::vector<path::Waypoint> line_;
};

/// The force is kept on a surface that is there, and a surface that ends is a named stop with the tool off.
ORDINARY_TIMED_TEST(FollowPath, PressesOverTheNetworkAndNamesALostContact) {
  path::PlanRequest request = test::plan_request("rough.yaml");
  request.process.force = path::Force{.set_newton = 15};
  request.process.only = {{.from_mm = 20, .to_mm = 260}};
  const path::PlanOutcome outcome = path::plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  ElasticUpper upper{outcome.path->path()};
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  sim::UrController::Config config;
  config.touch = [&](const SE3& T_base_tcp, double) { return upper.newton(T_base_tcp, 15); };
  const auto controller = sim::UrController::open(config, arm, {});
  CHECK(controller.has_value());
  const sim::UrController::Ports ports = (*controller)->ports();
  const auto link = ur::UrLink::open({.host = "127.0.0.1",
                                      .rtde_port = ports.rtde,
                                      .script_port = ports.primary,
                                      .dashboard_port = ports.dashboard,
                                      .rate_hz = 0,
                                      .connect_patience_s = 20,
                                      .ask_force = true});
  CHECK_TEXT(link.has_value(), link ? "" : to_line(link.error()).c_str());
  FollowReport pressed;
  const auto done = follow(**link, test::permitted(*outcome.path, (*link)->latest()->q_rad), {}, pressed);
  CHECK_TEXT(done.has_value(), done ? "" : to_line(done.error()).c_str());
  CHECK(upper.cycles > 100);
  CHECK(upper.right > 0.8 * upper.cycles);

  upper.ends_halfway = true;
  FollowReport lost;
  const auto stopped = follow(**link, test::permitted(*outcome.path, (*link)->latest()->q_rad), {}, lost);
  CHECK(!stopped.has_value());
  CHECK(lost.halt.has_value());
  CHECK_TEXT(lost.halt->code == Halt::ContactLost, lost.halt->reason.c_str());
  LONGS_EQUAL(0, arm.at(hal::monotonic_now()).outputs);
}

/// The same by a flange: its lines and its reading go over the controller's terminals and RTDE.
ORDINARY_TIMED_TEST(FollowPath, PressesByAFlangeAndNamesADeadOne) {
  path::PlanRequest request = test::plan_request("rough.yaml");
  request.process.tool.free_turn_rad = 0;
  request.process.placement.outwards = path::Outwards::Normal;
  request.process.force =
      path::Force{.set_newton = 15,
                  .flange = path::Flange{
                      .on_output = 4, .ready_input = 5, .tilt_rad = request.process.placement.tilt_rad}};
  request.process.only = {{.from_mm = 20, .to_mm = 260}};
  const path::PlanOutcome outcome = path::plan(request);
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  const path::Flange& asked = *request.process.force->flange;
  const auto run = [&](double dead_after_s, FollowReport& report) -> Result<void> {
    ElasticUpper upper{outcome.path->path()};
    sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
    sim::UrController::Config config;
    config.touch = [&](const SE3& T_base_tip, double) { return upper.newton(T_base_tip, 15); };
    config.flange = sim::FlangeFacts{.on_output = asked.on_output,
                                     .ready_input = asked.ready_input,
                                     .axis_tcp = path::axis_tcp(asked),
                                     .dead_after_s = dead_after_s};
    BITELINE_ASSIGN(const auto controller, sim::UrController::open(config, arm, {}));
    const sim::UrController::Ports ports = controller->ports();
    BITELINE_ASSIGN(const auto link, ur::UrLink::open({.host = "127.0.0.1",
                                                       .rtde_port = ports.rtde,
                                                       .script_port = ports.primary,
                                                       .dashboard_port = ports.dashboard,
                                                       .rate_hz = 0,
                                                       .connect_patience_s = 20,
                                                       .ask_force = true,
                                                       .flange_input = asked.analog_input}));
    const Result<void> done =
        follow(*link, test::permitted(*outcome.path, link->latest()->q_rad), {}, report);
    if (done) {
      CHECK(upper.cycles > 100);
      CHECK(upper.right > 0.8 * upper.cycles);
    }
    LONGS_EQUAL(0, arm.at(hal::monotonic_now()).outputs);
    return done;
  };
  FollowReport pressed;
  const Result<void> done = run(1e9, pressed);
  CHECK_TEXT(done.has_value(), done ? "" : to_line(done.error()).c_str());
  const auto told = path::force_told(outcome.path->path(), pressed.track, {});
  CHECK(told && told->samples > 100);
  DOUBLES_EQUAL(15, told->mean_newton, 0.05 * 15);

  FollowReport dead;
  CHECK(!run(2, dead).has_value());
  CHECK(dead.halt.has_value());
  CHECK_TEXT(dead.halt->code == Halt::FlangeDead, dead.halt->reason.c_str());
}

/// An arm as it leaves the factory: its controller's rows are those by which it moves, and a path planned
/// with them is met.
TEST(FollowPath, ArmsOwnKinematicsComeFromItsController) {
  const kinematics::ArmModel nominal = *kinematics::arm_model("UR5e");
  double most_off_mm = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const sim::ArmKinematics own = kinematics.made(seed);
    sim::Arm arm{own, T_base_flange_home(own)};
    const auto controller = sim::UrController::open({}, arm, {});
    CHECK(controller.has_value());
    for (const std::uint16_t port : {(*controller)->ports().script, (*controller)->ports().primary}) {
      const auto told = ur::ask_kinematics({.host = "127.0.0.1", .port = port}, std::chrono::seconds{10});
      CHECK_TEXT(told.has_value(), told ? "" : to_line(told.error()).c_str());
      const auto model = kinematics::with_rows(nominal, told->rows, "told");
      CHECK_TEXT(model.has_value(), model ? "" : to_line(model.error()).c_str());
      kinematics::test::RandomJoints random{seed};
      for (int i = 0; i < 50; ++i) {
        const kinematics::Joints q_rad = random.next();
        TRANSFORMS_EQUAL(own.T_base_flange(q_rad), kinematics::forward(*model, q_rad), 1e-6, 1e-9);
        most_off_mm = std::max(most_off_mm, (own.T_base_flange(q_rad).translation() -
                                             kinematics::forward(nominal, q_rad).translation())
                                                .norm());
      }
    }
  }
  // As published arms are: some millimetres beside the nominal one.
  CHECK(most_off_mm > 1);
  CHECK(most_off_mm < 10);
}

/// Half speed, a tenth, a hand that stops it for five seconds, and the whole again: nothing is stopped, and
/// the tool is on along the line alone.
ORDINARY_TIMED_TEST(FollowPath, OperatorsSliderIsObeyedAndNoFault) {
  sim::Arm arm{kinematics, T_base_flange_home(kinematics)};
  const auto controller = sim::UrController::open({.speed_slider_ratio = 0.5}, arm, {});
  CHECK(controller.has_value());
  const auto link = link_to(**controller);
  const path::CheckedPath path = test::planned_path("spray.yaml");
  std::atomic<bool> over{false};
  const auto on_line = [&] {
    const sim::ArmState state = arm.at(hal::monotonic_now());
    return state.program_running && state.program_name == ur::k_program_name && state.outputs != 0;
  };
  const auto pass = [&](double time_s) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
    while (!over && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
  };
  double stood_mm = -1;
  std::thread hand{[&] {
    while (!over && !on_line()) std::this_thread::sleep_for(std::chrono::milliseconds{5});
    (*controller)->set_speed_slider(0.1);
    pass(2);
    (*controller)->set_speed_slider(0);
    pass(1);
    const Vec3 before = arm.at(hal::monotonic_now()).T_base_flange.translation();
    pass(4);
    stood_mm = (arm.at(hal::monotonic_now()).T_base_flange.translation() - before).norm();
    (*controller)->set_speed_slider(1);
    (*controller)->set_speed_scaling(0.7);
  }};
  FollowReport report;
  const auto followed = follow(**link, test::permitted(path, (*link)->latest()->q_rad), {}, report);
  over = true;
  hand.join();
  CHECK_TEXT(followed.has_value(), followed ? "" : to_line(followed.error()).c_str());
  check("slider", report.deviation);
  DOUBLES_EQUAL(0, report.slowest_speed_ratio, 0);
  DOUBLES_EQUAL(0, stood_mm, 0);
  CHECK(report.duration_s > path.duration_s() / 0.7 + 5);
  LONGS_EQUAL(0, arm.at(hal::monotonic_now()).outputs);
}

}  // namespace biteline::robot
