// SPDX-License-Identifier: MIT
#include "host/calibration/rings/picture.hpp"

#include <algorithm>
#include <charconv>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include <string_view>

#include "common/system/file.hpp"

namespace biteline::calibration {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t k_most_file_bytes = 300U << 20U;
constexpr std::uint32_t k_most_side_px = 16384;  // as in common/image

/// Of a PNG, whose header stands first: width and height at bytes 16 and 20, big-endian.
Result<void> check_size(const std::string& bytes, const fs::path& file) {
  constexpr std::string_view k_signature = "\x89PNG\r\n\x1a\n";
  if (bytes.empty()) return fail(Errc::Truncated, "%s: a readable picture (PNG) expected", file.c_str());
  if (bytes.size() < 24 || bytes.compare(0, k_signature.size(), k_signature) != 0) return {};
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  if (number(16) <= k_most_side_px && number(20) <= k_most_side_px) return {};
  return fail(Errc::BadValue, "%s: a picture of at most %u px a side expected, found %u x %u", file.c_str(),
              k_most_side_px, number(16), number(20));
}

}  // namespace

Result<image::GreyImage> read_picture(const fs::path& file) {
  // Looked at before it is unpacked: some bytes may say that they are a picture of gigabytes.
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, k_most_file_bytes));
  BITELINE_TRY(check_size(bytes, file));
  cv::Mat grey;
  try {
    grey = cv::imdecode(cv::Mat{1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())},
                        cv::IMREAD_GRAYSCALE);
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
