// SPDX-License-Identifier: MIT
#include "host/cloud/pcd.hpp"

#include <liblzf/lzf.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "common/core/text.hpp"
#include "host/cloud/letters.hpp"
#include "host/cloud/text_rows.hpp"
#include "host/cloud/written_number.hpp"

namespace biteline::cloud {
namespace {

struct Field {
  std::string name;
  std::size_t bytes{4};  ///< of one value
  char type{'F'};        ///< F, I or U
  std::size_t count{1};
  [[nodiscard]] std::size_t row_bytes() const { return bytes * count; }
};

struct Header {
  std::vector<Field> fields;
  std::optional<std::size_t> told_points;
  std::size_t width{0}, height{1};
  std::size_t points{0};              ///< as told, or width times height
  std::string data;                   ///< ascii, binary, binary_compressed
  std::size_t begin{0};               ///< of the data in the file
  std::size_t rows{0};                ///< of the head, for messages
  std::array<std::size_t, 3> axes{};  ///< fields x, y, z

  [[nodiscard]] std::size_t row_bytes() const {
    std::size_t bytes = 0;
    for (const Field& field : fields) bytes += field.row_bytes();
    return bytes;
  }
};

constexpr std::size_t k_most_fields = 256, k_most_count = 65'536;

Result<std::size_t> whole_number(const std::string& text, const char* entry,
                                 const std::filesystem::path& file, std::size_t most) {
  std::size_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || status != std::errc{} || end != text.data() + text.size() || value > most) {
    return fail(Errc::BadFormat, "%s, head's %s: a whole number up to %zu expected, found '%s'", file.c_str(),
                entry, most, clean_text(text, 20).c_str());
  }
  return value;
}

/// One value for each field.
Result<void> check_count(const std::vector<std::string>& values, const Header& header, const char* entry,
                         const std::filesystem::path& file) {
  if (values.size() == header.fields.size()) return {};
  return fail(Errc::BadFormat, "%s, head's %s: %zu values expected, one a field, found %zu", file.c_str(),
              entry, header.fields.size(), values.size());
}

Result<void> take_entry(Header& header, const std::string& key, const std::vector<std::string>& values,
                        const std::filesystem::path& file, std::size_t file_bytes) {
  if (key == "fields" || key == "columns") {
    if (values.empty() || values.size() > k_most_fields)
      return fail(Errc::BadFormat, "%s, head's FIELDS: 1 to %zu names expected", file.c_str(), k_most_fields);
    header.fields.clear();
    for (const std::string& name : values) header.fields.push_back({.name = small_letters(name)});
  } else if (key == "size") {
    BITELINE_TRY(check_count(values, header, "SIZE", file));
    for (std::size_t i = 0; i < values.size(); ++i) {
      BITELINE_ASSIGN(header.fields[i].bytes, whole_number(values[i], "SIZE", file, 8));
    }
  } else if (key == "type") {
    BITELINE_TRY(check_count(values, header, "TYPE", file));
    for (std::size_t i = 0; i < values.size(); ++i)
      header.fields[i].type = static_cast<char>(values[i].front() & ~0x20);
  } else if (key == "count") {
    BITELINE_TRY(check_count(values, header, "COUNT", file));
    for (std::size_t i = 0; i < values.size(); ++i) {
      BITELINE_ASSIGN(header.fields[i].count, whole_number(values[i], "COUNT", file, k_most_count));
    }
  } else if (key == "points" && !values.empty()) {
    // A point takes more than one byte of the file, packed ones included: the packer saves at most 1 in 100.
    BITELINE_ASSIGN(header.told_points, whole_number(values[0], "POINTS", file, 100 * file_bytes));
  } else if (key == "width" && !values.empty()) {
    BITELINE_ASSIGN(header.width, whole_number(values[0], "WIDTH", file, 100 * file_bytes));
  } else if (key == "height" && !values.empty()) {
    BITELINE_ASSIGN(header.height, whole_number(values[0], "HEIGHT", file, 100 * file_bytes));
  } else if (key == "data" && !values.empty()) {
    header.data = small_letters(values[0]);
  }
  return {};
}

Result<void> check_header(Header& header, const std::filesystem::path& file, std::size_t file_bytes) {
  const std::size_t most = 100 * file_bytes;
  const bool organised = header.height > 0 && header.width <= most / header.height;
  header.points = header.told_points.value_or(organised ? header.width * header.height : 0);
  if (header.points == 0) {
    return fail(Errc::BadFormat, "%s, head: POINTS, or WIDTH and HEIGHT, of at least one point expected",
                file.c_str());
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, static_cast<char>('x' + axis));
    const auto found = std::ranges::find(header.fields, name, &Field::name);
    if (found == header.fields.end() || found->count != 1)
      return fail(Errc::BadFormat, "%s, head's FIELDS: one %s expected", file.c_str(), name.c_str());
    header.axes[axis] = static_cast<std::size_t>(found - header.fields.begin());
    const bool known = found->type == 'F' ? found->bytes == 4 || found->bytes == 8
                                          : (found->type == 'I' || found->type == 'U') &&
                                                (found->bytes == 1 || found->bytes == 2 ||
                                                 found->bytes == 4 || found->bytes == 8);
    if (!known) {
      return fail(Errc::BadFormat, "%s, field %s: F 4, F 8, I or U 1, 2, 4, 8 expected", file.c_str(),
                  name.c_str());
    }
  }
  if (header.data != "ascii" && header.data != "binary" && header.data != "binary_compressed") {
    return fail(Errc::BadFormat, "%s, head's DATA: ascii, binary or binary_compressed expected, found '%s'",
                file.c_str(), clean_text(header.data, 20).c_str());
  }
  return {};
}

Result<Header> parse_header(std::string_view bytes, const std::filesystem::path& file) {
  constexpr std::size_t k_most_head_bytes = 65'536;
  Header header;
  while (header.begin < std::min(bytes.size(), k_most_head_bytes)) {
    const std::size_t end = std::min(bytes.find('\n', header.begin), bytes.size());
    std::istringstream row{std::string(bytes.substr(header.begin, end - header.begin))};
    header.begin = std::min(end + 1, bytes.size());
    ++header.rows;
    std::string key;
    if (!(row >> key) || key.front() == '#') continue;
    key = small_letters(key);
    std::vector<std::string> values;
    for (std::string value; row >> value;) values.push_back(value);
    BITELINE_TRY(take_entry(header, key, values, file, bytes.size()));
    if (key != "data") continue;
    BITELINE_TRY(check_header(header, file, bytes.size()));
    return header;
  }
  return fail(Errc::BadFormat, "%s: a PCD head with DATA expected", file.c_str());
}

double value_at(const char* at, const Field& field) {
  const auto as = [&](auto value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  if (field.type == 'F') return field.bytes == 4 ? as(float{}) : as(double{});
  const bool sign = field.type == 'I';
  switch (field.bytes) {
    case 1:
      return sign ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return sign ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return sign ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return sign ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

/// Where a field's value of one point lies: point after point (binary), or field after field (compressed).
struct Layout {
  std::array<std::size_t, 3> first{}, step{};
};

Layout layout_of(const Header& header, bool by_field) {
  Layout layout;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < header.axes[axis]; ++i)
      layout.first[axis] += header.fields[i].row_bytes() * (by_field ? header.points : 1);
    layout.step[axis] = by_field ? header.fields[header.axes[axis]].bytes : header.row_bytes();
  }
  return layout;
}

Result<std::vector<Eigen::Vector3d>> read_binary(std::string_view data, const Header& header, bool by_field,
                                                 const std::filesystem::path& file) {
  const std::size_t needed = header.points * header.row_bytes();
  if (data.size() < needed) {
    return fail(Errc::Truncated, "%s: %zu bytes of points expected, found %zu", file.c_str(), needed,
                data.size());
  }
  const Layout layout = layout_of(header, by_field);
  std::vector<Eigen::Vector3d> points;
  points.reserve(header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    Eigen::Vector3d xyz;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      xyz[static_cast<int>(axis)] = value_at(data.data() + layout.first[axis] + i * layout.step[axis],
                                             header.fields[header.axes[axis]]);
    }
    points.push_back(xyz);
  }
  return points;
}

Result<std::string> unpacked(std::string_view data, const Header& header, const std::filesystem::path& file) {
  std::uint32_t packed = 0, whole = 0;
  if (data.size() < 8)
    return fail(Errc::Truncated, "%s: the sizes of the packed points expected", file.c_str());
  std::memcpy(&packed, data.data(), 4);
  std::memcpy(&whole, data.data() + 4, 4);
  data.remove_prefix(8);
  if (packed > data.size() || packed == 0) {
    return fail(Errc::Truncated, "%s: %u packed bytes expected, found %zu", file.c_str(), packed,
                data.size());
  }
  if (whole != header.points * header.row_bytes()) {
    return fail(Errc::SizeMismatch, "%s: %zu bytes of points expected, packed are %u", file.c_str(),
                header.points * header.row_bytes(), whole);
  }
  std::string points(whole, '\0');
  // What did not become smaller some writers leave as it is.
  if (lzf_decompress(data.data(), packed, points.data(), whole) != whole) {
    if (packed == whole) return std::string(data.substr(0, whole));
    return fail(Errc::BadFormat, "%s: the packed points are damaged", file.c_str());
  }
  return points;
}

Result<std::vector<Eigen::Vector3d>> read_ascii(std::string_view data, const Header& header,
                                                const std::filesystem::path& file) {
  std::array<std::size_t, 3> column{};  // of x, y, z among the numbers of a row
  std::size_t columns = 0;
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (header.axes[axis] == i) column[axis] = columns;
    }
    columns += header.fields[i].count;
  }
  std::vector<Eigen::Vector3d> points;
  TextRows rows{data};
  std::string_view row;
  while (points.size() < header.points && rows.next(row)) {
    TextFields fields{row, k_blanks};
    Eigen::Vector3d xyz = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    std::size_t c = 0;
    for (std::string_view field; c < columns && fields.next(field); ++c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (column[axis] != c) continue;
        if (written_number(field, '.', xyz[static_cast<Eigen::Index>(axis)]) == Written::Wrong) {
          return fail(Errc::BadValue, "%s row %zu, field %zu: a number expected, found '%s'", file.c_str(),
                      header.rows + rows.number(), c + 1, clean_text(field, 20).c_str());
        }
      }
    }
    if (c == 0) continue;  // a blank row
    if (c < columns) {
      return fail(Errc::Truncated, "%s row %zu: %zu numbers expected, found %zu", file.c_str(),
                  header.rows + rows.number(), columns, c);
    }
    points.push_back(xyz);
  }
  if (points.size() < header.points) {
    return fail(Errc::Truncated, "%s row %zu: %zu numbers expected, found 0", file.c_str(),
                header.rows + rows.number() + 1, columns);
  }
  return points;
}

}  // namespace

Result<FileContent> read_pcd(std::string_view bytes, const std::filesystem::path& file) {
  BITELINE_ASSIGN(const Header header, parse_header(bytes, file));
  const std::string_view data = bytes.substr(header.begin);
  FileContent content;
  if (header.data == "ascii") {
    BITELINE_ASSIGN(content.places, read_ascii(data, header, file));
  } else if (header.data == "binary") {
    BITELINE_ASSIGN(content.places, read_binary(data, header, false, file));
  } else {
    BITELINE_ASSIGN(const std::string points, unpacked(data, header, file));
    BITELINE_ASSIGN(content.places, read_binary(points, header, true, file));
  }
  content.layout = header.data + " PCD";
  return content;
}

}  // namespace biteline::cloud
