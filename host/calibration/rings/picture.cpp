// SPDX-License-Identifier: MIT
#include "host/calibration/rings/picture.hpp"

#include <algorithm>
#include <charconv>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace biteline::calibration {

namespace fs = std::filesystem;

Result<image::GreyImage> read_picture(const fs::path& file) {
  if (!fs::exists(file)) return fail(Errc::FileNotFound, "%s: a picture expected", file.c_str());
  cv::Mat grey;
  try {
    grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    grey.release();
  }
  if (grey.empty()) return fail(Errc::BadFormat, "%s: a readable picture (PNG) expected", file.c_str());
  image::GreyImage picture{.width_px = grey.cols, .height_px = grey.rows, .pixels = {}};
  picture.pixels.reserve(grey.total());
  for (int v = 0; v < grey.rows; ++v)
    picture.pixels.insert(picture.pixels.end(), grey.ptr(v), grey.ptr(v) + grey.cols);
  return picture;
}

Result<std::vector<NumberedPicture>> numbered_pictures(const fs::path& folder, const std::string& suffix) {
  std::vector<NumberedPicture> pictures;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= suffix.size() || !name.ends_with(suffix)) continue;
    NumberedPicture picture{.number = 0, .file = entry.path()};
    const char* end = name.data() + name.size() - suffix.size();
    const auto parsed = std::from_chars(name.data(), end, picture.number);
    if (parsed.ec != std::errc{} || parsed.ptr != end) continue;
    pictures.push_back(std::move(picture));
  }
  if (error)
    return fail_errno(Errc::FileNotFound, error.value(), "%s: a folder of pictures expected", folder.c_str());
  if (pictures.empty())
    return fail(Errc::FileNotFound, "%s: pictures NN%s expected", folder.c_str(), suffix.c_str());
  std::sort(pictures.begin(), pictures.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
  return pictures;
}

}  // namespace biteline::calibration
