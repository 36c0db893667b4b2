// SPDX-License-Identifier: MIT
#include "host/calibration/rings/picture.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>
#include <utility>

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

/// What OpenCV reads here, as in toolchains/debian-12.packages.
constexpr std::array<std::string_view, 8> k_endings{".png", ".bmp", ".tif", ".tiff",
                                                    ".pgm", ".ppm", ".jpg", ".jpeg"};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

bool read_number(const std::string& text, int& number) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
}

/// "; 12 .png lie there, such as img_01.png, and 2 folders"; nothing where nothing does.
std::string what_lies_in(const fs::path& folder) {
  std::map<std::string, std::pair<int, std::string>> files;  // by ending: how many, and the first
  int folders = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory(ignored)) {
      ++folders;
    } else if (!name.starts_with('.')) {
      auto& [count, first] = files[lower(entry.path().extension().string())];
      if (count++ == 0 || name < first) first = name;
    }
  }
  std::string words;
  for (const auto& [ending, of] : files) {
    words += words.empty() ? "; there are " : ", ";
    words += std::to_string(of.first) + " " + (ending.empty() ? "files" : ending) + " (" + of.second + ")";
  }
  if (folders > 0)
    words += (words.empty() ? "; there are " : ", ") + std::to_string(folders) + " folders inside";
  return words;
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
  const std::string mark = suffix.substr(0, suffix.rfind('.'));  // "_rings", or nothing
  // One folder's pictures have one ending: .png, or else what most of them have.
  std::map<std::string, std::vector<NumberedPicture>> by_ending;
  std::error_code error, ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string ending = lower(entry.path().extension().string());
    if (std::ranges::find(k_endings, ending) == k_endings.end() || !entry.is_regular_file(ignored)) continue;
    const std::string stem = entry.path().stem().string();
    NumberedPicture picture{.number = 0, .file = entry.path()};
    if (stem.ends_with(mark) && read_number(stem.substr(0, stem.size() - mark.size()), picture.number))
      by_ending[ending].push_back(std::move(picture));
  }
  if (error)
    return fail_errno(Errc::FileNotFound, error.value(), "%s: a folder of pictures expected", folder.c_str());
  if (by_ending.empty()) {
    return fail(Errc::FileNotFound, "%s: pictures NN%s expected%s", folder.c_str(), suffix.c_str(),
                what_lies_in(folder).c_str());
  }
  auto chosen = by_ending.find(".png");
  if (chosen == by_ending.end()) {
    chosen = std::ranges::max_element(by_ending, {}, [](const auto& of) { return of.second.size(); });
  }
  std::vector<NumberedPicture> pictures = std::move(chosen->second);
  std::ranges::sort(pictures, {}, &NumberedPicture::number);
  return pictures;
}

}  // namespace biteline::calibration
