// SPDX-License-Identifier: MIT
#pragma once
/// \file An arm that follows a path as planned, state by state, for a controller that is then made to lie.

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/link/ur/units.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::test {

/// Joint moves over the path's postures, then the waypoints at their times.
class PlayedPath {
 public:
  PlayedPath(const path::PlannedPath& path, const kinematics::Joints& from_rad)
      : path_{path}, arm_{*kinematics::arm_model("UR5e")} {
    stops_.push_back(from_rad);
    stops_.insert(stops_.end(), path.via_rad.begin(), path.via_rad.end());
    stops_.push_back(path.waypoints.front().q_rad);
    begins_s_.push_back(0);
    for (std::size_t leg = 0; leg + 1 < stops_.size(); ++leg)
      begins_s_.push_back(begins_s_.back() + (stops_[leg + 1] - stops_[leg]).cwiseAbs().maxCoeff() / k_rad_s);
  }

  [[nodiscard]] double way_s() const { return begins_s_.back(); }
  [[nodiscard]] double duration_s() const { return way_s() + path_.waypoints.back().time_s; }
  /// 0 at the path's beginning, 1 at its end; below 0 on the way there.
  [[nodiscard]] double share_at(double time_s) const {
    return (time_s - way_s()) / path_.waypoints.back().time_s;
  }

  /// Joints and tip at an instant, with the plan's tool.
  void fill(double time_s, PlayedState& state) const {
    kinematics::Joints q = stops_.back();
    SE3 T_base_tcp = path_.waypoints.back().T_base_tcp;
    if (time_s < way_s()) {
      std::size_t leg = 0;
      while (begins_s_[leg + 1] <= time_s) ++leg;
      const double t = (time_s - begins_s_[leg]) / (begins_s_[leg + 1] - begins_s_[leg]);
      q = stops_[leg] + t * (stops_[leg + 1] - stops_[leg]);
      T_base_tcp = kinematics::forward(arm_, q) * path_.T_flange_tcp;
    } else {
      const double on_path_s = time_s - way_s();
      std::size_t i = 0;
      while (i + 2 < path_.waypoints.size() && path_.waypoints[i + 1].time_s <= on_path_s) ++i;
      const path::Waypoint& a = path_.waypoints[i];
      const path::Waypoint& b = path_.waypoints[i + 1];
      const double t = std::clamp((on_path_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
      q = a.q_rad + t * (b.q_rad - a.q_rad);
      T_base_tcp = geometry::interpolate(a.T_base_tcp, b.T_base_tcp, t);
    }
    for (std::size_t i = 0; i < 6; ++i) state.q[i] = q[static_cast<Eigen::Index>(i)];
    state.tcp_pose = ur::to_ur_pose(T_base_tcp);
    state.tcp_offset = ur::to_ur_pose(path_.T_flange_tcp);
  }

 private:
  static constexpr double k_rad_s = 0.5;  // of the fastest joint
  const path::PlannedPath& path_;
  kinematics::ArmModel arm_;
  std::vector<kinematics::Joints> stops_;
  std::vector<double> begins_s_;
};

}  // namespace biteline::robot::test
