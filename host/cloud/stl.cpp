// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>

#include "host/cloud/mesh_file.hpp"
#include "host/cloud/mesh_words.hpp"
#include "host/cloud/text_encoding.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_head = 84, k_triangle = 50;

bool is_keyword(std::string_view word, std::string_view small) {
  return word.size() == small.size() &&
         std::ranges::equal(word, small, [](char a, char b) { return (a | 0x20) == b; });
}

/// The triangles of a binary file, by its head; writers that do not know them beforehand say 0.
std::uint32_t told_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + k_head - sizeof count, sizeof count);
  const std::size_t room = bytes.size() - k_head;
  if (count == 0 && room % k_triangle == 0) count = static_cast<std::uint32_t>(room / k_triangle);
  return count;
}

bool is_binary(std::string_view bytes) {
  if (bytes.size() >= k_head && bytes.size() == k_head + k_triangle * std::size_t{told_triangles(bytes)} &&
      bytes.size() > k_head)
    return true;
  const std::string_view begin = bytes.substr(0, 65'536);
  if (begin.find('\0') != std::string_view::npos)
    return !begin.starts_with("\xFF\xFE") && !begin.starts_with("\xFE\xFF");
  MeshWords words{begin};
  const std::string_view first = words.next_anywhere();
  return !is_keyword(first, "solid") && !is_keyword(first, "facet") && !first.ends_with("solid");
}

Result<FileContent> read_binary(std::string_view bytes, const fs::path& file) {
  if (bytes.size() < k_head)
    return fail(Errc::Truncated, "%s: an STL's head of %zu bytes expected", file.c_str(), k_head);
  const std::uint32_t count = told_triangles(bytes);
  const std::size_t found = (bytes.size() - k_head) / k_triangle;
  if (found < count)
    return fail(Errc::Truncated, "%s: %u triangles expected, found %zu", file.c_str(), count, found);
  FileContent content;
  content.places.reserve(std::size_t{3} * count);
  content.faces.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* triangle = bytes.data() + k_head + k_triangle * i + 3 * sizeof(float);
    for (int corner = 0; corner < 3; ++corner, triangle += 3 * sizeof(float)) {
      Eigen::Vector3f vertex;
      std::memcpy(vertex.data(), triangle, sizeof vertex);
      content.places.emplace_back(vertex.cast<double>());
    }
    content.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  content.layout = "binary STL";
  return content;
}

class TextStl {
 public:
  TextStl(std::string_view text, const fs::path& file) : words_{text}, file_{file} {}

  Result<FileContent> read() {
    bool ended = false;
    for (std::string_view word = words_.next_anywhere(); !word.empty(); word = words_.next_anywhere()) {
      if (is_keyword(word, "solid") || is_keyword(word, "endsolid")) {
        ended = is_keyword(word, "endsolid");
        words_.next_row();  // its name, whatever words it has
        word = words_.next();
        if (word.empty()) continue;
      }
      if (is_keyword(word, "vertex")) {
        BITELINE_ASSIGN(const Eigen::Vector3d vertex, next_place(words_, file_));
        content_.places.push_back(vertex);
      } else if (is_keyword(word, "endloop")) {
        BITELINE_TRY(close_loop());
      }
    }
    if (loop_ != content_.places.size() || !ended) {
      return fail(Errc::Truncated,
                  "%s row %zu: the last triangle's end and endsolid expected: was the file cut?",
                  file_.c_str(), words_.row());
    }
    content_.layout = "text STL";
    return std::move(content_);
  }

 private:
  /// Some writers put polygons into a loop.
  Result<void> close_loop() {
    const std::size_t corners = content_.places.size() - loop_;
    if (corners < 3) {
      return fail(Errc::BadFormat, "%s row %zu: three vertices in a loop expected, found %zu", file_.c_str(),
                  words_.row(), corners);
    }
    const auto first = static_cast<std::uint32_t>(loop_);
    for (std::uint32_t i = 2; i < corners; ++i) content_.faces.push_back({first, first + i - 1, first + i});
    loop_ = content_.places.size();
    return {};
  }

  MeshWords words_;
  const fs::path& file_;
  FileContent content_;
  std::size_t loop_{0};  ///< first vertex of the loop that is open
};

}  // namespace

Result<FileContent> read_stl(std::string bytes, const fs::path& file) {
  FileContent content;
  if (is_binary(bytes)) {
    BITELINE_ASSIGN(content, read_binary(bytes, file));
  } else {
    BITELINE_ASSIGN(const std::string text, as_plain_text(std::move(bytes), file));
    BITELINE_ASSIGN(content, TextStl(text, file).read());
  }
  if (content.faces.empty()) return fail(Errc::BadFormat, "%s: at least one triangle expected", file.c_str());
  return content;
}

}  // namespace biteline::cloud
