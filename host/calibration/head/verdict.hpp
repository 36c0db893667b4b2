// SPDX-License-Identifier: MIT
#pragma once
/// \file How good a calibration is, in plain words, and which pictures to take again.

#include <string>
#include <vector>

#include "host/calibration/head/head_calibration.hpp"

namespace biteline::calibration {

enum class Grade { Good, Fair, Bad };
[[nodiscard]] const char* name_of(Grade grade);

struct Verdict {
  Grade grade{Grade::Good};
  std::vector<std::string> reasons;  ///< what keeps it from good
  std::vector<std::string> retake;   ///< pictures, each with its reason
};

// Good: the figures that docs/calibration.md calls good.  Fair: usable, up to twice or so of them.
[[nodiscard]] Verdict judge(const CameraCalibration& camera);
[[nodiscard]] Verdict judge(const LaserCalibration& laser);
[[nodiscard]] Verdict judge(const HandEyeCalibration& hand_eye);
/// The worst of the parts; refused is bad.  Pictures that were set aside are among those to retake.
[[nodiscard]] Verdict judge(const HeadCalibration& head);

/// "the camera sits 293 mm from the flange, at x 9, y 153, z 250": to be held against the drawing.
[[nodiscard]] std::string mounting_words(const SE3& T_flange_cam);

/// Pre: the grade is bad.
[[nodiscard]] Refusal refusal_of(const Verdict& verdict);

}  // namespace biteline::calibration
