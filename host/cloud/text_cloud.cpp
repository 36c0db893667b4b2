// SPDX-License-Identifier: MIT
#include "host/cloud/text_cloud.hpp"

#include <algorithm>

#include "common/core/text.hpp"
#include "host/cloud/text_encoding.hpp"
#include "host/cloud/text_layout.hpp"
#include "host/cloud/text_rows.hpp"
#include "host/cloud/written_number.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

bool has_digit(std::string_view row) {
  return row.find_first_of("0123456789") != std::string_view::npos;
}

class Reader {
 public:
  Reader(const TextLayout& layout, const fs::path& file) : layout_{layout}, file_{file} {
    for (std::size_t axis = 0; axis < 3; ++axis) axis_of_[layout.columns[axis]] = axis;
    last_ = *std::ranges::max_element(layout.columns);
  }

  Result<void> take(std::string_view row, std::size_t number) {
    if (row.empty() || is_comment(row)) return {};
    Eigen::Vector3d place;
    bool numbers = true;
    std::size_t field_number = 0, surplus = 0;
    TextFields fields{row, layout_.separator};
    for (std::string_view field; fields.next(field); ++field_number) {
      if (field_number > last_) {
        surplus += field_number >= layout_.fields && !field.empty() ? 1 : 0;
        continue;
      }
      const std::size_t axis = axis_of_[field_number];
      if (axis > 2) continue;
      const Written written = written_number(field, layout_.decimal, place[static_cast<Eigen::Index>(axis)]);
      if (written == Written::Wrong && has_digit(row)) return wrong(field, field_number, number);
      numbers = numbers && written == Written::Number;
    }
    if (field_number <= last_ || surplus > 0 ||
        (layout_.separator == k_blanks && field_number != layout_.fields))
      return other_count(row, field_number, number);
    if (numbers) {
      content.places.push_back(place);
    } else {
      ++content.without_number;
    }
    return {};
  }

  FileContent content;

 private:
  tl::unexpected<Error> wrong(std::string_view field, std::size_t field_number, std::size_t number) const {
    return fail(Errc::BadValue, "%s row %zu, field %zu: a number expected, found '%s'", file_.c_str(), number,
                field_number + 1, clean_text(field, 20).c_str());
  }
  Result<void> other_count(std::string_view row, std::size_t found, std::size_t number) {
    if (trimmed(row).empty()) return {};
    // "END", a head once more, a line of dashes.
    if (!has_digit(row)) {
      ++content.without_number;
      return {};
    }
    // The next block of points begins with its own count.
    if (layout_.promised && lone_count(row)) {
      promised_more_ += *lone_count(row);
      return {};
    }
    return fail(Errc::BadFormat, "%s row %zu: %zu numbers expected, as in the rows before, found %zu",
                file_.c_str(), number, layout_.fields, found);
  }

 public:
  Result<void> check_count() const {
    const std::size_t found = content.places.size() + content.without_number;
    if (!layout_.promised || found >= *layout_.promised + promised_more_) return {};
    return fail(Errc::Truncated, "%s: %llu points expected, as the file itself says, found %zu",
                file_.c_str(), static_cast<unsigned long long>(*layout_.promised + promised_more_), found);
  }

 private:
  const TextLayout& layout_;
  const fs::path& file_;
  std::array<std::size_t, 256> axis_of_ = [] {
    std::array<std::size_t, 256> none{};
    none.fill(3);
    return none;
  }();
  std::size_t last_{0};
  std::uint64_t promised_more_{0};
};

}  // namespace

Result<FileContent> read_text_cloud(std::string bytes, const fs::path& file) {
  BITELINE_ASSIGN(const std::string text, as_plain_text(std::move(bytes), file));
  BITELINE_ASSIGN(const TextLayout layout, text_layout(text, file));
  Reader reader{layout, file};
  TextRows rows{text};
  for (std::string_view row; rows.next(row);) {
    if (rows.number() >= layout.first_row) BITELINE_TRY(reader.take(row, rows.number()));
  }
  BITELINE_TRY(reader.check_count());
  reader.content.layout = layout.words();
  reader.content.unit = layout.unit;
  return std::move(reader.content);
}

}  // namespace biteline::cloud
