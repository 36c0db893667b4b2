// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe's side bent so that a curve on it runs level: a crease that climbs upright is found there as
/// any other one is.

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/refused.hpp"
#include "host/bite_line/side/side.hpp"

namespace biteline::bite_line {

/// Of a guide's smoothing: a curve over cells has corners.
inline constexpr double k_guide_sigma_mm = 1.5;

/// A straightened side has what lies so far beside its guide: all that gates ask for, or what placing reads.
inline constexpr double k_judged_beside_mm = 40.0, k_placed_beside_mm = 16.0;

/// Evenly spaced, and smoothed by a Gaussian of `sigma_mm` along it.  `guide`: places (s, z) once round; s
/// goes on beyond the outline's length, which is `turn_mm`.
[[nodiscard]] std::vector<Vec2> smooth_guide(std::span<const Vec2> guide, double turn_mm, double sigma_mm);

/// Places of the shoe and of the straightened one, mm, in shoe.
///
/// A place has s along the outline, z up, and o outwards.  In the plane of s and z the guide is a curve; its
/// own coordinates there are u along and v to its left, square to it.  The straightened shoe has u where the
/// shoe has s, the guide's mean height and v where it has z, and the same o.  Its outline turns along u as
/// the shoe's does along s.  So lengths on the side stay what they are, and an upright section of the
/// straightened shoe is one square to the guide.
class Straightened {
 public:
  /// `guide`: evenly spaced and smooth, see smooth_guide().  A curve that bends sharper than it is wide folds
  /// what lies beside it.  One that does not run once round, forwards, is refused.  `side`: borrowed.
  /// What lies farther than `beside_mm` from the guide is left out.
  [[nodiscard]] static OrRefusal<Straightened> along(const Side& side, std::span<const Vec2> guide,
                                                     double beside_mm = k_judged_beside_mm);

  /// The shoe's points beside the guide.  Its base is its own frame.
  [[nodiscard]] Shoe shoe() const;
  [[nodiscard]] const Outline& outline() const { return outline_; }
  [[nodiscard]] double height_mm() const { return height_mm_; }  ///< of the guide
  /// Of these points in base, in the same order; what is out of reach lies at the origin.
  [[nodiscard]] PooledVector<Eigen::Vector3f> points(std::span<const Eigen::Vector3f> points_base) const;

  /// Of the guide at u: its place, how much it bends, and the height for each millimetre across it, that is
  /// the cosine of its climb.
  [[nodiscard]] Vec2 place(double u_mm) const;
  [[nodiscard]] double bend_per_mm(double u_mm) const;
  [[nodiscard]] double upright_ratio(double u_mm) const;
  /// The u of a place beside the guide.
  [[nodiscard]] double u_mm(const Vec2& place) const;

  /// Back from the straightened shoe.
  [[nodiscard]] Vec3 back(const Vec3& level) const;
  [[nodiscard]] PlacedLine back(PlacedLine placed) const;
  /// Places (u, z) of the straightened shoe, once round, as a guide of the shoe.
  [[nodiscard]] std::vector<Vec2> guide(std::span<const Vec2> places) const;
  /// A row of the shoe's grid per column for a path of the straightened one's: the mean where that stands
  /// upright.
  [[nodiscard]] std::vector<double> back(const SideField& level, std::span<const double> path_row) const;

 private:
  Straightened(const Side& side, std::span<const Vec2> guide, Outline unrolled, double first_mm,
               double length_mm, double beside_mm);
  [[nodiscard]] double along_unrolled(double u_mm) const;
  [[nodiscard]] Vec2 unrolled(const Vec2& level) const;  ///< of (u, z)
  void level(std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> to) const;

  const Side& side_;
  double begin_mm_;              ///< s of the guide's first place
  float low_mm_, high_mm_;       ///< heights between which all lies that is beside the guide
  Outline unrolled_;             ///< the guide in the plane of s and z, with more of it beyond both ends
  double first_mm_, length_mm_;  ///< of the guide, along `unrolled_`
  double height_mm_;             ///< mean
  Outline outline_;
};

}  // namespace biteline::bite_line
