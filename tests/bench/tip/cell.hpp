// SPDX-License-Identifier: MIT
#pragma once
/// \file One cell's truth, and what its people learn of it: mounting, clock, tip.

#include "hal/sim/record/made_scene.hpp"
#include "hal/sim/robot/arm_kinematics.hpp"
#include "hal/sim/robot/joint_dynamics.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/process.hpp"
#include "tests/bench/tip/sources.hpp"

namespace biteline::bench {

inline constexpr const char* k_tip_arm = "ur10e";
/// Of each pose on the bus: as the simulated cell has them.
inline constexpr double k_told_sigma_mm = 0.010, k_told_sigma_rad = 5.2e-5;

/// An arm as its controller knows it and as it is.
class OwnArm {
 public:
  /// Of arms of that kind; seed 0 is the nominal one.
  explicit OwnArm(std::uint64_t seed);

  [[nodiscard]] const sim::ArmKinematics& controller(Reckoning reckoning) const {
    return reckoning == Reckoning::Nominal ? nominal_ : own_;
  }
  /// The host's arm.
  [[nodiscard]] Result<kinematics::ArmModel> planned(Reckoning reckoning) const;
  /// Where the flange truly is.  Exact: as the controller with the arm's own kinematics reckons.
  [[nodiscard]] SE3 T_base_flange(const sim::JointVector& q_rad, bool exact) const;

 private:
  sim::ArmKinematics nominal_, own_;
  std::array<sim::ArmKinematics::DhRow, 6> rows_;  ///< as the links are
};

/// A head, an arm and a hand that touches.
struct TipCell {
  OwnArm arm;
  geometry::SensorModel head;  ///< as it is
  uncertainty::HeadUncertainty known;
  uncertainty::Parameters error;  ///< of the calibrated head; the mounting's is not used
  Vec3 tip_off_mm;                ///< the true tip beside the process's
  std::uint64_t seed;

  [[nodiscard]] double clock_error_s(const Sources& sources) const {
    return sources.clock ? error[uncertainty::k_clock_at] : 0;
  }
};
[[nodiscard]] TipCell draw_cell(std::uint64_t seed, const sim::MadeHead& head);

/// What of the cell is as in life, and by whose kinematics it is reckoned.
struct Variant {
  std::string name;
  Sources sources{};
  Reckoning reckoning{Reckoning::Own};
};

/// The head as the host has it: camera and plane off by their draw, the mounting by the calibration's own
/// hand-eye from 13 stops before one target.
[[nodiscard]] Result<uncertainty::KnownHead> calibrated_head(const TipCell& cell, const Variant& variant);

/// The tool's tip in the flange, as taught by eight touches of one point and as it is.
struct TaughtTip {
  Vec3 taught_flange, true_flange;
  double u95_mm{0};  ///< as the touches say
};
[[nodiscard]] Result<TaughtTip> teach_tip(const TipCell& cell, const Variant& variant,
                                          const path::Tool& tool);

/// How this cell's arm gives and follows.
[[nodiscard]] sim::ArmDynamics dynamics_of(const Sources& sources);

}  // namespace biteline::bench
