// SPDX-License-Identifier: MIT
#pragma once
/// \file Each state of an arm that follows, against the path in space and time.

#include <optional>

#include "host/robot/link/halt.hpp"
#include "host/robot/link/robot_link.hpp"
#include "host/robot/path/place.hpp"

namespace biteline::robot {

/// From where the arm stands, over the way there, along the path.  Knows nothing of links and clocks: states
/// in, a reason to stop out.  Not thread-safe; the path outlives it.
class PathWatch {
 public:
  /// `from`: where the arm stood when its way to the path was checked.
  PathWatch(const path::PlannedPath& path, const path::FollowLimits& limits, const RobotState& from);

  /// What is beyond a limit at this state.  Pre: states in their order, while the program runs.
  [[nodiscard]] std::optional<HaltReason> look(const RobotState& state);

  /// What a program that presses says of its end; also of a program that has ended.
  [[nodiscard]] std::optional<HaltReason> look_at_word(const RobotState& state) const;

  /// Of the path, before the tip.
  [[nodiscard]] double to_come_mm() const { return path_.waypoints.back().arc_mm - here_mm_; }

 private:
  [[nodiscard]] std::optional<HaltReason> look_at_way(const RobotState& state);
  [[nodiscard]] std::optional<HaltReason> look_at_path(const RobotState& state);
  [[nodiscard]] std::optional<HaltReason> look_at_force(const RobotState& state,
                                                        const path::PathPlace& place);
  [[nodiscard]] std::optional<HaltReason> look_at_time(double planned_s);
  [[nodiscard]] bool at_beginning(const RobotState& state) const;

  const path::PlannedPath& path_;
  path::FollowLimits limits_;
  std::vector<kinematics::Joints> stops_;  ///< of the way there
  double fastest_mm_s_{0};
  std::size_t leg_{0};
  bool on_path_{false};
  double here_mm_{0};
  RobotClock::time_point last_;
  double step_s_{0};     ///< since the state before, by the robot's clock
  double running_s_{0};  ///< since the path's beginning, as if at full speed
  double advanced_mm_{0}, advanced_at_s_{0};
  double force_off_s_{0};     ///< beyond the tolerance, in a row
  double pressed_newton_{0};  ///< told, through a lag
  bool pressed_{false};
  bool word_is_new_{false};  ///< the program has taken back what an earlier one told
};

}  // namespace biteline::robot
