// SPDX-License-Identifier: MIT
#pragma once
/// \file Calibration pictures from files.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::calibration {

/// Any 8-bit picture that OpenCV reads, as grey: calibration photographs may come from elsewhere and be in
/// colour.
[[nodiscard]] Result<image::GreyImage> read_picture(const std::filesystem::path& file);

/// `NN<suffix>` files of a folder with their numbers, in numeric order: "01.png", or "7_rings.png".  Where
/// there is no .png with a number, what most of them are of .bmp, .tif, .tiff, .pgm, .ppm, .jpg, .jpeg. Fails
/// when there is none, and says what lies there.
struct NumberedPicture {
  int number{0};
  std::filesystem::path file;
};
[[nodiscard]] Result<std::vector<NumberedPicture>> numbered_pictures(const std::filesystem::path& folder,
                                                                     const std::string& suffix);

}  // namespace biteline::calibration
