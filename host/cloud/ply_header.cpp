// SPDX-License-Identifier: MIT
#include "host/cloud/ply_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>

namespace biteline::cloud {
namespace {

struct TypeName {
  std::string_view name;
  PlyScalar type;
};
// Both spellings are in use.
constexpr std::array k_type_names{
    TypeName{"char", PlyScalar::Int8},      TypeName{"int8", PlyScalar::Int8},
    TypeName{"uchar", PlyScalar::Uint8},    TypeName{"uint8", PlyScalar::Uint8},
    TypeName{"short", PlyScalar::Int16},    TypeName{"int16", PlyScalar::Int16},
    TypeName{"ushort", PlyScalar::Uint16},  TypeName{"uint16", PlyScalar::Uint16},
    TypeName{"int", PlyScalar::Int32},      TypeName{"int32", PlyScalar::Int32},
    TypeName{"uint", PlyScalar::Uint32},    TypeName{"uint32", PlyScalar::Uint32},
    TypeName{"float", PlyScalar::Float32},  TypeName{"float32", PlyScalar::Float32},
    TypeName{"double", PlyScalar::Float64}, TypeName{"float64", PlyScalar::Float64}};

std::optional<PlyScalar> to_type(std::string_view name) {
  const auto found = std::find_if(k_type_names.begin(), k_type_names.end(),
                                  [&](const TypeName& t) { return t.name == name; });
  if (found == k_type_names.end()) return std::nullopt;
  return found->type;
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
    case PlyScalar::Float64:
      return 8;
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

Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& name) {
  PlyHeader header;
  bool has_format = false;
  int line_number = 0;
  for (std::size_t begin = 0;;) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string_view::npos) {
      if (line_number == 0) return fail(Errc::BadFormat, "%s: a PLY file expected", name.c_str());
      return fail(Errc::Truncated, "%s line %d: end_header expected", name.c_str(), line_number + 1);
    }
    const auto words = words_of(bytes.substr(begin, end - begin));
    begin = end + 1;
    ++line_number;
    if (line_number == 1) {
      if (words.empty() || words[0] != "ply")
        return fail(Errc::BadFormat, "%s: a PLY file expected", name.c_str());
      continue;
    }
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    const auto bad = [&](const char* expected) {
      return fail(Errc::BadFormat, "%s line %d: %s expected", name.c_str(), line_number, expected);
    };
    if (words[0] == "format" && words.size() >= 2) {
      if (words[1] == "ascii")
        header.encoding = PlyEncoding::Ascii;
      else if (words[1] == "binary_little_endian")
        header.encoding = PlyEncoding::LittleEndian;
      else if (words[1] == "binary_big_endian")
        header.encoding = PlyEncoding::BigEndian;
      else
        return bad("ascii, binary_little_endian or binary_big_endian");
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      PlyElement element{.name = std::string(words[1]), .count = 0, .properties = {}};
      const auto [stop, status] =
          std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
      if (status != std::errc{} || stop != words[2].data() + words[2].size()) return bad("a number of rows");
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property" && !header.elements.empty()) {
      PlyProperty property;
      property.is_list = words.size() == 5 && words[1] == "list";
      if (!property.is_list && words.size() != 3) return bad("property TYPE NAME");
      const auto type = to_type(property.is_list ? words[3] : words[1]);
      const auto count_type = property.is_list ? to_type(words[2]) : PlyScalar::Uint8;
      if (!type || !count_type) return bad("a known property type");
      property.type = *type;
      property.count_type = *count_type;
      property.name = std::string(words.back());
      header.elements.back().properties.push_back(std::move(property));
    } else if (words[0] == "end_header") {
      if (!has_format) return bad("a format line before end_header");
      header.body_begin = begin;
      header.body_first_line = line_number + 1;
      return header;
    } else {
      return bad("a PLY header line");
    }
  }
}

PlyBody::PlyBody(std::string_view bytes, const PlyHeader& header, const std::string& name)
    : bytes_{bytes},
      at_{header.body_begin},
      encoding_{header.encoding},
      line_{header.body_first_line},
      name_{name} {}

tl::unexpected<Error> PlyBody::truncated() const {
  if (ascii()) return fail(Errc::Truncated, "%s line %d: more values expected", name_.c_str(), line_);
  return fail(Errc::Truncated, "%s byte %zu: more values expected", name_.c_str(), bytes_.size());
}

Result<double> PlyBody::next(PlyScalar type) {
  if (!ascii()) {
    BITELINE_ASSIGN(const std::string_view raw, take_bytes(size_bytes(type)));
    return decode_scalar(raw.data(), type, big_endian());
  }
  at_ = bytes_.find_first_not_of(" \t\r", at_);
  if (at_ == std::string_view::npos || at_ >= bytes_.size()) {
    at_ = bytes_.size();
    return truncated();
  }
  if (bytes_[at_] == '\n')
    return fail(Errc::BadFormat, "%s line %d: more fields expected", name_.c_str(), line_);
  const std::size_t end = std::min(bytes_.find_first_of(" \t\r\n", at_), bytes_.size());
  double value = 0;
  const auto [stop, status] = std::from_chars(bytes_.data() + at_, bytes_.data() + end, value);
  if (status != std::errc{} || stop != bytes_.data() + end) {
    return fail(Errc::BadFormat, "%s line %d: a number expected, found '%.20s'", name_.c_str(), line_,
                std::string(bytes_.substr(at_, end - at_)).c_str());
  }
  at_ = end;
  return value;
}

Result<void> PlyBody::end_row() {
  if (!ascii()) return {};
  const std::size_t rest = bytes_.find_first_not_of(" \t\r", at_);
  if (rest != std::string_view::npos && bytes_[rest] != '\n') {
    return fail(Errc::BadFormat, "%s line %d: fewer fields expected", name_.c_str(), line_);
  }
  at_ = rest == std::string_view::npos ? bytes_.size() : rest + 1;
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
