// SPDX-License-Identifier: MIT
#include "host/robot/path/path_file.hpp"

#include "common/core/fixed_text.hpp"
#include "host/report/report.hpp"

namespace biteline::path {

Result<void> write_path(const std::filesystem::path& file, const CheckedPath& path) {
  std::string text =
      "#time [s],segment,p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z [],speed [mm/s],"
      "joint_1 [rad],joint_2 [rad],joint_3 [rad],joint_4 [rad],joint_5 [rad],joint_6 [rad],arc [mm],u95 "
      "[mm]\n";
  for (const Waypoint& w : path.path().waypoints) {
    const Vec3 p = w.T_base_tcp.translation();
    const Eigen::Quaterniond q{w.T_base_tcp.linear()};
    text += FixedText<400>::format(
                "%.6f,%s,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f,%.9f,%.3f,%.8f,%.8f,%.8f,%.8f,%.8f,%.8f,%.4f,",
                w.time_s, name_of(w.segment), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), w.speed_mm_s,
                w.q_rad[0], w.q_rad[1], w.q_rad[2], w.q_rad[3], w.q_rad[4], w.q_rad[5], w.arc_mm)
                .view();
    if (w.u95_mm) text += FixedText<32>::format("%.4f", *w.u95_mm).view();
    text += '\n';
  }
  return report::write_file_atomically(file, text);
}

}  // namespace biteline::path
