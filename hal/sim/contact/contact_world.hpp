// SPDX-License-Identifier: MIT
#pragma once
/// \file A disc, brush or roller on an elastic upper, as MuJoCo computes it.

#include <memory>
#include <vector>

#include "common/core/result.hpp"
#include "hal/sim/contact/upper_strip.hpp"

struct mjModel_;
struct mjData_;

namespace biteline::sim {

/// A round tool whose rim works: its axis lies across the line, its face looks against the tool frame's
/// outwards (host's TipPlacement: tilt about the line, then lead).
struct ContactTool {
  double radius_mm{22}, width_mm{8};
  double tilt_rad{1.0472}, lead_rad{0};  ///< of the tool's axis to the face, as the process has it
  double moving_kg{6};                   ///< tool, and what of the arm moves with it
  double newton_per_mm{25};              ///< of arm and mounting along the face
  double face_newton_per_mm3{0};  ///< of a soft face (wires, rubber), for each mm and mm2; 0: it is hard
  double damping_ratio{0.1};      ///< of that spring
  double friction_ratio{0.4};     ///< along the line, forwards; 0: it rolls
  double surface_mm_s{6000};      ///< of its rim over the upper; 0: it rolls
  /// Preston's coefficient: depth that is taken off, for each MPa and mm of sliding.
  double wear_mm2_per_newton{2e-4};
};
/// A grinding disc, a roughing brush of wires, a roller that presses.
[[nodiscard]] ContactTool grinding_disc();
[[nodiscard]] ContactTool roughing_brush();
[[nodiscard]] ContactTool pressing_roller();

/// Radius of a piece's round head: flat against 2 mm between them (0.08 mm), round enough for a hollow.  In
/// a contact the two radii add up: a disc presses as one that is so much larger presses on a smooth upper.
inline constexpr double k_piece_head_mm = 6;

/// What the tool feels and does at one instant.
struct ContactNow {
  Vec3 force_base{Vec3::Zero()};  ///< N, on the tool
  double pressed_newton{0};       ///< along the face
  double depth_mm{0};             ///< of the deepest piece
  std::size_t column{0};          ///< of the strip, where the tip is
};

/// Steps of 1 ms.  The pieces of the strip are round heads of 6 mm radius, each with its own spring (soft
/// contact, MuJoCo documentation, "Computation", "Constraint model"); the tool slides on a spring that the
/// arm's tip carries along.  The sole is not there.  Single-threaded.
class ContactWorld {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ContactWorld>> create(const UpperStrip& strip,
                                                                    const ContactTool& tool);
  ~ContactWorld();
  ContactWorld(const ContactWorld&) = delete;
  ContactWorld& operator=(const ContactWorld&) = delete;

  /// The tip goes evenly to `T_base_tcp` within `step_s`, at least 1 ms.
  const ContactNow& step(const SE3& T_base_tcp, double step_s);
  [[nodiscard]] const ContactNow& now() const { return now_; }

  /// Of each column of the strip: across, where more than `least_mm` was taken off.
  [[nodiscard]] std::vector<double> removed_width_mm(double least_mm) const;
  [[nodiscard]] const UpperStrip& strip() const { return strip_; }

 private:
  ContactWorld(const UpperStrip& strip, const ContactTool& tool);
  [[nodiscard]] Result<void> load();
  [[nodiscard]] std::size_t nearest_column(const Vec3& tip_base) const;
  [[nodiscard]] Mat3 face_at(const SE3& T_base_tcp, std::size_t column) const;
  void carry(const Vec3& centre_base, const Mat3& R_base_face);
  void feel(const Mat3& R_base_face);

  UpperStrip strip_;
  ContactTool tool_;
  mjModel_* model_{nullptr};
  mjData_* data_{nullptr};
  int first_piece_{0}, disc_{0};
  std::vector<double> removed_mm_;
  ContactNow now_;
  bool begun_{false};
  Vec3 centre_base_{Vec3::Zero()};
};

}  // namespace biteline::sim
