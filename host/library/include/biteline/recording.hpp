// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan as the sensor sent it.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "biteline/cloud.hpp"
#include "biteline/export.hpp"
#include "biteline/motion.hpp"
#include "biteline/stripe.hpp"

namespace biteline::sdk {

/// The points of one stripe.  The arrays are of equal length, by column.
struct Profile {
  std::uint64_t sequence{0};        ///< from 0; gaps are losses
  std::int64_t exposure_mid_ns{0};  ///< middle of the exposure, by the sensor's clock
  bool usable{false};               ///< its pose and its frame are good: its points are in the cloud
  Motion T_base_cam{Motion::Identity()};
  std::vector<Eigen::Vector3f> points_cam_mm;
  std::vector<float> sigma_mm;
  std::vector<std::uint16_t> column_px;
};

struct Recording {
  Head head;
  std::vector<Profile> profiles;
  Cloud cloud;        ///< of all usable profiles, in the robot's base; mirror images and mixed edges left out
  std::string lacks;  ///< why it is not a whole scan; empty: it is whole
};

/// Reads scan.btln.  Throws Error for a file that is none, or that holds no point.
[[nodiscard]] BITELINE_API Recording read_recording(const std::filesystem::path& file);

}  // namespace biteline::sdk
