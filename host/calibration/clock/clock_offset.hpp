// SPDX-License-Identifier: MIT
#pragma once
/// \file The offset between the pose stream's clock and the camera's, from a scan that sees some surface more
/// than once.

#include <string>

#include "common/core/result.hpp"
#include "host/calibration/clock/overlap.hpp"

namespace biteline::calibration {

struct ClockOffset {
  Nanoseconds offset{0};
  Nanoseconds sigma{0};
  double rms_before_mm{0};  ///< of surfaces seen twice, at offset 0
  double rms_mm{0};
  std::size_t pairs{0};
  int iterations{0};
  std::string reason;  ///< why the offset is not determined; empty when it is

  [[nodiscard]] bool determined() const { return reason.empty(); }
};

/// Under a wrong offset a point is put where the head was too early or too late, off by velocity times
/// offset; where a surface is seen again under another velocity the two do not agree.  A coarse search over
/// +-`search_ms`, then Gauss-Newton on the point-to-plane distances; the standard deviation from the scatter
/// between frames (errors of one frame go together).  Not determined, with its standard deviation and the
/// reason, when what is seen twice is seen under equal motion (a scan that goes round once); fails when
/// nothing is seen twice.
[[nodiscard]] Result<ClockOffset> find_clock_offset(const Scan& scan, const ScanModel& model,
                                                    double search_ms);

}  // namespace biteline::calibration
