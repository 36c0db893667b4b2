// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the next calibration picture is wanted.

#include <optional>
#include <string>
#include <vector>

#include "host/calibration/camera/camera_calibration.hpp"

namespace biteline::capture {

/// Which of the picture's 3 x 3 fields held rings so far.
struct Coverage {
  std::array<bool, 9> seen{};  ///< row by row

  [[nodiscard]] int count() const;
};
[[nodiscard]] Coverage coverage_of(const std::vector<calibration::PlaneView>& views,
                                   calibration::PictureSize size);

/// "upper left corner", of a field that held nothing yet; empty: all did.
[[nodiscard]] std::string missing_field(const Coverage& coverage);

/// How the target should be tilted next, as the views so far lack it; empty: it was tilted every way.
/// `T_cam_target` of the views.
[[nodiscard]] std::string missing_tilt(const std::vector<SE3>& T_cam_target);

/// Where the stripe should lie next; empty: near, middle and far were seen.
[[nodiscard]] std::string missing_depth(const std::vector<double>& stripe_rows_px, int height_px);

/// How the head should turn next for the hand-eye part; empty: it turned enough.
[[nodiscard]] std::string missing_turn(const std::vector<SE3>& T_base_flange);

}  // namespace biteline::capture
