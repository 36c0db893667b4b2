// SPDX-License-Identifier: MIT
#pragma once
/// \file Touch after touch until tip or table is known: what page and command line both do.

#include <optional>
#include <vector>

#include "host/robot/kinematics/table_touch.hpp"
#include "host/robot/kinematics/tool_touch.hpp"

namespace biteline::kinematics {

/// What a lesson gives.
struct Touched {
  Vec3 tip_flange{Vec3::Zero()};  ///< of a tip, mm
  double z_mm{0};                 ///< of a table, in the robot's base
  double residual_mm{0};          ///< RMS of a tip, the largest of a table
  double u95_mm{0};
};

/// One lesson at a time: of the tip, or of the table with a tip that is known.
/// Thread: one owner.
class TouchLesson {
 public:
  enum class Part { Tip, Table };

  /// Begins anew.  `tip_flange`: of a table's lesson, what touches it.
  void begin(Part part, const Vec3& tip_flange = Vec3::Zero());
  /// Errc::BadValue: no pose of an arm.  Errc::WrongState: the arm stands as at an earlier touch, or there
  /// are k_most_touches already.
  [[nodiscard]] Result<void> add(const SE3& T_base_flange);
  void take_back() {
    if (!touches_.empty()) touches_.pop_back();
  }
  void end() { touches_.clear(); }

  [[nodiscard]] Part part() const { return part_; }
  [[nodiscard]] std::size_t touches() const { return touches_.size(); }
  /// What the touches so far give, or what is still wrong with them.
  [[nodiscard]] Result<Touched> outcome() const;

  static constexpr std::size_t k_most_touches = 50;

 private:
  Part part_{Part::Tip};
  Vec3 tip_flange_{Vec3::Zero()};
  std::vector<SE3> touches_;
};

}  // namespace biteline::kinematics
