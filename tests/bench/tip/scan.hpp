// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe's scan: pictures of the true arm's way, and the line that a host finds in them.

#include "hal/sim/live/reachable_scan.hpp"
#include "host/bite_line/extraction.hpp"
#include "tests/bench/tip/cell.hpp"

namespace biteline::bench {

/// Joints every millisecond from time 0 on, as the encoders tell them and as the links are.
class JointRun {
 public:
  struct Row {
    sim::JointVector q_told_rad, q_link_rad;
  };

  /// `q_rad_at`: what the controller asks for, in the order of time; of `settle_s` beyond the end, too.
  template <class JointsAt>
  JointRun(const sim::ArmDynamics& settings, double duration_s, const JointsAt& q_rad_at) {
    sim::JointVector q_rad = q_rad_at(0.0);
    sim::JointDynamics joints{settings, q_rad};
    for (double time_s = 0; time_s < duration_s + k_step_s; time_s += k_step_s) {
      joints.step(q_rad_at(time_s));
      rows_.push_back({.q_told_rad = joints.q_told_rad(), .q_link_rad = joints.q_link_rad()});
    }
  }

  /// Clamped to both ends.
  [[nodiscard]] Row at(double time_s) const;
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

  static constexpr double k_step_s = 1e-3;

 private:
  std::vector<Row> rows_;
};

/// A shoe before an arm that scans it.  Not movable: renderers refer into the scene.
struct TipScan {
  std::unique_ptr<sim::MadeScene> scene;
  std::shared_ptr<const sim::ArmScan> way;
  TipCell cell;
  JointRun joints;  ///< of the way, from its rest

  [[nodiscard]] const sim::JointVector end_rad() const { return joints.rows().back().q_told_rad; }
};

struct ScanSettings {
  sim::ShoeParameters shoe{};
  std::uint64_t seed{1};
  double speed_mm_s{250}, rate_hz{100};
};
/// Errc::OutOfReach where the arm does not get round that shoe.
[[nodiscard]] Result<TipScan> make_scan(const ScanSettings& settings);

/// One scan's pictures, each as large as the head's region.
using Pictures = std::vector<std::vector<std::uint8_t>>;
/// `light`: a laser's; else a lamp's, without speckle.
[[nodiscard]] Pictures pictures_of(const TipScan& scan, bool light);

/// What the host has at a scan's end.
struct HostScan {
  bite_line::Extraction found;
  std::vector<Eigen::Vector3f> points_base;
};
/// Through the sensor's pipeline and the running scan's line, by the calibrated head and the told poses.
[[nodiscard]] Result<HostScan> look(const TipScan& scan, const Pictures& pictures, const Variant& variant);

}  // namespace biteline::bench
