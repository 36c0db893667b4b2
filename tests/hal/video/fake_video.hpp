// SPDX-License-Identifier: MIT
#pragma once
/// \file A V4L2 driver within the test's own process: the node is a plain file, ioctl() on it is answered
/// here.

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace biteline::test {

/// What kind of driver it plays; the defaults are a well-behaved one.
struct FakeDriver {
  std::vector<std::string> formats{"GREY"};
  bool in_planes{false};  ///< the multi-planar interface alone
  int planes{1};
  bool follows_pipeline{false};              ///< V4L2_CAP_IO_MC
  int width_px{640}, height_px{480};         ///< as the last program left it
  std::vector<std::pair<int, int>> sizes{};  ///< that it lists
  bool lists_range{false};                   ///< 1 to 16384 each instead
  bool crops{false};                         ///< its full picture is 640 x 480 then
  std::size_t row_padding_bytes{0};
  std::size_t spare_bytes{0};  ///< that sizeimage has more than is filled
  std::size_t short_bytes{0};  ///< of a picture that do not come
  std::size_t data_offset{0};  ///< of a plane
  std::uint32_t first_sequence{0};
  std::map<std::uint32_t, int> controls{};             ///< by id
  std::set<std::uint32_t> stuck{};                     ///< of them: listed, and refused
  std::map<unsigned long, int> failing{};              ///< errno of a request
  std::pair<int, int> pad_size{0, 0}, pad_crop{0, 0};  ///< of a sub-device: given out, read from the sensor
};

/// Lives as long as its file is open.  Frames come every 2 ms while buffers are queued.
class FakeVideo {
 public:
  explicit FakeVideo(FakeDriver driver);
  ~FakeVideo();
  FakeVideo(const FakeVideo&) = delete;
  FakeVideo& operator=(const FakeVideo&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  FakeDriver driver;

  /// The grey of a pixel of the full picture, neither mirrored nor shifted.
  [[nodiscard]] static std::uint8_t grey(int u_px, int v_px) {
    return static_cast<std::uint8_t>(u_px * 3 + v_px * 7 + (u_px >> 5));
  }

  /// 0, or -1 and errno.
  int answer(unsigned long request, void* argument);

 private:
  struct Rectangle {
    int left{0}, top{0}, width{0}, height{0};
  };
  int answer_format(unsigned long request, void* argument);
  int answer_control(unsigned long request, void* argument);
  int answer_selection(unsigned long request, void* argument);
  int answer_buffer(unsigned long request, void* argument);
  void fill(int index, std::uint32_t& used);
  [[nodiscard]] std::size_t stride() const;
  [[nodiscard]] std::size_t picture_bytes() const;

  TemporaryFolder folder_;
  std::string path_;
  std::uint32_t fourcc_{0};
  Rectangle crop_;
  std::deque<int> queued_;
  std::uint32_t sequence_{0};
  int file_{-1};
};

}  // namespace biteline::test
