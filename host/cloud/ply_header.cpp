// SPDX-License-Identifier: MIT
#include "host/cloud/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>

#include "common/core/text.hpp"
#include "host/cloud/letters.hpp"
#include "host/cloud/written_number.hpp"

namespace biteline::cloud {
namespace {

struct TypeName {
  std::string_view name;
  PlyScalar type;
};
// All spellings are in use.
constexpr std::array k_type_names{
    TypeName{"char", PlyScalar::Int8},      TypeName{"int8", PlyScalar::Int8},
    TypeName{"uchar", PlyScalar::Uint8},    TypeName{"uint8", PlyScalar::Uint8},
    TypeName{"short", PlyScalar::Int16},    TypeName{"int16", PlyScalar::Int16},
    TypeName{"ushort", PlyScalar::Uint16},  TypeName{"uint16", PlyScalar::Uint16},
    TypeName{"int", PlyScalar::Int32},      TypeName{"int32", PlyScalar::Int32},
    TypeName{"uint", PlyScalar::Uint32},    TypeName{"uint32", PlyScalar::Uint32},
    TypeName{"int64", PlyScalar::Int64},    TypeName{"uint64", PlyScalar::Uint64},
    TypeName{"longlong", PlyScalar::Int64}, TypeName{"ulonglong", PlyScalar::Uint64},
    TypeName{"float", PlyScalar::Float32},  TypeName{"float32", PlyScalar::Float32},
    TypeName{"double", PlyScalar::Float64}, TypeName{"float64", PlyScalar::Float64},
    TypeName{"bool", PlyScalar::Uint8}};

PlyScalar to_type(std::string_view name) {
  if (name.ends_with("_t")) name.remove_suffix(2);
  const auto found = std::ranges::find(k_type_names, name, &TypeName::name);
  return found == k_type_names.end() ? PlyScalar::Word : found->type;
}

/// "end_header", "END_HEADER", "end header", "endheader".
bool is_end(std::string_view line) {
  std::string letters;
  for (const char c : small_letters(line)) {
    if (c >= 'a' && c <= 'z')
      letters += c;
    else if (c != '_' && c != '-' && c != ' ' && c != '\t' && c != '\r')
      return false;
  }
  return letters == "endheader";
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0;;) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

template <class T>
T load(const char* bytes, bool big_endian) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (big_endian) std::reverse(raw.begin(), raw.end());
  T value;
  std::memcpy(&value, raw.data(), sizeof(T));
  return value;
}

}  // namespace

std::size_t size_bytes(PlyScalar type) {
  switch (type) {
    case PlyScalar::Int8:
    case PlyScalar::Uint8:
      return 1;
    case PlyScalar::Int16:
    case PlyScalar::Uint16:
      return 2;
    case PlyScalar::Int32:
    case PlyScalar::Uint32:
    case PlyScalar::Float32:
      return 4;
    case PlyScalar::Int64:
    case PlyScalar::Uint64:
    case PlyScalar::Float64:
      return 8;
    case PlyScalar::Word:
      return 0;
  }
  return 0;
}

double decode_scalar(const char* bytes, PlyScalar type, bool big_endian) {
  switch (type) {
    case PlyScalar::Int8:
      return load<std::int8_t>(bytes, big_endian);
    case PlyScalar::Uint8:
      return load<std::uint8_t>(bytes, big_endian);
    case PlyScalar::Int16:
      return load<std::int16_t>(bytes, big_endian);
    case PlyScalar::Uint16:
      return load<std::uint16_t>(bytes, big_endian);
    case PlyScalar::Int32:
      return load<std::int32_t>(bytes, big_endian);
    case PlyScalar::Uint32:
      return load<std::uint32_t>(bytes, big_endian);
    case PlyScalar::Float32:
      return static_cast<double>(load<float>(bytes, big_endian));
    case PlyScalar::Float64:
      return load<double>(bytes, big_endian);
    case PlyScalar::Int64:
      return static_cast<double>(load<std::int64_t>(bytes, big_endian));
    case PlyScalar::Uint64:
      return static_cast<double>(load<std::uint64_t>(bytes, big_endian));
    case PlyScalar::Word:
      break;
  }
  return 0;
}

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::row_bytes() const {
  std::size_t sum = 0;
  for (const PlyProperty& property : properties) sum += size_bytes(property.type);
  return sum;
}

namespace {

/// Takes the words of one line in; fails with what was expected instead.
class HeaderLines {
 public:
  /// Null: it was good.
  const char* take(const std::vector<std::string>& words) {
    if (words[0] == "format") return take_format(words);
    if (words[0] == "element") return take_element(words);
    if (words[0] == "property" && !header.elements.empty()) return take_property(words);
    return "a PLY header line";
  }
  [[nodiscard]] bool has_format() const { return has_format_; }
  /// A row of it has no known length.  The format line may come after properties that text may have.
  [[nodiscard]] bool is_binary_of_unknown_types() const {
    const auto is_unknown = [](const PlyProperty& property) {
      return property.type == PlyScalar::Word || (property.is_list && property.count_type == PlyScalar::Word);
    };
    return header.encoding != PlyEncoding::Ascii &&
           std::ranges::any_of(header.elements, [&](const PlyElement& element) {
             return std::ranges::any_of(element.properties, is_unknown);
           });
  }

  PlyHeader header;

 private:
  const char* take_format(const std::vector<std::string>& words) {
    const std::string_view kind = words.size() > 1 ? words[1] : std::string_view{};
    if (has_format_) return "only one format line";
    if (kind == "ascii")
      header.encoding = PlyEncoding::Ascii;
    else if (kind == "binary_little_endian")
      header.encoding = PlyEncoding::LittleEndian;
    else if (kind == "binary_big_endian")
      header.encoding = PlyEncoding::BigEndian;
    else
      return "ascii, binary_little_endian or binary_big_endian";
    has_format_ = true;
    return nullptr;
  }
  const char* take_element(const std::vector<std::string>& words) {
    if (words.size() != 3) return "element NAME COUNT";
    PlyElement element{.name = words[1], .count = 0, .properties = {}};
    const auto [stop, status] =
        std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
    if (status != std::errc{} || stop != words[2].data() + words[2].size()) return "a number of rows";
    header.elements.push_back(std::move(element));
    return nullptr;
  }
  const char* take_property(const std::vector<std::string>& words) {
    PlyProperty property;
    property.is_list = words.size() == 5 && words[1] == "list";
    if (!property.is_list && words.size() != 3) return "property TYPE NAME";
    property.type = to_type(property.is_list ? words[3] : words[1]);
    if (property.is_list) property.count_type = to_type(words[2]);
    const bool known = property.type != PlyScalar::Word && property.count_type != PlyScalar::Word;
    if (!known && header.encoding != PlyEncoding::Ascii) return "a known property type";
    property.name = words.back();
    header.elements.back().properties.push_back(std::move(property));
    return nullptr;
  }

  bool has_format_{false};
};

/// The first line's end is that of all lines.
char line_end_of(std::string_view bytes) {
  const std::size_t first = bytes.find_first_of("\r\n");
  const bool old_mac = first != std::string_view::npos && bytes[first] == '\r' &&
                       (first + 1 == bytes.size() || bytes[first + 1] != '\n');
  return old_mac ? '\r' : '\n';
}

}  // namespace

Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& name) {
  HeaderLines lines;
  lines.header.line_end = line_end_of(bytes);
  int line_number = 0;
  for (std::size_t begin = bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0;;) {
    const std::size_t end = bytes.find(lines.header.line_end, begin);
    if (end == std::string_view::npos) {
      if (line_number == 0) return fail(Errc::BadFormat, "%s: a PLY file expected", name.c_str());
      return fail(Errc::Truncated, "%s line %d: end_header expected", name.c_str(), line_number + 1);
    }
    const std::string_view line = bytes.substr(begin, end - begin);
    std::vector<std::string> words;
    for (const std::string_view word : words_of(line)) words.push_back(small_letters(word));
    begin = end + 1;
    ++line_number;
    if (line_number == 1) {
      if (words.empty() || words[0] != "ply")
        return fail(Errc::BadFormat, "%s: a PLY file expected", name.c_str());
      continue;
    }
    if (words.empty() || words[0].starts_with("comment") || words[0] == "obj_info") continue;
    const auto bad = [&](const char* expected) {
      return fail(Errc::BadFormat, "%s line %d: %s expected", name.c_str(), line_number, expected);
    };
    if (is_end(line)) {
      if (!lines.has_format()) return bad("a format line before end_header");
      if (lines.is_binary_of_unknown_types()) return bad("known property types in a binary file");
      lines.header.body_begin = begin;
      lines.header.body_first_line = line_number + 1;
      return std::move(lines.header);
    }
    if (const char* const expected = lines.take(words)) return bad(expected);
  }
}

PlyBody::PlyBody(std::string_view bytes, const PlyHeader& header, const std::string& name)
    : bytes_{bytes},
      at_{header.body_begin},
      encoding_{header.encoding},
      line_{header.body_first_line},
      end_{header.line_end},
      name_{name} {}

tl::unexpected<Error> PlyBody::truncated() const {
  if (ascii()) return fail(Errc::Truncated, "%s line %d: more values expected", name_.c_str(), line_);
  return fail(Errc::Truncated, "%s byte %zu: more values expected", name_.c_str(), bytes_.size());
}

Result<std::string_view> PlyBody::next_word() {
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  if (at_ >= bytes_.size()) return truncated();
  if (bytes_[at_] == end_)
    return fail(Errc::BadFormat, "%s line %d: more fields expected", name_.c_str(), line_);
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_]) && bytes_[at_] != end_) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

Result<double> PlyBody::next(PlyScalar type) {
  if (!ascii()) {
    BITELINE_ASSIGN(const std::string_view raw, take_bytes(size_bytes(type)));
    return decode_scalar(raw.data(), type, big_endian());
  }
  BITELINE_ASSIGN(const std::string_view word, next_word());
  double value = std::numeric_limits<double>::quiet_NaN();
  if (written_number(word, '.', value) != Written::Wrong) return value;
  return fail(Errc::BadFormat, "%s line %d: a number expected, found '%s'", name_.c_str(), line_,
              clean_text(word, 20).c_str());
}

Result<void> PlyBody::skip(PlyScalar type) {
  if (ascii()) {
    BITELINE_TRY(next_word());
  } else {
    BITELINE_TRY(take_bytes(size_bytes(type)));
  }
  return {};
}

Result<void> PlyBody::end_row() {
  if (!ascii()) return {};
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  if (at_ < bytes_.size() && bytes_[at_] != end_) {
    return fail(Errc::BadFormat, "%s line %d: fewer fields expected", name_.c_str(), line_);
  }
  at_ = std::min(at_ + 1, bytes_.size());
  ++line_;
  return {};
}

Result<void> PlyBody::skip_bytes(std::size_t count) {
  BITELINE_TRY(take_bytes(count));
  return {};
}

Result<std::string_view> PlyBody::take_bytes(std::size_t count) {
  if (count > bytes_.size() - at_) return truncated();
  const std::string_view taken = bytes_.substr(at_, count);
  at_ += count;
  return taken;
}

}  // namespace biteline::cloud
