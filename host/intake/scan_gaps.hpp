// SPDX-License-Identifier: MIT
#pragma once
/// \file The longest hole of a scan, three ways: by the camera's count, by the sensor's, and by time alone.

#include <cstdint>
#include <vector>

#include "common/profile/profile.hpp"

namespace biteline::intake {

/// Lost in a row, at the worst place.
struct LongestGap {
  std::uint64_t frames{0};    ///< of the camera's own count, where the sensor says that frames were lost
  std::uint64_t profiles{0};  ///< of the sensor's count
  /// Exposures that the time between two profiles has room for: what nobody counted, such as edges while the
  /// sensor's process was stopped.  Needs 10 profiles and a steady rate.
  std::uint64_t edges{0};
};

/// Profiles in their order, whole or not.  Memory: 8 bytes a profile.
class ScanGaps {
 public:
  /// `rate_hz`: that the head was set to; 0: not told.
  explicit ScanGaps(double rate_hz = 0) : rate_hz_{rate_hz} {}
  void add(const profile::ProfileHeader& header);
  [[nodiscard]] LongestGap longest() const;

 private:
  double rate_hz_;
  bool begun_{false};
  profile::ProfileHeader last_;
  LongestGap gap_;
  std::vector<std::int64_t> steps_ns_;  ///< between exposures
};

}  // namespace biteline::intake
