// SPDX-License-Identifier: MIT
#pragma once
/// \file The simulated arm: where it is at any instant, and what it was told to do.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/time/clocks.hpp"
#include "hal/sim/robot/program.hpp"
#include "hal/sim/robot/real_joints.hpp"

namespace biteline::sim {

/// A way in time that no script describes: the scan.  Of the joints, or of the flange alone.
struct FlangeMotion {
  std::string name;
  double duration_s{0};
  std::function<JointVector(double time_s)>
      q_rad_at{};  ///< for 0 <= time <= duration; none: no links looked at
  std::function<SE3(double time_s)> T_base_flange_at{};  ///< likewise, where there is no q_rad_at
  std::optional<JointVector> q_end_rad{};                ///< at its end, where the links reach so far
};

/// What the arm does at one instant.
struct ArmState {
  SE3 T_base_flange{SE3::Identity()};
  SE3 T_flange_tcp{SE3::Identity()};
  std::optional<JointVector> q_rad{};  ///< where known; elsewhere they are followed from pose to pose
  bool moving{false};                  ///< a motion or program is on
  bool program_running{false};         ///< also while it is paused
  bool paused{false};
  std::string program_name{};
  std::uint32_t outputs{0};              ///< digital outputs, as DigitalOutStep counts them
  std::array<double, 2> analog_ratio{};  ///< analog outputs, of their range
  Payload payload{};                     ///< as the last program said
};

/// Where the arm is, and where its controller says it is.
struct ArmReal {
  SE3 T_base_flange{SE3::Identity()};
  SE3 T_base_flange_told{SE3::Identity()};  ///< by the encoders
  std::optional<JointVector> q_told_rad{};  ///< where known
};

/// The controller's target is where its program says, at every instant.  The arm itself is off that by its
/// dynamics; without any it is ideal.  So it is where the joints are not known: the way of a head on a
/// straight holder.
/// Thread: any.
class Arm {
 public:
  Arm(const ArmKinematics& kinematics, const SE3& T_base_flange_start, const ArmDynamics& dynamics = {});
  Arm(const ArmKinematics& kinematics, const JointVector& q_start_rad, const ArmDynamics& dynamics = {});

  /// The target.
  [[nodiscard]] ArmState at(SensorClock::time_point instant) const;
  /// Not much later than now: what has been answered stays so, whatever is run after.
  [[nodiscard]] ArmReal real_at(SensorClock::time_point instant) const;

  /// Replaces whatever is on; begins at `begin` from where the arm then is.
  void run(FlangeMotion motion, SensorClock::time_point begin);
  void run(const Script& script, SensorClock::time_point begin);
  /// Stands still from `instant` on.  Outputs stay as they are.
  void stop(SensorClock::time_point instant);
  /// What runs beside the moves sets an output, until the program itself sets it again.
  void set_output(const OutputStep& output, SensorClock::time_point instant);

  /// Force mode's: from `instant` on the tip of a program is so far from its way.
  void set_off(const Vec3& off_base_mm, SensorClock::time_point instant);

  /// From `instant` on programs go at that share of their speed, 0 to 1; until then as before.  Instants in
  /// order.
  void set_speed(double ratio, SensorClock::time_point instant);

  /// A program waits where it is, its sleeps, too; moves stop at once.
  void set_paused(bool on, SensorClock::time_point instant);

  struct Running {
    std::shared_ptr<const Program> program{};  ///< nullptr: none
    SensorClock::time_point begin{};
    double time_s{0};  ///< of the program, at the instant that was asked for
    bool paused{false};
    bool ended{false};  ///< it has come to its end, and nothing has taken its place
  };
  [[nodiscard]] Running running(SensorClock::time_point instant) const;

  [[nodiscard]] const ArmKinematics& kinematics() const { return kinematics_; }

 private:
  void stand(SensorClock::time_point instant);
  /// Pre: a program is on, and mutex_ is held.
  [[nodiscard]] double program_time_s(SensorClock::time_point instant) const;
  [[nodiscard]] std::optional<JointVector> joints_of(const ArmState& state,
                                                     const JointVector& near_rad) const;

  ArmKinematics kinematics_;
  mutable std::mutex mutex_;
  SE3 T_base_flange_still_;
  std::optional<JointVector> q_still_rad_{};
  SE3 T_flange_tcp_{SE3::Identity()};
  std::uint32_t outputs_{0};
  std::array<double, 2> analog_ratio_{};
  Payload payload_;
  std::shared_ptr<const FlangeMotion> motion_;
  std::shared_ptr<const Program> program_;
  SensorClock::time_point begin_;
  struct SetBeside {
    OutputStep output;
    double time_s;  ///< of the program
  };
  struct Pace {
    SensorClock::time_point since;
    double program_s;  ///< at that instant
    double ratio;
    bool paused;
  };
  void change_pace(SensorClock::time_point instant);
  struct Off {
    SensorClock::time_point since;
    Vec3 off_base_mm;
  };
  [[nodiscard]] Vec3 off_at(SensorClock::time_point instant) const;
  std::vector<Off> offs_{};  ///< of the program, in order, of the last seconds
  std::vector<Pace> paces_;  ///< of the program, in order
  double speed_ratio_{1};
  bool paused_{false};
  std::vector<SetBeside> beside_;  ///< outputs set by what runs beside the program
  bool ideal_{true};
  mutable std::mutex real_mutex_;  ///< before mutex_
  mutable RealJoints real_;
};

}  // namespace biteline::sim
