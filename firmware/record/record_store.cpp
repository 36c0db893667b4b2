// SPDX-License-Identifier: MIT
#include "firmware/record/record_store.hpp"

#include "common/image/png_bytes.hpp"

namespace biteline::record {

Result<std::span<const std::uint8_t>> PictureFile::of(const pipeline::RecordedFrame& frame, bool packed) {
  const auto size = static_cast<std::ptrdiff_t>(frame.width_px) * frame.height_px;
  picture_.width_px = frame.width_px;
  picture_.height_px = frame.height_px;
  picture_.pixels.assign(frame.pixels.begin(), frame.pixels.begin() + size);
  BITELINE_TRY(packed ? image::pack_png(picture_, bytes_) : image::store_png(picture_, bytes_));
  return std::span<const std::uint8_t>{bytes_};
}

}  // namespace biteline::record
