// SPDX-License-Identifier: MIT
#pragma once
/// \file The smallest region of the sensor that keeps the stripe in sight: fewer rows are more frames per
/// second.

#include "common/geometry/sensor_model.hpp"
#include "common/profile/profile.hpp"
#include "common/rt/annotations.hpp"

namespace biteline::pipeline {

/// Proposes a region from the rows that the last profiles' stripes took.
///
/// The rows seen in the last profiles, a margin on either side for what moves until the camera has changed,
/// rounded to the camera's steps.  A stripe that runs over the region's edge widens it at once; a lost one
/// opens the whole height until it is found again.  The region shrinks only when it has been too large for a
/// while, since every change costs frames. Thread: one.  RT: rt_ members.
class RegionFollower {
 public:
  struct Config {
    int first_row_px{0};  ///< of the sensor: the region stays between these
    int end_row_px{1236};
    int step_px{4};  ///< offsets and heights are multiples of it
    int least_height_px{64};
    int margin_px{40};           ///< at 0.16 mm a row 6 mm of surface
    int profiles_to_shrink{50};  ///< so long too large before it shrinks
    int profiles_to_lose{5};     ///< so long without stripe before the whole height is opened
    /// Read-out: a frame takes overhead + rows * row_time (rolling read-out of CMOS and CCD cameras with
    /// regions).
    Nanoseconds frame_overhead{std::chrono::microseconds{300}};
    Nanoseconds row_time{std::chrono::microseconds{38}};
  };

  struct Proposal {
    int offset_v_px{0};
    int height_px{0};
    bool changed{false};
    bool searching{false};  ///< stripe lost, whole height open
    double rate_max_hz{0};  ///< highest frame rate for this region
  };

  /// Starts with the whole height.  Pre: the rows in between are least_height_px at least.
  explicit RegionFollower(const Config& config);

  [[nodiscard]] Proposal rt_update(const profile::ProfileBuffer& profile) noexcept BITELINE_RT;

 private:
  [[nodiscard]] Proposal rt_propose(int first_row_px, int end_row_px, bool searching) noexcept BITELINE_RT;
  Config config_;
  int first_row_px_, end_row_px_;    ///< the region now
  int seen_first_px_, seen_end_px_;  ///< rows taken since the count began
  int profiles_too_large_{0};
  int profiles_lost_{0};
  bool searching_{true};
};

}  // namespace biteline::pipeline
