// SPDX-License-Identifier: MIT
#include "host/cloud/text_cloud.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/numbers.hpp"
#include "common/core/text.hpp"
#include "common/system/file.hpp"

namespace biteline::cloud {
namespace {

constexpr std::string_view k_between = " \t\r,;";

/// The next field of `line`, taken off its front; empty at the end.  Two commas beside each other count as
/// one: no program writes a place with an empty number in it.
std::string_view take_field(std::string_view& line, std::string_view between = k_between) {
  const auto begin = line.find_first_not_of(between);
  if (begin == std::string_view::npos) return line = {};
  line.remove_prefix(begin);
  const std::string_view field = line.substr(0, line.find_first_of(between));
  line.remove_prefix(field.size());
  return field;
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end != text.data() + text.size() || status == std::errc::invalid_argument)
    return std::nullopt;
  // Beyond what a double holds: as far away as one can be.
  return status == std::errc::result_out_of_range ? std::numeric_limits<double>::infinity() : value;
}

/// Which field of a row is x, y and z.
using Columns = std::array<std::size_t, 3>;

/// A head line names its columns: "x,y,z", "X Y Z Intensity", "Points_0;Points_1;Points_2".
std::optional<Columns> columns_of_head(std::string_view line) {
  Columns columns{};
  std::array<bool, 3> found{};
  std::size_t field_number = 0;
  // Names may have blanks in them where commas part them: "X [mm]".
  const bool parted = line.find_first_of(",;\t") != std::string_view::npos;
  while (true) {
    std::string_view field = take_field(line, parted ? ",;\t\r" : k_between);
    if (field.empty()) break;
    field.remove_prefix(std::min(field.find_first_not_of(" \"/"), field.size()));
    field = field.substr(0, field.find_last_not_of(" \"") + 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto letter = static_cast<char>('x' + axis);
      const bool is_letter = !field.empty() && (field.front() | 0x20) == letter &&
                             (field.size() == 1 || field.find_first_of(" [(_") == 1);
      const bool is_number = field.ends_with(static_cast<char>('0' + axis)) && field.size() > 1 &&
                             (field[field.size() - 2] == '_' || field[field.size() - 2] == ':');
      if (!found[axis] && (is_letter || is_number)) {
        columns[axis] = field_number;
        found[axis] = true;
      }
    }
    ++field_number;
  }
  return std::ranges::all_of(found, std::identity{}) ? std::optional{columns} : std::nullopt;
}

/// Rows of a text, one after another, with their numbers.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_{text} {}
  /// The next row that is neither empty nor a comment; false at the end.
  bool next(std::string_view& line) {
    while (!text_.empty()) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      line = text_.substr(0, end);
      text_.remove_prefix(std::min(end + 1, text_.size()));
      ++number_;
      const auto first = line.find_first_not_of(" \t\r");
      if (first == std::string_view::npos || line[first] == '#') continue;
      line.remove_prefix(first);
      return true;
    }
    return false;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t number_{0};
};

bool is_count(std::string_view line) {
  const std::string_view field = take_field(line);
  return take_field(line).empty() && !field.empty() &&
         field.find_first_not_of("0123456789") == std::string_view::npos;
}

Result<Eigen::Vector3d> place(std::string_view line, const Columns& columns,
                              const std::filesystem::path& file, std::size_t row) {
  const bool decimal_comma = line.find(';') != std::string_view::npos &&
                             line.find(',') != std::string_view::npos &&
                             line.find('.') == std::string_view::npos;
  if (decimal_comma)
    return fail(Errc::BadFormat, "%s row %zu: a decimal point expected, found a decimal comma", file.c_str(),
                row);
  Eigen::Vector3d xyz;
  const std::size_t last = *std::ranges::max_element(columns);
  for (std::size_t i = 0; i <= last; ++i) {
    const std::string_view field = take_field(line);
    if (field.empty())
      return fail(Errc::BadFormat, "%s row %zu: %zu numbers expected, found %zu", file.c_str(), row, last + 1,
                  i);
    const auto axis = std::ranges::find(columns, i);
    if (axis == columns.end()) continue;
    const std::optional<double> value = number(field);
    if (!value) {
      return fail(Errc::BadValue, "%s row %zu, field %zu: a number expected, found '%s'", file.c_str(), row,
                  i + 1, clean_text(field, 20).c_str());
    }
    xyz[axis - columns.begin()] = *value;
  }
  return xyz;
}

}  // namespace

Result<std::vector<Eigen::Vector3f>> read_text_cloud(const std::filesystem::path& file,
                                                     std::size_t& dropped) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_cloud_bytes));
  Lines lines{text};
  Columns columns{0, 1, 2};
  std::vector<Eigen::Vector3f> points;
  dropped = 0;
  bool head_may_come = true;
  for (std::string_view line; lines.next(line);) {
    if (head_may_come) {
      if (is_count(line)) continue;
      if (const auto named = columns_of_head(line)) {
        columns = *named;
        head_may_come = false;
        continue;
      }
    }
    if (line.starts_with("//")) continue;
    head_may_come = false;
    BITELINE_ASSIGN(const Eigen::Vector3d xyz, place(line, columns, file, lines.number()));
    if (is_plausible_place(xyz)) {
      points.emplace_back(xyz.cast<float>());
    } else {
      ++dropped;
    }
  }
  return points;
}

}  // namespace biteline::cloud
