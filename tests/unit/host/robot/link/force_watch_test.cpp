// SPDX-License-Identifier: MIT
// The watch of a path that presses: across it the place counts, along it the force.
#include <CppUTest/TestHarness.h>

#include "host/robot/link/path_watch.hpp"
#include "host/robot/link/ur/force_script.hpp"
#include "host/robot/path/force.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot {
namespace {

const path::CheckedPath& pressing_path() {
  static const path::PlanOutcome outcome = [] {
    path::PlanRequest asked = test::plan_request("grind.yaml");
    asked.process.force = path::Force{.set_newton = 20};
    return path::plan(asked);
  }();
  CHECK_TEXT(outcome.path.has_value(), outcome.reason().c_str());
  return *outcome.path;
}

struct Seen {
  double along_mm{0}, across_mm{0};  ///< off the path from the middle of the line on
  double newton{20};
  int word{static_cast<int>(ur::ForceWord::Presses)};
  int word_before{0};  ///< until then
};

/// What the watch says of states at each waypoint.
std::optional<HaltReason> watched(const Seen& seen) {
  const path::PlannedPath& path = pressing_path().path();
  RobotState state{.q_rad = path.waypoints.front().q_rad,
                   .T_base_tcp = path.waypoints.front().T_base_tcp,
                   .T_flange_tcp = path.T_flange_tcp,
                   .speed_ratio = 1,
                   .force_word = seen.word_before};
  PathWatch watch{path, {}, state};
  for (std::size_t i = 0; i < path.waypoints.size(); ++i) {
    const path::Waypoint& w = path.waypoints[i];
    state.sampled = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(w.time_s * 1e9) + 1}};
    state.q_rad = w.q_rad;
    state.T_base_tcp = w.T_base_tcp;
    state.force_base_newton = -20 * w.press_base;
    state.force_word = seen.word_before;
    if (i > path.waypoints.size() / 2 && w.segment == path::Segment::Line) {
      const Vec3 across = w.T_base_tcp.linear().col(2).cross(w.press_base).normalized();
      const Vec3 square = w.press_base.cross(across).normalized();
      state.T_base_tcp.translation() += seen.along_mm * w.press_base + seen.across_mm * square;
      state.force_base_newton = -seen.newton * w.press_base;
      state.force_word = seen.word;
    }
    if (auto halt = watch.look(state)) return halt;
  }
  return std::nullopt;
}

void check_halt(Halt expected, const Seen& seen) {
  const std::optional<HaltReason> halt = watched(seen);
  CHECK(halt.has_value());
  LONGS_EQUAL(static_cast<int>(expected), static_cast<int>(halt->code));
}

}  // namespace

TEST_GROUP(ForceWatch){};

TEST(ForceWatch, LetsTheTipLeaveThePathAlongTheForceAlone) {
  CHECK_FALSE(watched({}).has_value());
  CHECK_FALSE(watched({.along_mm = 2.8}).has_value());
  CHECK_FALSE(watched({.along_mm = -2.8}).has_value());
  check_halt(Halt::OffPath, {.across_mm = 2.8});
  check_halt(Halt::OffPath, {.along_mm = 3.5});
}

TEST(ForceWatch, StopsWhereTheForceStaysOff) {
  check_halt(Halt::ForceOff, {.newton = 8});
  check_halt(Halt::ForceOff, {.newton = 33});
  CHECK_FALSE(watched({.newton = 12}).has_value());
}

TEST(ForceWatch, NamesWhatTheProgramSays) {
  check_halt(Halt::NoContact, {.word = static_cast<int>(ur::ForceWord::Untouched)});
  check_halt(Halt::ContactLost, {.word = static_cast<int>(ur::ForceWord::Lost)});
  check_halt(Halt::ForceTooHigh, {.word = static_cast<int>(ur::ForceWord::TooHigh)});
}

/// A register keeps what the program before told, until this one takes it back.
TEST(ForceWatch, WordOfAnEarlierProgramEndsNothing) {
  const int lost = static_cast<int>(ur::ForceWord::Lost);
  CHECK_FALSE(watched({.word = lost, .word_before = lost}).has_value());
}

}  // namespace biteline::robot
