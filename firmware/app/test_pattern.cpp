// SPDX-License-Identifier: MIT
#include "firmware/app/test_pattern.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace biteline::sensor {
namespace {

constexpr double k_background_grey = 10, k_amplitude_grey = 200;
/// A stripe 4.7 px wide at half its height, as a focused one is.
constexpr double k_sigma_px = 2;

}  // namespace

double pattern_row_px(const geometry::Region& region, int column_px) {
  const double turn = 2 * std::numbers::pi * column_px / region.width_px;
  return region.offset_v_px + region.height_px * (0.5 + 0.125 * std::sin(turn));
}

TestPatternCamera::TestPatternCamera(std::unique_ptr<hal::LineCamera> camera, const geometry::Region& region)
    : camera_{std::move(camera)},
      region_{region},
      pixels_(static_cast<std::size_t>(region.width_px) * static_cast<std::size_t>(region.height_px)) {
  for (int u = 0; u < region.width_px; ++u) {
    const double middle_px = pattern_row_px(region, u) - region.offset_v_px;
    for (int v = 0; v < region.height_px; ++v) {
      const double away = (v - middle_px) / k_sigma_px;
      // Beyond, nothing of it is left in eight bits.
      constexpr double k_reach = 6;
      const double stripe = std::abs(away) > k_reach ? 0 : std::exp(-0.5 * away * away);
      const double grey = k_background_grey + k_amplitude_grey * stripe;
      const std::size_t at = static_cast<std::size_t>(v) * static_cast<std::size_t>(region.width_px) +
                             static_cast<std::size_t>(u);
      pixels_[at] = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
}

Result<hal::FrameView> TestPatternCamera::next_frame(Nanoseconds timeout) {
  BITELINE_ASSIGN(const hal::FrameView frame, camera_->next_frame(timeout));
  lent_ = frame;
  if (frame.width_px != region_.width_px || frame.height_px != region_.height_px || frame.first_row_px != 0) {
    camera_->release(lent_);
    return fail(Errc::DeviceError, "test pattern: a frame of %d x %d instead of %d x %d", frame.width_px,
                frame.height_px, region_.width_px, region_.height_px);
  }
  hal::FrameView made = frame;
  made.pixels = pixels_;
  made.stride_bytes = static_cast<std::size_t>(region_.width_px);
  made.flags |= hal::k_frame_damaged;
  return made;
}

void TestPatternCamera::release(const hal::FrameView& frame) noexcept {
  (void)frame;  // at most one is lent
  camera_->release(lent_);
}

}  // namespace biteline::sensor
