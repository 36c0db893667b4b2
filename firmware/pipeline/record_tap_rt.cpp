// SPDX-License-Identifier: MIT
#include "firmware/pipeline/record_tap.hpp"

#include <algorithm>

#include "common/core/contracts.hpp"

namespace biteline::pipeline {

void RecordTap::rt_keep_frame(const hal::FrameView& frame) noexcept BITELINE_RT {
  const bool closed = closed_.load(std::memory_order_relaxed);
  const bool wanted = every_ != 0 && passed_ == 0;
  if (every_ != 0) passed_ = (passed_ + 1) % every_;
  const std::optional<rt::BufferIndex> buffer = closed || !wanted ? std::nullopt : frames_.rt_acquire();
  if (!buffer) {
    frames_left_out_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  RecordedFrame& out = frames_[*buffer];
  const auto width = static_cast<std::size_t>(frame.width_px),
             height = static_cast<std::size_t>(frame.height_px);
  BITELINE_EXPECTS(width * height <= out.pixels.size());
  for (std::size_t row = 0; row < height; ++row) {
    std::copy_n(frame.pixels.data() + row * frame.stride_bytes, width, out.pixels.data() + row * width);
  }
  out.width_px = frame.width_px;
  out.height_px = frame.height_px;
  out.first_row_px = frame.first_row_px;
  out.sequence = frame.sequence;
  out.exposure_mid = frame.exposure_mid;
  out.flags = frame.flags;
  // The ring has a place for each buffer: it drops nothing.
  if (const std::optional<rt::BufferIndex> victim = frame_ring_.rt_push(*buffer)) frames_.rt_release(*victim);
}

void RecordTap::rt_keep_pose(const RecordedPose& pose) noexcept BITELINE_RT {
  const bool closed = closed_.load(std::memory_order_relaxed);
  const std::optional<rt::BufferIndex> buffer = closed ? std::nullopt : poses_.rt_acquire();
  if (!buffer) {
    poses_left_out_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  poses_[*buffer] = pose;
  if (const std::optional<rt::BufferIndex> victim = pose_ring_.rt_push(*buffer)) poses_.rt_release(*victim);
}

const RecordedFrame* RecordTap::rt_take_frame() noexcept BITELINE_RT {
  BITELINE_EXPECTS(!taken_);
  taken_ = frame_ring_.rt_pop();
  return taken_ ? &frames_[*taken_] : nullptr;
}

void RecordTap::rt_give_back() noexcept BITELINE_RT {
  BITELINE_EXPECTS(taken_.has_value());
  frames_.rt_release(*taken_);
  taken_.reset();
}

std::optional<RecordedPose> RecordTap::rt_take_pose() noexcept BITELINE_RT {
  const std::optional<rt::BufferIndex> buffer = pose_ring_.rt_pop();
  if (!buffer) return std::nullopt;
  const RecordedPose pose = poses_[*buffer];
  poses_.rt_release(*buffer);
  return pose;
}

}  // namespace biteline::pipeline
