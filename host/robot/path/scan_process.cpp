// SPDX-License-Identifier: MIT
#include "host/robot/path/scan_process.hpp"

#include <cmath>

namespace biteline::path {

Result<Process> scan_process(const geometry::SensorModel& sensor, const ScanSettings& settings) {
  const Vec3& n = sensor.laser_plane.normal_cam;
  const double z_mm = std::abs(n.z()) > 1e-3 ? sensor.laser_plane.distance_mm / n.z() : -1;
  // A head that works nearer than 20 mm or farther than 2 m is none of ours.
  if (z_mm < 20 || z_mm > 2000)
    return fail(Errc::Degenerate, "sensor: its optical axis meets the laser plane at %.0f mm", z_mm);

  Vec3 beam_cam = n.cross(Vec3::UnitX()).normalized();
  if (beam_cam.z() < 0) beam_cam = -beam_cam;
  const Vec3 stripe_cam = (Vec3::UnitX() - n.x() * n).normalized();
  // y of a tool frame points down along the wall; turned by half, the image stands on its head.
  SE3 T_cam_tcp = SE3::Identity();
  T_cam_tcp.linear().col(2) = beam_cam;
  T_cam_tcp.linear().col(1) = settings.turned ? stripe_cam : Vec3(-stripe_cam);
  T_cam_tcp.linear().col(0) = T_cam_tcp.linear().col(1).cross(beam_cam);
  T_cam_tcp.translation() = Vec3{0, 0, z_mm};

  Process process;
  process.name = "scan";
  process.tool = {.T_flange_tcp = sensor.T_flange_cam * T_cam_tcp,
                  .body_radius_mm = settings.head_radius_mm,
                  .contact_length_mm = settings.emitter_clearance_mm,
                  .free_turn_rad = 0};
  const SE3 T_tcp_cam = T_cam_tcp.inverse();
  process.sight =
      Sight{.camera_tcp = T_tcp_cam.translation(), .laser_tcp = {0, 0, -settings.emitter_clearance_mm}};
  process.placement = {.outwards = Outwards::Level,
                       .outward_mm = 0,
                       .up_mm = settings.above_line_mm,
                       .standoff_mm = 0,
                       .tilt_rad = settings.pitch_rad,
                       .lead_rad = 0};
  process.motion.speed_mm_s = settings.rate_hz * settings.spacing_mm;
  process.motion.minimum_speed_mm_s = 0.1 * process.motion.speed_mm_s;
  process.motion.acceleration_mm_s2 = 1000;
  process.motion.cross_acceleration_mm_s2 = 1000;
  process.motion.joint_speed_ratio = 0.8;
  process.motion.spacing_mm = 3;
  process.motion.blend_mm = 1.2;
  process.motion.overlap_mm = 5;
  process.motion.approach_mm = 20;
  process.motion.approach_speed_mm_s = 150;
  process.motion.lift_mm = 0;
  return process;
}

}  // namespace biteline::path
