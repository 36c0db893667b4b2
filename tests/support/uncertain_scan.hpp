// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe scanned by a made head that is not known exactly: what U95 has to hold.

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/sim/shoe/random.hpp"
#include "hal/sim/shoe/shoe_parameters.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"

namespace biteline::test {

/// How well a calibration knows a head whose camera is `working_mm` from the stripe: a covariance with
/// correlations, of 0.7 to 2 times the usual figures.
[[nodiscard]] uncertainty::HeadUncertainty drawn_uncertainty(const geometry::SensorModel& head,
                                                             double working_mm, sim::Random& random);
/// What such a calibration is off by.
[[nodiscard]] uncertainty::Parameters drawn_error(const uncertainty::Covariance& covariance,
                                                  sim::Random& random);

struct UncertainScan {
  cloud::PointCloud cloud;                      ///< base, as the head's calibration has it; scan order
  std::vector<uncertainty::ProfilePose> poses;  ///< as the controller told them, of each profile
  uncertainty::KnownHead head;                  ///< as calibrated, with what is stated of it
  cloud::ClosedLine truth;                      ///< base; positions only; empty of a bare upper
};

struct UncertainScanSettings {
  sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
  std::uint64_t seed{1};
  double profile_step_mm{1.0};
  double speed_mm_s{100};
  /// Of calibration, poses and clock; 0: all are exact.
  double errors{1};
  double missing_mm{0};   ///< of the way round nothing was seen, somewhere; on a flank of the toe guard
  bool toe_guard{false};  ///< the sole wraps up over the toe; of a designed class
  /// The same cell scans a second time, by the same way: the stripe's noise is drawn anew by this seed, and
  /// what an arm does not repeat of its way.
  std::optional<std::uint64_t> again{};
  /// Another piece of the same model and size, in the same place: its last differs by so much, as `again`
  /// draws.
  double last_difference_mm{0};
};

/// Draws, each by itself: a shoe and its place; a head; how well it is known (a covariance with correlations,
/// of 0.7 to 2 times the usual figures) and its error from that; poses that are off in slow waves along the
/// way (50 to 400 mm) and a third as much from one to the next; the clock's offset; the stripe's noise in
/// pixels.  A second scan has all of these again, and slow waves of 0.014 mm and 0.03 mrad besides: a UR10e
/// repeats a place within 0.05 mm (ISO 9283: mean and three standard deviations of the distance).  Each true
/// point is projected by the true head and triangulated by the calibrated one at the told pose.
[[nodiscard]] UncertainScan uncertain_scan(const UncertainScanSettings& settings);

/// The line in it as a running scan finds it.
[[nodiscard]] bite_line::Extraction line_of(const UncertainScan& scan,
                                            std::optional<bite_line::Workings>* workings = nullptr);

}  // namespace biteline::test
