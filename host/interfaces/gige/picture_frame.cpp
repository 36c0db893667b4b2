// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/picture_frame.hpp"

#include <algorithm>

#include "host/interfaces/gige/frame.hpp"

namespace biteline::gige {
namespace {

/// What a sensor leaves for pixels in one message.
constexpr std::size_t k_most_pixels = wire::k_max_message_bytes - 128 * 1024;

/// Pixels of the frame between its corner and what is at `offset_px` of the sensor.
int steps_from(int corner_px, int offset_px, int step) {
  return (offset_px - corner_px) / step;
}

}  // namespace

PictureShape picture_shape(const geometry::Region& head) {
  PictureShape shape{.region = head, .step = 1};
  while (shape.bytes() > k_most_pixels) ++shape.step;
  return shape;
}

wire::PictureWish wish_for(const PictureShape& shape) {
  return {.rate_hz = wire::k_max_picture_rate_hz,
          .width_max_px = (shape.region.width_px + shape.step - 1) / shape.step,
          .format = wire::PictureFormat::Raw,
          .quality = 100,
          .region = {}};
}

std::optional<std::vector<std::uint8_t>> whole_picture(const PictureShape& shape,
                                                       const wire::Picture& picture) {
  const auto width = static_cast<std::size_t>(picture.width_px());
  const auto height = static_cast<std::size_t>(picture.height_px());
  if (picture.format != wire::PictureFormat::Raw || picture.step != shape.step ||
      picture.pixels.size() != width * height)
    return std::nullopt;
  const int left = steps_from(shape.region.offset_u_px, picture.region.offset_u_px, shape.step);
  const int top = steps_from(shape.region.offset_v_px, picture.region.offset_v_px, shape.step);
  const int columns = static_cast<int>(shape.columns()), rows = static_cast<int>(shape.rows());
  std::vector<std::uint8_t> whole(shape.bytes());
  // Of a camera whose region goes beyond the head's, what both have.
  const int from = std::max(0, -left), to = std::min(picture.width_px(), columns - left);
  for (int row = std::max(0, -top); row < picture.height_px() && row + top < rows && from < to; ++row) {
    const auto line = picture.pixels.begin() + static_cast<std::ptrdiff_t>(row) * picture.width_px();
    std::copy(line + from, line + to,
              whole.begin() + static_cast<std::ptrdiff_t>(row + top) * columns + left + from);
  }
  return whole;
}

std::vector<std::uint8_t> picture_record(std::uint64_t scan, const wire::Picture& picture,
                                         Nanoseconds exposure) {
  profile::ProfileHeader header;
  header.sequence = picture.profile_sequence;
  header.frame_sequence = picture.frame_sequence;
  header.exposure_mid = picture.exposure_mid;
  header.flags = profile::k_profile_pose_missing;
  return line_record(scan, header, exposure);
}

}  // namespace biteline::gige
