// SPDX-License-Identifier: MIT
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include "host/cloud/mesh_file.hpp"
#include "host/cloud/mesh_words.hpp"
#include "host/cloud/text_encoding.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

class Obj {
 public:
  Obj(std::string_view text, const fs::path& file) : words_{text}, file_{file} {}

  Result<FileContent> read() {
    do {
      const std::string_view kind = words_.next();
      if (kind == "v" || kind == "V") {
        BITELINE_ASSIGN(const Eigen::Vector3d vertex, next_place(words_, file_));
        content_.places.push_back(vertex);
      } else if (kind == "f" || kind == "F" || kind == "fo") {
        BITELINE_TRY(take_face());
      }
    } while (words_.next_row());
    const std::size_t vertices = content_.places.size();
    if (vertices == 0) return fail(Errc::BadFormat, "%s: at least one v expected", file_.c_str());
    if (!content_.faces.empty() && largest_ >= vertices) return no_vertex(largest_row_, largest_corner_);
    content_.layout = "OBJ";
    return std::move(content_);
  }

 private:
  tl::unexpected<Error> no_vertex(std::size_t row, std::size_t corner) const {
    return fail(Errc::BadValue, "%s row %zu, corner %zu: a vertex number from 1 to %zu expected",
                file_.c_str(), row, corner, content_.places.size());
  }

  /// "7", "7/1/3", "7//3" or "-1": the vertex, counted from 0; it may still come.
  [[nodiscard]] std::optional<std::uint32_t> vertex_number(std::string_view word) const {
    word = word.substr(0, word.find('/'));
    std::int64_t value = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || status != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    if (value < 0) value += static_cast<std::int64_t>(content_.places.size()) + 1;
    if (value < 1 || value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    return static_cast<std::uint32_t>(value - 1);
  }

  Result<void> take_face() {
    std::array<std::uint32_t, 3> face{};
    std::size_t corners = 0;
    for (std::string_view word = words_.next(); !word.empty() && word.front() != '#';
         word = words_.next(), ++corners) {
      const auto vertex = vertex_number(word);
      if (!vertex) return no_vertex(words_.row(), corners + 1);
      if (*vertex > largest_ || largest_row_ == 0) {
        largest_ = *vertex;
        largest_row_ = words_.row();
        largest_corner_ = corners + 1;
      }
      if (corners == 0) face[0] = *vertex;
      if (corners > 0) face[1] = std::exchange(face[2], *vertex);
      if (corners > 1) content_.faces.push_back(face);
    }
    return {};
  }

  MeshWords words_;
  const fs::path& file_;
  FileContent content_;
  std::uint32_t largest_{0};  ///< vertex number of any face, and where it stands
  std::size_t largest_row_{0}, largest_corner_{0};
};

}  // namespace

Result<FileContent> read_obj(std::string bytes, const fs::path& file) {
  BITELINE_ASSIGN(const std::string text, as_plain_text(std::move(bytes), file));
  return Obj(text, file).read();
}

}  // namespace biteline::cloud
