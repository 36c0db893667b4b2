// SPDX-License-Identifier: MIT
#include "hal/sim/live/arm_way.hpp"

#include <algorithm>
#include <memory>

namespace biteline::sim {

namespace {

constexpr double k_step_s = static_cast<double>(JointDynamics::k_step.count()) * 1e-9;

/// One row each millisecond from the scan's begin on.
struct Rows {
  std::vector<JointVector> q_rad;
  double first_s;

  [[nodiscard]] JointVector at(double time_s) const {
    const double place =
        std::clamp((time_s - first_s) / k_step_s, 0.0, static_cast<double>(q_rad.size() - 2));
    const auto i = static_cast<std::size_t>(place);
    return q_rad[i] + (place - static_cast<double>(i)) * (q_rad[i + 1] - q_rad[i]);
  }
};

}  // namespace

HeadWay way_of(const ArmScan& scan, const ArmKinematics& kinematics, const ArmDynamics& dynamics) {
  auto link = std::make_shared<Rows>(Rows{.q_rad = {}, .first_s = -scan.full_from_s()});
  auto told = std::make_shared<Rows>(*link);
  JointDynamics joints(dynamics, scan.q_rad_at(0));
  for (double time_s = 0; time_s < scan.duration_s() + k_step_s; time_s += k_step_s) {
    joints.step(scan.q_rad_at(time_s));
    link->q_rad.push_back(joints.q_link_rad());
    told->q_rad.push_back(joints.q_told_rad());
  }
  return {.duration_s = scan.full_until_s() - scan.full_from_s(),
          .T_base_flange_at = [=](double time_s) { return kinematics.T_base_flange(link->at(time_s)); },
          .T_base_flange_told_at = [=](double time_s) { return kinematics.T_base_flange(told->at(time_s)); }};
}

}  // namespace biteline::sim
