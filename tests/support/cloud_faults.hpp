// SPDX-License-Identifier: MIT
#pragma once
/// \file What may be wrong with a cloud beyond the shoe itself.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "common/geometry/se3.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::test {

enum class CloudFault : std::uint8_t {
  None,
  Noise,     ///< 0.03 to 0.08 mm more, any way
  Tilt,      ///< the shoe stands 4 to 10 degrees askew
  Mirrored,  ///< the other foot
  Strays,    ///< one point in a hundred is none of the surface
  Sector,    ///< a hole of 40 mm
  Table,     ///< the table is in view
  Post,      ///< a clamp's column beside the shoe
  Sparse,    ///< 50 000 points, loose
  Shuffled,  ///< in any order
};

inline constexpr std::array<std::string_view, 10> k_cloud_fault_names{
    "none", "noise", "tilt", "mirrored", "outliers", "sector", "table", "post", "sparse", "shuffled"};

[[nodiscard]] constexpr std::string_view name_of(CloudFault fault) {
  return k_cloud_fault_names[static_cast<std::size_t>(fault)];
}

/// Spoils the cloud.  `line`: the true line, or the outline where there is none; a sector is cut at one of
/// its places.  Returns how the shoe itself was moved: its truth has to follow.
[[nodiscard]] Eigen::Affine3d spoil(cloud::PointCloud& cloud, CloudFault fault, std::uint64_t seed,
                                    std::span<const Vec3> line);

}  // namespace biteline::test
