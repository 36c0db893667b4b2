// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/scanned_cloud.hpp"

#include <cmath>

#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

struct Viewer {
  double distance_mm;
  double z_mm;
};

/// Clears `seen` where the section hides itself from a viewer in its plane.  Going away from the viewer's own
/// height, a point is seen only if its elevation goes beyond that of all points before it.
void hide(const std::vector<double>& z_mm, const std::vector<double>& offset_mm, Viewer viewer,
          std::vector<bool>& seen) {
  const auto elevation = [&](std::size_t i) {
    return (z_mm[i] - viewer.z_mm) / (viewer.distance_mm - offset_mm[i]);
  };
  std::size_t level = 0;
  while (level < z_mm.size() && z_mm[level] < viewer.z_mm) ++level;
  double highest = -1e9;
  for (std::size_t i = level; i < z_mm.size(); ++i) {
    if (elevation(i) <= highest) seen[i] = false;
    highest = std::max(highest, elevation(i));
  }
  double lowest = 1e9;
  for (std::size_t i = level; i-- > 0;) {
    if (elevation(i) >= lowest) seen[i] = false;
    lowest = std::min(lowest, elevation(i));
  }
}

}  // namespace

ScannedCloud scan_quickly(const MadeShoe& shoe, const ScanSettings& settings, const SE3& T_frame_shoe) {
  Random random(settings.seed);
  ScannedCloud cloud;
  const int profiles =
      std::max(3, static_cast<int>(std::round(shoe.perimeter_mm() / settings.profile_step_mm)));
  const Viewer camera{settings.camera_distance_mm, settings.camera_z_mm};
  const Viewer laser{settings.laser_distance_mm, settings.laser_z_mm};

  std::vector<double> z_mm, offset_mm;
  std::vector<bool> seen;
  for (int profile = 0; profile < profiles; ++profile) {
    const Section section = shoe.section(shoe.perimeter_mm() * profile / profiles);
    // Columns do not stand still on the shoe: the arm never repeats a height exactly.
    const double first_z_mm = std::max(section.bottom_z_mm(), settings.field_low_z_mm) +
                              settings.column_step_mm * random.uniform({0, 1});
    const double last_z_mm = std::min(settings.field_high_z_mm, section.top_z_mm());
    z_mm.clear();
    offset_mm.clear();
    for (double z = first_z_mm; z < last_z_mm; z += settings.column_step_mm) {
      z_mm.push_back(z);
      offset_mm.push_back(section.offset_mm(z));
    }
    seen.assign(z_mm.size(), true);
    hide(z_mm, offset_mm, camera, seen);
    hide(z_mm, offset_mm, laser, seen);
    for (std::size_t i = 0; i < z_mm.size(); ++i) {
      const double noise_mm = settings.noise_mm * random.gaussian();
      const bool lost = section.look(z_mm[i]).glossy && random.chance(settings.gloss_loss_ratio);
      if (!seen[i] || lost) continue;
      const Vec2 horizontal = section.place().point + offset_mm[i] * section.place().normal;
      const Vec2 eye = section.place().point + settings.camera_distance_mm * section.place().normal;
      const Vec3 point{horizontal.x(), horizontal.y(), z_mm[i]};
      const Vec3 ray = (point - Vec3{eye.x(), eye.y(), settings.camera_z_mm}).normalized();
      cloud.points.push_back((T_frame_shoe * (point + noise_mm * ray)).cast<float>());
      cloud.profile.push_back(static_cast<std::uint32_t>(profile));
      cloud.column.push_back(static_cast<std::uint16_t>(std::floor(z_mm[i] / settings.column_step_mm)));
    }
  }
  return cloud;
}

}  // namespace biteline::sim
