// SPDX-License-Identifier: MIT
#pragma once
/// \file The tool's tip from touching one fixed point from several sides.

#include <filesystem>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"

namespace biteline::kinematics {

struct ToolTouch {
  Vec3 tip_flange;                  ///< the tool's tip, mm
  Vec3 sigma_mm;                    ///< its standard deviation, from the residuals
  double u95_mm{0};                 ///< of the tip in its worst direction, with 95 %
  Vec3 point_base;                  ///< the point touched
  double rms_mm{0};                 ///< of the tips about the point
  std::vector<double> residual_mm;  ///< per touch
  std::size_t worst{0};             ///< touch with the largest residual
};

struct ToolTouchLimits {
  double max_rms_mm{0.5};    ///< a hand-guided touch repeats to 0.1 to 0.3 mm
  double max_sigma_mm{0.5};  ///< worse: the poses are too much alike
};

/// Least squares of R_i tip + p_i = point over the flange poses T_base_flange: linear in tip and point.
/// At least 4 touches whose orientations differ about two axes, else Errc::Degenerate; Errc::CheckFailed
/// names the worst touch when they do not meet in one point.  The tool's direction does not follow from
/// touches.
[[nodiscard]] Result<ToolTouch> fit_tool_touch(std::span<const SE3> T_base_flange,
                                               const ToolTouchLimits& limits);

/// Rows `number, p_x p_y p_z [mm], q_w q_x q_y q_z`: T_base_flange of each touch.
[[nodiscard]] Result<std::vector<SE3>> read_touches(const std::filesystem::path& file);

}  // namespace biteline::kinematics
