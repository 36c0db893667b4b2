// SPDX-License-Identifier: MIT
#pragma once
/// \file Where live pictures leave the hot path: a copy of a frame and of its peaks, when somebody asks.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "common/profile/profile.hpp"
#include "common/rt/annotations.hpp"
#include "common/rt/latest_buffer.hpp"
#include "hal/api/frame.hpp"

namespace biteline::pipeline {

/// One peak of the profile that the frame completed.
struct TappedPeak {
  std::uint16_t column{0};  ///< in the head's region
  float row_px{0};          ///< sub-pixel row in the full sensor
  std::uint16_t flags{0};   ///< profile::PointFlag
};

struct TappedPicture {
  std::vector<std::uint8_t>
      pixels;  ///< as large as the head's region; the first width_px * height_px are the frame
  int width_px{0}, height_px{0};
  int first_row_px{0};  ///< of the head's region
  std::uint64_t frame_sequence{0};
  std::uint64_t profile_sequence{0};
  SensorClock::time_point exposure_mid;
  std::vector<TappedPeak> peaks;  ///< the first peak_count
  std::size_t peak_count{0};
};

/// The acquisition thread looks at one flag per frame and copies nothing while nobody asks.  A picture costs
/// it a copy of the frame's bytes, after the frame's profile has gone its way.
///
///     if (tap.rt_wanted()) { tap.rt_keep_peaks(profile); ...hand the profile on...;
///     tap.rt_keep_frame(frame); }
///
/// Thread: rt_wanted, rt_keep_* from the acquisition thread; rt_want, rt_take from one other.  RT: rt_
/// members. Memory: three times the head's region, at start-up.
class PictureTap {
 public:
  explicit PictureTap(const geometry::Region& region);

  /// The next frame, please.
  void rt_want() noexcept BITELINE_RT { wanted_.store(true, std::memory_order_relaxed); }
  /// The newest picture; null: none since the last.  Valid until the next call.
  [[nodiscard]] const TappedPicture* rt_take() noexcept BITELINE_RT { return pictures_.rt_take(); }

  [[nodiscard]] bool rt_wanted() const noexcept BITELINE_RT {
    return wanted_.load(std::memory_order_relaxed);
  }
  void rt_keep_peaks(const profile::ProfileBuffer& profile) noexcept BITELINE_RT;
  /// Pre: the frame shows rows of the head's region.
  void rt_keep_frame(const hal::FrameView& frame) noexcept BITELINE_RT;

  [[nodiscard]] const geometry::Region& region() const { return region_; }

 private:
  geometry::Region region_;
  std::atomic<bool> wanted_{false};
  rt::LatestBuffer<TappedPicture> pictures_;
};

}  // namespace biteline::pipeline
