// SPDX-License-Identifier: MIT
// PNG files: a picture of the size it says, or one clean line.
#include "common/image/grey_image.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Pictures of more than a megapixel take long and show nothing new: width and height stand at bytes 16
  // to 23.
  if (size > 24 &&
      (data[16] != 0 || data[17] != 0 || data[18] > 4 || data[20] != 0 || data[21] != 0 || data[22] > 4))
    return 0;
  const fuzz::MemoryFile file{data, size};
  const auto picture = image::read_png(file.path());
  if (!picture) {
    fuzz::demand_clean(picture.error());
    return 0;
  }
  fuzz::demand(picture->pixels.size() ==
                   static_cast<std::size_t>(picture->width_px) * static_cast<std::size_t>(picture->height_px),
               "a picture has its pixels");
  return 0;
}
