// SPDX-License-Identifier: MIT
#include "common/csv/table.hpp"

#include <charconv>
#include <optional>

#include "common/system/file.hpp"

namespace biteline::csv {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace

Result<double> Row::number(std::size_t field, NumberRange range) const {
  double value = 0;
  if (!parse(fields_[field], value) || !range.holds(value)) {
    return fail(Errc::BadValue, "%s row %d, field %zu: a finite number from %g to %g expected, found '%.20s'",
                file_.c_str(), number_, field + 1, range.minimum, range.maximum,
                std::string(fields_[field]).c_str());
  }
  return value;
}

Result<std::int64_t> Row::integer(std::size_t field) const {
  std::int64_t value = 0;
  if (!parse(fields_[field], value)) {
    return fail(Errc::BadValue, "%s row %d, field %zu: a whole number expected, found '%.20s'", file_.c_str(),
                number_, field + 1, std::string(fields_[field]).c_str());
  }
  return value;
}

Result<void> read_table(const std::filesystem::path& file, std::size_t minimum_fields,
                        std::size_t maximum_fields, const std::function<Result<void>(const Row&)>& take) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_table_bytes));
  const std::string name = file.string();
  std::optional<Error> first;
  int faults = 0, row_number = 0;
  const auto note = [&](const Error& error) {
    if (!first) first = error;
    ++faults;
  };
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) end = text.size();
    const std::string_view line = trimmed(std::string_view{text}.substr(begin, end - begin));
    begin = end + 1;
    ++row_number;
    if (line.empty() || line.front() == '#') continue;
    const Row row{name, row_number, split(line)};
    if (row.size() < minimum_fields || row.size() > maximum_fields) {
      note(fail(Errc::BadFormat, "%s row %d: %zu fields expected, found %zu", name.c_str(), row_number,
                minimum_fields, row.size())
               .value());
    } else if (const Result<void> taken = take(row); !taken) {
      note(taken.error());
    }
  }
  if (!first) return {};
  first->more_faults = faults - 1;
  return tl::unexpected<Error>(*first);
}

}  // namespace biteline::csv
