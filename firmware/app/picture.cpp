// SPDX-License-Identifier: MIT
#include "firmware/app/picture.hpp"

#include <algorithm>

#include "common/image/jpeg.hpp"

namespace biteline::sensor {
namespace {

/// Leaves room for the peaks of a full profile (some 40 KB) and the message around.
constexpr std::size_t k_max_pixel_bytes = wire::k_max_message_bytes - 128 * 1024;

/// What both regions share; empty where they do not meet.
geometry::Region common_part(const geometry::Region& a, const geometry::Region& b) {
  const int left = std::max(a.offset_u_px, b.offset_u_px), top = std::max(a.offset_v_px, b.offset_v_px);
  const int right = std::min(a.offset_u_px + a.width_px, b.offset_u_px + b.width_px);
  const int bottom = std::min(a.offset_v_px + a.height_px, b.offset_v_px + b.height_px);
  return {.offset_u_px = left,
          .offset_v_px = top,
          .width_px = std::max(0, right - left),
          .height_px = std::max(0, bottom - top)};
}

/// Pixel by pixel the mean of step x step of the frame's, from column and row `first` on.
image::GreyImage scaled_down(const pipeline::TappedPicture& tapped, const geometry::Region& cut, int step) {
  image::GreyImage small{.width_px = cut.width_px / step, .height_px = cut.height_px / step, .pixels = {}};
  small.pixels.resize(static_cast<std::size_t>(small.width_px) * static_cast<std::size_t>(small.height_px));
  const auto stride = static_cast<std::size_t>(tapped.width_px);
  const auto cells = static_cast<unsigned>(step * step);
  std::vector<unsigned> sums(static_cast<std::size_t>(small.width_px));
  for (int y = 0; y < small.height_px; ++y) {
    std::fill(sums.begin(), sums.end(), cells / 2);  // rounds
    for (int row = 0; row < step; ++row) {
      const std::uint8_t* pixel = tapped.pixels.data() +
                                  static_cast<std::size_t>(cut.offset_v_px + y * step + row) * stride +
                                  static_cast<std::size_t>(cut.offset_u_px);
      for (unsigned& sum : sums) {
        for (int column = 0; column < step; ++column) sum += *pixel++;
      }
    }
    std::uint8_t* out =
        small.pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(small.width_px);
    for (const unsigned sum : sums) *out++ = static_cast<std::uint8_t>(sum / cells);
  }
  return small;
}

}  // namespace

Result<wire::Picture> make_picture(const pipeline::TappedPicture& tapped, const geometry::Region& head,
                                   const wire::PictureWish& wish) {
  const geometry::Region shown{.offset_u_px = head.offset_u_px,
                               .offset_v_px = head.offset_v_px + tapped.first_row_px,
                               .width_px = tapped.width_px,
                               .height_px = tapped.height_px};
  const geometry::Region region = wish.region.width_px == 0 ? shown : common_part(shown, wish.region);
  wire::Picture picture{.frame_sequence = tapped.frame_sequence,
                        .profile_sequence = tapped.profile_sequence,
                        .exposure_mid = tapped.exposure_mid,
                        .region = region,
                        .step = std::max(1, (region.width_px + wish.width_max_px - 1) / wish.width_max_px),
                        .format = wish.format,
                        .pixels = {},
                        .peaks = {}};
  geometry::Region cut = region;  // in the frame
  cut.offset_u_px -= shown.offset_u_px;
  cut.offset_v_px -= shown.offset_v_px;
  while (true) {
    if (picture.width_px() < 1 || picture.height_px() < 1)
      return fail(Errc::OutOfReach, "picture: nothing of what was asked for is in the camera's region");
    image::GreyImage small = scaled_down(tapped, cut, picture.step);
    if (wish.format == wire::PictureFormat::Raw) {
      picture.pixels = std::move(small.pixels);
    } else {
      BITELINE_ASSIGN(picture.pixels, image::encode_jpeg(small, wish.quality));
    }
    if (picture.pixels.size() <= k_max_pixel_bytes) break;
    ++picture.step;
  }
  for (std::size_t i = 0; i < tapped.peak_count; ++i) {
    const pipeline::TappedPeak& peak = tapped.peaks[i];
    picture.peaks.push_back({.u_px = static_cast<std::uint16_t>(peak.column + head.offset_u_px),
                             .v_px = peak.row_px,
                             .flags = peak.flags});
  }
  return picture;
}

}  // namespace biteline::sensor
