// SPDX-License-Identifier: MIT
#pragma once
/// \file One scanning head: camera, laser plane, mounting.  The calibrated truth about it, as sensor.yaml
/// holds it.

#include <optional>

#include "common/geometry/camera.hpp"
#include "common/geometry/camera_state.hpp"
#include "common/time/clocks.hpp"

namespace biteline::geometry {

/// n . X = d in the camera frame, |n| = 1.
struct LaserPlane {
  Vec3 normal_cam{Vec3::UnitZ()};
  double distance_mm{0};

  [[nodiscard]] double signed_distance_mm(const Vec3& point_cam) const {
    return normal_cam.dot(point_cam) - distance_mm;
  }
};

/// Part of the full sensor that frames show.
struct Region {
  int offset_u_px{0}, offset_v_px{0};
  int width_px{0}, height_px{0};
};

struct SensorModel {
  Camera camera;
  LaserPlane laser_plane;
  SE3 T_flange_cam{SE3::Identity()};
  Region region;
  Nanoseconds pose_clock_offset{0};     ///< robot clock minus sensor clock
  std::optional<double> rate_hz;        ///< frames per second, where told
  std::optional<Nanoseconds> exposure;  ///< where told
  CameraState camera_state{};           ///< what the camera was calibrated in
  /// Of the laser's speckle when the head was calibrated, where told (ProfileHeader::speckle_contrast).
  std::optional<double> speckle_contrast{};
};

/// Point of the laser plane seen at a full-sensor pixel: X = r * d / (n . r) with the viewing ray r (method:
/// stage 5). The direct formula; the firmware's table is tested against it.  A ray parallel to the plane
/// gives z <= 0 or huge.
[[nodiscard]] Vec3 triangulate(const Camera& camera, const LaserPlane& plane, const Vec2& pixel_px);

}  // namespace biteline::geometry
