// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a recording leaves the hot path: copies of frames and poses, in a room that is made at
/// start-up.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/rt/annotations.hpp"
#include "common/rt/buffer_pool.hpp"
#include "common/rt/drop_oldest_ring.hpp"
#include "hal/api/frame.hpp"

namespace biteline::pipeline {

struct RecordedFrame {
  std::vector<std::uint8_t> pixels;  ///< as large as the region; the first width_px * height_px are the frame
  int width_px{0}, height_px{0};
  int first_row_px{0};  ///< of the region
  std::uint64_t sequence{0};
  SensorClock::time_point exposure_mid;
  std::uint32_t flags{0};  ///< hal::FrameFlag
};

struct RecordedPose {
  SensorClock::time_point stamp;
  Eigen::Quaterniond rotation;
  Vec3 translation_mm;
  std::optional<std::int64_t> encoder_ticks{};
};

/// Frames and poses on their way to the disk.  Nobody waits: what finds no room, and frames that are not
/// wanted, are left out and counted.
///
/// Thread: rt_keep_frame from the acquisition thread, rt_keep_pose from the pose thread, rt_take_*,
/// rt_give_back from one other; counts and close() from any.  RT: rt_ members.  Memory: k_room_bytes of
/// pictures, at start-up.
class RecordTap {
 public:
  static constexpr std::size_t k_room_bytes = 64U << 20U;
  static constexpr std::size_t k_most_frames = 64;
  static constexpr std::size_t k_poses = 4096;  ///< 8 s at 500 Hz

  /// `every`: the first of so many frames is kept; 0: none is.
  explicit RecordTap(const geometry::Region& region, std::uint32_t every = 1);

  void rt_keep_frame(const hal::FrameView& frame) noexcept BITELINE_RT;
  void rt_keep_pose(const RecordedPose& pose) noexcept BITELINE_RT;

  /// The oldest frame not yet taken; null: none.  Valid until rt_give_back().
  [[nodiscard]] const RecordedFrame* rt_take_frame() noexcept BITELINE_RT;
  void rt_give_back() noexcept BITELINE_RT;
  [[nodiscard]] std::optional<RecordedPose> rt_take_pose() noexcept BITELINE_RT;

  /// From now on everything is left out: the disk takes no more.
  void close() noexcept { closed_.store(true, std::memory_order_relaxed); }

  [[nodiscard]] std::uint64_t frames_left_out() const { return frames_left_out_.load(); }
  [[nodiscard]] std::uint64_t poses_left_out() const { return poses_left_out_.load(); }

 private:
  std::uint32_t every_;
  std::uint32_t passed_{0};  ///< since the last that was kept; acquisition thread's own
  std::atomic<bool> closed_{false};
  rt::BufferPool<RecordedFrame, k_most_frames> frames_;
  rt::DropOldestRing<rt::BufferIndex, k_most_frames> frame_ring_;
  rt::BufferPool<RecordedPose, k_poses> poses_{k_poses};
  rt::DropOldestRing<rt::BufferIndex, k_poses> pose_ring_;
  std::optional<rt::BufferIndex> taken_;
  std::atomic<std::uint64_t> frames_left_out_{0}, poses_left_out_{0};
};

}  // namespace biteline::pipeline
