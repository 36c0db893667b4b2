// SPDX-License-Identifier: MIT
#include "host/cloud/text_layout.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/core/text.hpp"
#include "host/cloud/column_names.hpp"
#include "host/cloud/letters.hpp"
#include "host/cloud/text_rows.hpp"
#include "host/cloud/written_number.hpp"

namespace biteline::cloud {
namespace {

namespace fs = std::filesystem;

/// Rows that are looked at: heads of other programs have up to some fifty.
constexpr std::size_t k_sample_rows = 400;
/// No program writes so many numbers for one point without naming them.
constexpr std::size_t k_least_grid_fields = 16;

struct Row {
  std::size_t number{0};
  std::string_view text;
};

struct Way {
  char separator;
  char decimal;
};
/// The plainest first: of two that read a file equally well the first one counts.
constexpr std::array k_ways{Way{'\t', '.'},     Way{'\t', ','},    Way{';', '.'}, Way{';', ','},
                            Way{'|', '.'},      Way{'|', ','},     Way{',', '.'}, Way{',', ','},
                            Way{k_blanks, '.'}, Way{k_blanks, ','}};

std::vector<std::string_view> fields_of(std::string_view row, char separator) {
  std::vector<std::string_view> fields;
  TextFields left{row, separator};
  for (std::string_view field; left.next(field);) fields.push_back(field);
  return fields;
}

struct Kinds {
  std::size_t fields{0}, numbers{0}, wrong{0};
  /// A row of points, x y or z perhaps without number.
  [[nodiscard]] bool fits() const { return fields >= 3 && numbers >= 2; }
};

Kinds kinds_of(std::string_view row, Way way) {
  Kinds kinds;
  TextFields left{row, way.separator};
  for (std::string_view field; left.next(field); ++kinds.fields) {
    double value = 0;
    const Written written = written_number(field, way.decimal, value);
    kinds.numbers += written == Written::Number ? 1 : 0;
    kinds.wrong += written == Written::Wrong ? 1 : 0;
  }
  return kinds;
}

/// The way that reads most rows cleanly; none: no row has two numbers and a third field.
std::optional<Way> best_way(const std::vector<Row>& rows, std::optional<char> separator) {
  std::optional<Way> best;
  std::size_t most = 0;
  for (const Way& way : k_ways) {
    if (separator && way.separator != *separator) continue;
    std::size_t points = 0;
    for (const Row& row : rows) {
      const Kinds kinds = kinds_of(row.text, way);
      if (kinds.fits()) points += kinds.wrong == 0 ? 1000 : 100 - std::min<std::size_t>(kinds.wrong, 50);
    }
    if (points > most) {
      most = points;
      best = way;
    }
  }
  return best;
}

/// The fields that most rows of points have.
std::size_t usual_fields(const std::vector<Row>& rows, Way way) {
  std::map<std::size_t, std::size_t> rows_of;
  for (const Row& row : rows) {
    if (const Kinds kinds = kinds_of(row.text, way); kinds.fits()) ++rows_of[kinds.fields];
  }
  return std::ranges::max_element(rows_of, {}, [](const auto& entry) { return entry.second; })->first;
}

bool has_letter(std::string_view text) {
  return std::ranges::any_of(text, [](char c) { return (c | 0x20) >= 'a' && (c | 0x20) <= 'z'; });
}

/// A name, or nothing at all (the index of a table that has none).
bool is_word(std::string_view field) {
  double value = 0;
  return written_number(field, '.', value) != Written::Number;
}

/// pandas names columns without a name 0, 1, 2, ...
bool counts_up_from_zero(const std::vector<std::string_view>& fields) {
  const std::size_t first = !fields.empty() && fields[0].empty() ? 1 : 0;
  for (std::size_t i = first; i < fields.size(); ++i) {
    if (fields[i] != std::to_string(i - first)) return false;
  }
  return fields.size() > first + 2;
}

/// "; x y z" and "# x,y,z" without their mark.
std::string_view without_mark(std::string_view row) {
  const auto begin = row.find_first_not_of("#/%! \t");
  return begin == std::string_view::npos ? std::string_view{} : row.substr(begin);
}

class Finder {
 public:
  Finder(std::string_view text, const fs::path& file) : text_{text}, file_{file} {}

  Result<TextLayout> find() {
    const std::optional<char> told = take_rows();
    if (points_.empty()) return fail(Errc::BadValue, "%s: no point in it", file_.c_str());
    const std::optional<Way> way = best_way(points_, told);
    if (!way) return no_points();
    way_ = *way;
    layout_.separator = way_.separator;
    layout_.decimal = way_.decimal;
    layout_.fields = usual_fields(points_, way_);
    find_first_point();
    BITELINE_TRY(read_head());
    if (!layout_.named) BITELINE_TRY(choose_columns());
    return layout_;
  }

 private:
  /// Rows with something in them; Excel's row "sep=;" is taken off.
  std::optional<char> take_rows() {
    std::optional<char> separator;
    TextRows rows{text_};
    for (std::string_view row; points_.size() < k_sample_rows && rows.next(row);) {
      const std::string_view plain = trimmed(row);
      if (plain.empty()) continue;
      if (all_.empty() && plain.size() >= 4 && (plain.starts_with("sep=") || plain.starts_with("SEP="))) {
        const char told = plain.size() > 4 ? plain[4] : '\t';
        if (std::ranges::any_of(k_ways, [&](const Way& way) { return way.separator == told; }))
          separator = told;
        continue;
      }
      all_.push_back({rows.number(), row});
      if (!is_comment(row)) points_.push_back(all_.back());
      if (all_.size() > 2 * k_sample_rows) break;
    }
    return separator;
  }

  tl::unexpected<Error> no_points() const {
    // The last one: what stands in front may be a head.
    const Row& row = points_.back();
    return fail(Errc::BadFormat, "%s row %zu: x y z expected, three numbers a row; found '%s'", file_.c_str(),
                row.number, clean_text(row.text, 40).c_str());
  }

  /// The first row with as many fields as most, numbers among them.
  void find_first_point() {
    const auto is_point = [&](const Row& row) {
      const Kinds kinds = kinds_of(row.text, way_);
      return kinds.fits() && kinds.fields == layout_.fields &&
             2 * kinds.numbers >= std::min<std::size_t>(kinds.fields, 4);
    };
    auto first = std::ranges::find_if(points_, is_point);
    if (first == points_.end()) first = points_.begin();
    // Names that are numbers.
    const auto second = first + 1;
    if (second < points_.end() && counts_up_from_zero(fields_of(first->text, way_.separator)) &&
        second->text.find_first_of(".,") != std::string_view::npos && !is_same_shape(*first, *second)) {
      first = second;
      numbered_names_ = true;
    }
    layout_.first_row = first->number;
    points_.erase(points_.begin(), first);
  }
  /// Both rows have whole numbers only.
  [[nodiscard]] bool is_same_shape(const Row& a, const Row& b) const {
    const auto decimals = [&](const Row& row) {
      return std::ranges::any_of(fields_of(row.text, way_.separator), [&](std::string_view field) {
        return field.find(way_.decimal) != std::string_view::npos;
      });
    };
    return decimals(a) == decimals(b);
  }

  Result<void> read_head() {
    std::vector<Row> head;
    for (const Row& row : all_) {
      if (row.number < layout_.first_row) head.push_back(row);
    }
    std::size_t counts = 0;
    for (const Row& row : head) {
      const auto count = lone_count(row.text);
      if (!count) continue;
      layout_.promised = *count;
      ++counts;
    }
    BITELINE_TRY(refuse_grids(head, counts));
    for (auto row = head.rbegin(); row != head.rend(); ++row) {
      if (take_names(*row)) {
        take_units(head, row->number);
        return {};
      }
    }
    return check_unread_names(head);
  }

  Result<void> refuse_grids(const std::vector<Row>& head, std::size_t counts) const {
    for (const Row& row : head) {
      const std::string first = small_letters(fields_of(row.text, k_blanks).front());
      if (first == "ncols" || first == "nrows" || first == "cellsize" || first == "dsaa")
        return grid(row.number);
    }
    // Two counts, then twelve numbers of a place and a matrix.
    if (counts == 2 && layout_.fields == 4 && points_.size() > 4) {
      const auto matrix_row = [&](std::size_t i) { return fields_of(points_[i].text, way_.separator); };
      if (matrix_row(3).back() == "1" && matrix_row(0).back() == "0" && matrix_row(1).back() == "0")
        return fail(Errc::BadFormat,
                    "%s: a PTX file, whose points have places of their own; save it as PTS or XYZ",
                    file_.c_str());
    }
    return {};
  }
  tl::unexpected<Error> grid(std::size_t row) const {
    return fail(
        Errc::BadFormat,
        "%s row %zu: a grid of heights, %zu a row, and x y z of each point expected; save it as points",
        file_.c_str(), row, layout_.fields);
  }

  bool take_names(const Row& row) {
    const std::string_view plain = without_mark(row.text);
    for (const char separator : {way_.separator, k_blanks, ',', ';', '\t'}) {
      std::vector<std::string_view> names = fields_of(plain, separator);
      // Separators behind the last name.
      while (names.size() > layout_.fields && names.back().empty()) names.pop_back();
      const bool row_names = names.size() + 1 == layout_.fields && !is_comment(row.text) && has_row_names();
      if (names.size() != layout_.fields && !row_names) continue;
      const auto named = named_columns(names);
      if (!named) continue;
      layout_.named = true;
      layout_.columns = named->field;
      layout_.unit = named->unit;
      if (row_names) {
        for (std::size_t& column : layout_.columns) ++column;
      }
      return true;
    }
    return false;
  }
  /// R writes each row's name in front of it, and no name for these.
  [[nodiscard]] bool has_row_names() const {
    const auto fields = fields_of(points_.front().text, way_.separator);
    return fields.front().starts_with('"') || lone_count(fields.front()).has_value();
  }

  /// A row of units may stand behind the names.
  void take_units(const std::vector<Row>& head, std::size_t names_row) {
    for (const Row& row : head) {
      if (row.number <= names_row) continue;
      const auto fields = fields_of(without_mark(row.text), way_.separator);
      if (fields.size() != layout_.fields) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::string_view word = fields[layout_.columns[axis]];
        const auto begin = word.find_first_not_of("\"[( "), end = word.find_last_not_of("\"]) ");
        if (begin == std::string_view::npos) continue;
        if (const auto unit = unit_of_word(word.substr(begin, end + 1 - begin))) layout_.unit[axis] = unit;
      }
    }
  }

  /// The row in front of the points is a head that was not understood, or just words.
  Result<void> check_unread_names(const std::vector<Row>& head) const {
    if (head.empty() || is_comment(head.back().text) || numbered_names_) return {};
    const Row& row = head.back();
    const auto names = fields_of(row.text, way_.separator);
    if (lone_count(row.text) || !has_letter(row.text) || names.size() < 3) return {};
    const auto words = static_cast<std::size_t>(std::ranges::count_if(names, is_word));
    if (named_columns(names) || (way_.separator != k_blanks && names.size() > layout_.fields)) {
      return fail(Errc::BadFormat,
                  "%s row %zu: as many names as numbers expected, found %zu names and %zu numbers%s",
                  file_.c_str(), row.number, names.size(), layout_.fields,
                  way_.separator == ',' && layout_.fields > names.size() ? " (a decimal comma?)" : "");
    }
    if (names.size() == layout_.fields && layout_.fields > 3 && 2 * words >= names.size()) {
      return fail(Errc::BadFormat, "%s row %zu: columns named x, y and z expected, found '%s'", file_.c_str(),
                  row.number, clean_text(trimmed(row.text), 60).c_str());
    }
    return {};
  }

  /// Without names: the first three columns that hold numbers.
  Result<void> choose_columns() {
    if (layout_.fields >= k_least_grid_fields) return grid(layout_.first_row);
    std::vector<std::size_t> numbers(layout_.fields, 0), wrong(layout_.fields, 0);
    for (const Row& row : points_) {
      const auto fields = fields_of(row.text, way_.separator);
      for (std::size_t i = 0; i < std::min(fields.size(), layout_.fields); ++i) {
        double value = 0;
        const Written written = written_number(fields[i], way_.decimal, value);
        numbers[i] += written == Written::Number ? 1 : 0;
        wrong[i] += written == Written::Wrong ? 1 : 0;
      }
    }
    std::vector<std::size_t> usable;
    for (std::size_t i = 0; i < layout_.fields; ++i) {
      if (numbers[i] > 0 && numbers[i] >= wrong[i]) usable.push_back(i);
    }
    if (usable.size() > 3 && is_row_number(usable[0])) usable.erase(usable.begin());
    if (usable.size() < 3) {
      return fail(Errc::BadFormat, "%s row %zu: three columns of numbers expected, found %zu", file_.c_str(),
                  layout_.first_row, usable.size());
    }
    std::copy_n(usable.begin(), 3, layout_.columns.begin());
    return {};
  }

  /// Counts up by one from the first row to the last.
  [[nodiscard]] bool is_row_number(std::size_t column) const {
    std::optional<std::uint64_t> first;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto fields = fields_of(points_[i].text, way_.separator);
      const auto value = column < fields.size() ? lone_count(fields[column]) : std::nullopt;
      if (!first) first = value;
      if (!value || *value != *first + i) return false;
    }
    // The last row tells whether it goes on so; comments and blank rows may be in between.
    const std::size_t end = text_.find_last_not_of(" \t\r\n");
    std::size_t begin = text_.find_last_of("\r\n", end);
    begin = begin == std::string_view::npos ? 0 : begin + 1;
    const auto fields = fields_of(text_.substr(begin, end + 1 - begin), way_.separator);
    const auto last = column < fields.size() ? lone_count(fields[column]) : std::nullopt;
    const auto ends = static_cast<std::uint64_t>(
        std::max(std::ranges::count(text_, '\n'), std::ranges::count(text_, '\r')));
    return last && *last >= *first && *last - *first <= ends &&
           *last - *first + layout_.first_row + 16 >= ends;
  }

  std::string_view text_;
  const fs::path& file_;
  std::vector<Row> all_, points_;  ///< of the sample: with something in them; and no comments
  Way way_{};
  bool numbered_names_{false};
  TextLayout layout_;
};

const char* separator_words(char separator) {
  switch (separator) {
    case '\t':
      return "tabs";
    case ',':
      return "commas";
    case ';':
      return "semicolons";
    case '|':
      return "bars";
    default:
      return "blanks";
  }
}

}  // namespace

std::string TextLayout::words() const {
  const std::size_t x = columns[0] + 1, y = columns[1] + 1, z = columns[2] + 1;
  FixedText<160> text;
  if (y == x + 1 && z == y + 1) {
    text = FixedText<160>::format("columns %zu to %zu of %zu", x, z, fields);
  } else {
    text = FixedText<160>::format("columns %zu, %zu, %zu of %zu", x, y, z, fields);
  }
  return std::string(text.view()) + ", " + separator_words(separator) +
         (decimal == ',' ? ", decimal comma" : ", decimal point");
}

bool is_comment(std::string_view row) {
  const auto first = row.find_first_not_of(" \t");
  if (first == std::string_view::npos) return false;
  const char c = row[first];
  return c == '#' || c == '%' || c == '!' || (c == '/' && row.substr(first).starts_with("//"));
}

std::optional<std::uint64_t> lone_count(std::string_view row) {
  const std::string_view text = trimmed(row);
  if (text.empty() || text.size() > 18) return std::nullopt;
  std::uint64_t value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    value = 10 * value + static_cast<std::uint64_t>(c - '0');
  }
  return value;
}

Result<TextLayout> text_layout(std::string_view text, const fs::path& file) {
  return Finder{text, file}.find();
}

}  // namespace biteline::cloud
