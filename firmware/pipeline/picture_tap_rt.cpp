// SPDX-License-Identifier: MIT
#include <algorithm>

#include "common/core/contracts.hpp"
#include "firmware/pipeline/picture_tap.hpp"

namespace biteline::pipeline {

void PictureTap::rt_keep_peaks(const profile::ProfileBuffer& profile) noexcept BITELINE_RT {
  TappedPicture& picture = pictures_.rt_back();
  picture.profile_sequence = profile.header.sequence;
  picture.peak_count = std::min(profile.count, picture.peaks.size());
  for (std::size_t i = 0; i < picture.peak_count; ++i) {
    const profile::ProfilePoint& point = profile.points[i];
    picture.peaks[i] = {.column = point.column, .row_px = point.row_px, .flags = point.flags};
  }
}

void PictureTap::rt_keep_frame(const hal::FrameView& frame) noexcept BITELINE_RT {
  TappedPicture& picture = pictures_.rt_back();
  const auto width = static_cast<std::size_t>(frame.width_px),
             height = static_cast<std::size_t>(frame.height_px);
  BITELINE_EXPECTS(width * height <= picture.pixels.size());
  for (std::size_t row = 0; row < height; ++row) {
    std::copy_n(frame.pixels.data() + row * frame.stride_bytes, width, picture.pixels.data() + row * width);
  }
  picture.width_px = frame.width_px;
  picture.height_px = frame.height_px;
  picture.first_row_px = frame.first_row_px;
  picture.frame_sequence = frame.sequence;
  picture.exposure_mid = frame.exposure_mid;
  wanted_.store(false, std::memory_order_relaxed);
  pictures_.rt_publish();
}

}  // namespace biteline::pipeline
