// SPDX-License-Identifier: MIT
#pragma once
/// \file From frames as they arrive to whole poses, each tied to the SYNC that latched it.

#include <cstdint>
#include <optional>
#include <span>

#include "common/canpose/pose_frames.hpp"
#include "common/time/clocks.hpp"

namespace biteline::canpose {

/// A pose with its place in time.
struct AssembledPose {
  PoseMessage message;
  RobotClock::time_point stamp;  ///< message.stamp_us, unwrapped
  std::optional<SensorClock::time_point>
      latched;                ///< arrival of its SYNC; nothing when that SYNC was not seen
  std::uint64_t sequence{0};  ///< counts SYNCs, so that a lost pose is a gap
};

struct AssemblerHealth {
  std::uint64_t poses{0};
  std::uint64_t poses_incomplete{0};  ///< a frame of the set is missing, doubled or of another pose
  std::uint64_t frames_refused{0};    ///< wrong size, check sum, version or numbers
  std::uint64_t syncs{0};
  std::uint64_t syncs_missed{0};  ///< gaps in the SYNC counter
  std::uint64_t poses_without_sync{0};
};

/// Both forms may stand on one bus; whichever completes a counter first wins, the other is not given again.
/// Thread: one owner.  Memory: none beyond itself.
class Assembler {
 public:
  explicit Assembler(std::uint32_t base_id = k_default_base_id) : base_id_{base_id} {}

  /// Frames of other ids are ignored.
  std::optional<AssembledPose> feed(std::uint32_t id, std::span<const std::uint8_t> data,
                                    SensorClock::time_point received);

  [[nodiscard]] const AssemblerHealth& health() const noexcept { return health_; }

 private:
  void on_sync(std::span<const std::uint8_t> data, SensorClock::time_point received);
  std::optional<AssembledPose> on_classic(std::size_t index, std::span<const std::uint8_t> data);
  std::optional<AssembledPose> complete(const PoseMessage& message, bool stamp_is_32_bit);
  /// Each set once, however many of its frames come out of order.
  void count_incomplete(std::uint8_t counter);
  RobotClock::time_point unwrapped(std::uint64_t stamp_us, bool is_32_bit);

  std::uint32_t base_id_;
  ClassicFrames pending_{};
  std::size_t pending_count_{0};
  std::uint8_t last_sync_counter_{0};  ///< 0: none yet
  SensorClock::time_point last_sync_;
  std::uint8_t last_pose_counter_{0};
  std::uint8_t last_incomplete_counter_{0};
  std::uint64_t sequence_{0};
  std::optional<std::uint64_t> last_stamp_us_;
  AssemblerHealth health_;
};

}  // namespace biteline::canpose
