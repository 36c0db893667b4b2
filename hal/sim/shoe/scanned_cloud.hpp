// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe as a scanner would hand it on, without rendering pictures: fast enough for hundreds of
/// shoes.
///
/// One profile for each step along the outline, one point for each image column; noise along the viewing ray;
/// what either laser or camera cannot see past the shoe's own section is missing, and so are glossy patches.
/// For occlusion laser and camera are taken to stand in the section's plane: the stripe's sideways view is
/// left out.  The stripe's height follows material, incidence, distance and speckle as the rendered pictures'
/// does; its width follows the material and the blur.

#include <cstdint>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"

namespace biteline::sim {

struct ScanSettings {
  double profile_step_mm{1.0};   ///< between stripes along the outline
  double begin_s_mm{0};          ///< of the first one
  double column_step_mm{0.073};  ///< between points of a profile, on the surface's height
  /// Standard deviation along the ray.  What a point of a scan at f/5.6 (contrast 0.47) has once it is
  /// averaged along its stripe, where that is straight: half of one column's (optics::stripe_noise()).
  double noise_mm{0.015};
  double camera_distance_mm{141};  ///< horizontal, from the outline: 200 mm at 45 degrees
  double camera_z_mm{55};
  double laser_distance_mm{200};
  double laser_z_mm{45};
  double field_low_z_mm{-5};  ///< what the head sees of the wall
  double field_high_z_mm{110};
  double gloss_loss_ratio{0.92};  ///< share of the points lost on glossy patches
  std::uint64_t seed{1};
  /// With the stripe's amplitude and width.  The points are the same without.
  bool stripe{false};
  double light_ratio{1};  ///< of the stripe's amplitude: another exposure, or laser power
};

/// Scan order; all arrays of one length.  Coordinates in the frame that `T_frame_shoe` maps to.
struct ScannedCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> profile;
  std::vector<std::uint16_t> column;
  std::vector<float> amplitude, width_px;  ///< of the stripe; empty without
};

[[nodiscard]] ScannedCloud scan_quickly(const MadeShoe& shoe, const ScanSettings& settings,
                                        const SE3& T_frame_shoe);

}  // namespace biteline::sim
