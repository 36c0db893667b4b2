// SPDX-License-Identifier: MIT
#include "host/cloud/mesh_file.hpp"

#include <charconv>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/numbers.hpp"
#include "common/core/text.hpp"
#include "common/system/file.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

/// Words of a text, row by row.
class Words {
 public:
  explicit Words(std::string_view text) : text_{text} {}

  bool next_row() {
    if (text_.empty()) return false;
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    row_ = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return true;
  }
  /// The row's next word; empty at its end.
  std::string_view next() {
    const auto begin = row_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return row_ = {};
    row_.remove_prefix(begin);
    const std::string_view word = row_.substr(0, row_.find_first_of(" \t\r"));
    row_.remove_prefix(word.size());
    return word;
  }
  [[nodiscard]] std::size_t row() const { return number_; }

 private:
  std::string_view text_, row_;
  std::size_t number_{0};
};

Result<Eigen::Vector3f> next_place(Words& words, const fs::path& file) {
  Eigen::Vector3d xyz;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = words.next();
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), xyz[axis]);
    if (word.empty() || status != std::errc{} || end != word.data() + word.size() ||
        !k_plausible_mm.holds(xyz[axis])) {
      return fail(Errc::BadValue, "%s row %zu, %c: a finite number below 1e5 expected, found '%s'",
                  file.c_str(), words.row(), 'x' + axis, clean_text(word, 20).c_str());
    }
  }
  return Eigen::Vector3f(xyz.cast<float>());
}

Result<TriangleMesh> read_text_stl(std::string_view text, const fs::path& file) {
  TriangleMesh mesh;
  Words words{text};
  while (words.next_row()) {
    if (words.next() != "vertex") continue;
    BITELINE_ASSIGN(const Eigen::Vector3f vertex, next_place(words, file));
    mesh.vertices.push_back(vertex);
    const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
    if (count % 3 == 0) mesh.faces.push_back({count - 3, count - 2, count - 1});
  }
  if (mesh.vertices.size() % 3 != 0)
    return fail(Errc::Truncated, "%s: the last triangle has no three vertices", file.c_str());
  return mesh;
}

constexpr std::size_t k_stl_head = 84, k_stl_triangle = 50;

Result<TriangleMesh> read_binary_stl(std::string_view bytes, const fs::path& file) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + k_stl_head - sizeof count, sizeof count);
  const std::size_t found = (bytes.size() - k_stl_head) / k_stl_triangle;
  if (found < count)
    return fail(Errc::Truncated, "%s: %u triangles expected, found %zu", file.c_str(), count, found);
  TriangleMesh mesh;
  mesh.vertices.reserve(std::size_t{3} * count);
  mesh.faces.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const char* triangle = bytes.data() + k_stl_head + k_stl_triangle * i + 3 * sizeof(float);
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Vector3f vertex;
      std::memcpy(vertex.data(), triangle + static_cast<std::size_t>(corner) * sizeof vertex, sizeof vertex);
      if (!is_plausible_place(vertex))
        return fail(Errc::BadValue, "%s, triangle %u: finite numbers below 1e5 expected", file.c_str(),
                    i + 1);
      mesh.vertices.push_back(vertex);
    }
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// "7", "7/1/3", "7//3" or "-1": the vertex, counted from 0.
std::optional<std::uint32_t> vertex_number(std::string_view word, std::size_t vertices) {
  word = word.substr(0, word.find('/'));
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  const auto count = static_cast<std::int64_t>(vertices);
  if (word.empty() || status != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  if (value < 0) value += count + 1;
  if (value < 1 || value > count) return std::nullopt;
  return static_cast<std::uint32_t>(value - 1);
}

}  // namespace

Result<TriangleMesh> read_stl(const fs::path& file) {
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, k_most_cloud_bytes));
  // Binary files may begin with "solid", too; a text has a facet soon after it.
  const bool text = bytes.starts_with("solid") &&
                    std::string_view{bytes}.substr(0, 1024).find("facet") != std::string_view::npos;
  if (!text && bytes.size() < k_stl_head)
    return fail(Errc::Truncated, "%s: an STL's head of %zu bytes expected", file.c_str(), k_stl_head);
  BITELINE_ASSIGN(TriangleMesh mesh, text ? read_text_stl(bytes, file) : read_binary_stl(bytes, file));
  if (mesh.faces.empty()) return fail(Errc::BadFormat, "%s: at least one triangle expected", file.c_str());
  return mesh;
}

Result<TriangleMesh> read_obj(const fs::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_cloud_bytes));
  TriangleMesh mesh;
  Words words{text};
  while (words.next_row()) {
    const std::string_view kind = words.next();
    if (kind == "v") {
      BITELINE_ASSIGN(const Eigen::Vector3f vertex, next_place(words, file));
      mesh.vertices.push_back(vertex);
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> face{};
      std::size_t corners = 0;
      for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++corners) {
        const auto vertex = vertex_number(word, mesh.vertices.size());
        if (!vertex) {
          return fail(Errc::BadValue, "%s row %zu, corner %zu: a vertex number from 1 to %zu expected",
                      file.c_str(), words.row(), corners + 1, mesh.vertices.size());
        }
        if (corners == 0) face[0] = *vertex;
        if (corners > 0) face[1] = std::exchange(face[2], *vertex);
        if (corners > 1) mesh.faces.push_back(face);
      }
    }
  }
  if (mesh.vertices.empty()) return fail(Errc::BadFormat, "%s: at least one v expected", file.c_str());
  return mesh;
}

}  // namespace biteline::cloud
