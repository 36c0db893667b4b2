// SPDX-License-Identifier: MIT
#pragma once
/// \file How far off its told poses the arm is, as the level surface under the shoe shows it.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/cloud/uncertainty/arm_give.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::uncertainty {

/// How far off its told poses an arm was in a scan: what its encoders do not see of springs and bearings.
struct ArmMotion {
  struct Place {
    Vec3 middle_base;  ///< of a profile
    double sigma_mm;   ///< of one coordinate; 1.96 of it hold 95 %, few sights counted in
  };
  double sigma_mm{0};           ///< root mean square over the places
  std::size_t profiles{0};      ///< that showed it
  std::vector<Place> places{};  ///< never empty
  ArmSource source{ArmSource::Table};
  double give_mm_per_m_s2{0};  ///< `sigma_mm` over the arm's acceleration; 0: it is not known

  /// Of the profile that lies nearest.
  [[nodiscard]] double sigma_mm_at(const Vec3& point_base) const;
};

/// Table or fixture are one plane, seen beside the shoe all the way round.  How a profile's piece of it lies
/// above or below the plane of all is what the arm was off by upwards.  Sideways an arm gives about as much:
/// its springs are its joints, which move a tool all ways.
/// It sways more in some places than in others: most of a profile's figure is of its own fifth of a second,
/// the rest of the whole scan.  Where the table was out of view, the worst place counts.
/// What is not flat in the table counts as the arm's.
/// Not thread-safe.  Cost: some microseconds a profile, and some tenths of a millisecond at the end.
class ArmSway {
 public:
  /// Points in base, z upwards, neighbours on the stripe next to each other.  In the order of time.
  void add_profile(std::span<const Eigen::Vector3f> points_base, const ProfilePose& pose);

  /// None where the surface was not seen on both sides of a shoe, or in too few profiles.
  [[nodiscard]] std::optional<ArmMotion> motion() const;
  /// Of an arm that gives so much, by how it moved: where the surface was not seen.  None of fewer than five
  /// profiles.
  [[nodiscard]] std::optional<ArmMotion> motion_by(const ArmGive& give) const;

 private:
  /// Of the level surface.
  struct Piece {
    Vec3 middle_base;
    double noise_mm2;  ///< of its height
    std::size_t profile;
  };
  [[nodiscard]] static std::optional<Piece> lowest_level(std::span<const Eigen::Vector3f> points_base);
  /// Without what lies on no plane with most of them; z is above the plane.
  [[nodiscard]] std::vector<Piece> on_one_plane() const;
  /// Variance at each profile, of pieces without noise.
  [[nodiscard]] std::vector<double> local_mm2(std::span<const Piece> pieces, double mean_mm2) const;

  std::vector<CarriedPoint> profiles_;  ///< by their middles
  std::vector<Piece> pieces_;
};

}  // namespace biteline::uncertainty
