// SPDX-License-Identifier: MIT
#pragma once
/// \file A head from its calibration pictures.

#include <filesystem>
#include <string>
#include <vector>

#include "biteline/export.hpp"
#include "biteline/stripe.hpp"

namespace biteline::sdk {

struct Calibration {
  Head head;
  bool good{false};                  ///< as docs/calibration.md calls good; else usable, with care
  std::vector<std::string> reasons;  ///< what keeps it from good
  std::vector<std::string> retake;   ///< pictures to take again, each with its reason
};

/// `folder`: target.yaml and the pictures of camera, laser and hand-eye (docs/calibration.md).  The clock's
/// offset is not looked for: it stays 0.  Throws Refused where a part gives no trustworthy answer.
[[nodiscard]] BITELINE_API Calibration calibrate_head(const std::filesystem::path& folder);

}  // namespace biteline::sdk
