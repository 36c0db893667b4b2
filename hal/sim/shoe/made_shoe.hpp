// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe as an exact surface: the outline, pushed along its normal by o(s, z).
///
/// That is the very form in which the place of the line is defined: the section by an upright plane along the
/// outline's normal is o(z).

#include <optional>
#include <vector>

#include "hal/sim/shoe/shoe_parameters.hpp"

namespace biteline::sim {

/// What light meets at a place of the surface.
struct SurfaceLook {
  double diffuse_ratio{0.6};
  bool glossy{false};
  double scattering_mm{0};    ///< light that wanders inside widens the stripe, standard deviation
  double roughness_mm{0.01};  ///< of the surface within the lens's resolution, standard deviation
  double polarised_ratio{0};  ///< share of the laser's polarisation that comes back
};

class MadeShoe;

/// One upright section, everything that depends on s alone worked out.  Refers to its shoe: lives no longer.
class Section {
 public:
  /// Horizontal offset of the surface from the outline.  Smooth (all derivatives) for 0 <= z <= top.
  [[nodiscard]] double offset_mm(double z_mm) const;
  [[nodiscard]] Vec3 point(double z_mm) const;
  [[nodiscard]] SurfaceLook look(double z_mm) const;

  [[nodiscard]] const Outline::Place& place() const { return place_; }
  [[nodiscard]] double line_height_mm() const { return line_height_mm_; }  ///< nominal bite line
  [[nodiscard]] double top_z_mm() const { return top_z_mm_; }
  /// Lowest point: 0, but where a sole is off the table and no heel stands below it.
  [[nodiscard]] double bottom_z_mm() const { return bottom_z_mm_; }

 private:
  friend class MadeShoe;
  explicit Section(const MadeShoe& shoe) : shoe_(&shoe) {}

  /// Without what is on it; `u_mm` from where the line would be without a guard, here and in what follows.
  [[nodiscard]] double side_of_sole_mm(double u_mm, double z_mm) const;
  [[nodiscard]] double sole_mm(double u_mm, double z_mm) const;
  [[nodiscard]] double upper_mm(double u_mm) const;
  [[nodiscard]] double unworked_mm(double z_mm) const;
  [[nodiscard]] double decoration_of_upper_mm(double u_mm) const;
  /// A relief as this section meets it.
  struct LocalRelief {
    const Relief* relief;
    double middle_u_mm;
    double here_ratio;  ///< 1 where it is, 0 where it is not
    double pitch_mm;    ///< a whole number of times round the outline
  };
  [[nodiscard]] const Material& material_at(bool on_sole, double u_mm) const;
  [[nodiscard]] double reliefs_mm(const std::vector<LocalRelief>& reliefs, double u_mm) const;

  const MadeShoe* shoe_;
  double s_mm_{0};
  Outline::Place place_{};
  double line_height_mm_{0};
  double guard_rise_mm_{0};  ///< of the line, over where it would be without a guard
  double guard_ratio_{0};    ///< 1 on the guard, 0 beside it
  double guard_slope_{0};    ///< rise per length along the outline
  double top_z_mm_{0};
  double bottom_z_mm_{0};
  double heel_top_z_mm_{0};   ///< of the heel block, 0 where the sole stands on the table
  double open_ratio_{1};      ///< 1: groove as drawn, 0: filled
  double strength_ratio_{1};  ///< varies about 1, far below where the groove fades
  double lug_ratio_{0};
  double last_difference_mm_{0};
  double texture_phase_ratio_{0};
  std::vector<double> stitch_ratio_;  ///< height of each row's stitch here
  std::vector<double> seam_way_mm_;
  std::vector<double> swoosh_way_mm_;
  std::vector<LocalRelief> sole_reliefs_;
  std::vector<LocalRelief> upper_reliefs_;
  std::optional<BandHere> worked_{};
};

class MadeShoe {
 public:
  explicit MadeShoe(ShoeParameters parameters);

  [[nodiscard]] const ShoeParameters& parameters() const { return parameters_; }
  [[nodiscard]] const Outline& outline() const { return outline_; }
  [[nodiscard]] double perimeter_mm() const { return outline_.perimeter_mm(); }

  [[nodiscard]] Section section(double s_mm) const;
  /// Outward unit normal, by central differences of the exact surface.
  [[nodiscard]] Vec3 normal(double s_mm, double z_mm) const;

 private:
  friend class Section;
  struct Wave {
    double amplitude;
    int count;
    double phase_rad;
  };
  [[nodiscard]] double waves(const std::vector<Wave>& list, double s_mm) const;

  ShoeParameters parameters_;
  Outline outline_;
  std::vector<Wave> line_waves_;      ///< relative, for the line's height
  std::vector<Wave> strength_waves_;  ///< relative, for the groove's depth and step
  std::vector<Wave> last_waves_;      ///< relative, one last against the next
};

}  // namespace biteline::sim
