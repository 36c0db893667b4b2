// SPDX-License-Identifier: MIT
#include "host/cloud/text_encoding.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace biteline::cloud {
namespace {

struct Signature {
  std::string_view bytes;
  const char* name;
};
constexpr std::array k_signatures{
    Signature{"PK\x03\x04", "a zip archive (an Excel file? save it as CSV)"},
    Signature{"\x1F\x8B", "a gzip file: unpack it first"},
    Signature{"\xD0\xCF\x11\xE0", "an old Excel file: save it as CSV"},
    Signature{"LASF", "a LAS file: save it as PLY or XYZ"},
    Signature{"ASTM-E57", "an E57 file: save it as PLY or XYZ"},
    Signature{"\x89HDF", "an HDF5 file: save the points as PLY or XYZ"},
};

void append_utf8(std::string& text, std::uint32_t letter) {
  if (letter < 0x80) {
    text += static_cast<char>(letter);
  } else if (letter < 0x800) {
    text += static_cast<char>(0xC0 | letter >> 6U);
    text += static_cast<char>(0x80 | (letter & 0x3FU));
  } else {
    // Pairs for rare letters become two: none of them is part of a number.
    text += static_cast<char>(0xE0 | letter >> 12U);
    text += static_cast<char>(0x80 | (letter >> 6U & 0x3FU));
    text += static_cast<char>(0x80 | (letter & 0x3FU));
  }
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto first = static_cast<std::uint8_t>(bytes[i]), second = static_cast<std::uint8_t>(bytes[i + 1]);
    append_utf8(text, big_endian ? first << 8U | second : second << 8U | first);
  }
  return text;
}

}  // namespace

Result<std::string> as_plain_text(std::string bytes, const std::filesystem::path& file) {
  const std::string_view all{bytes};
  if (all.starts_with("\xEF\xBB\xBF")) {
    bytes.erase(0, 3);
    return bytes;
  }
  if (all.starts_with("\xFF\xFE")) return from_utf16(all.substr(2), false);
  if (all.starts_with("\xFE\xFF")) return from_utf16(all.substr(2), true);
  for (const Signature& signature : k_signatures) {
    if (all.starts_with(signature.bytes))
      return fail(Errc::BadFormat, "%s: a text expected, found %s", file.c_str(), signature.name);
  }
  const std::string_view begin = all.substr(0, 4096);
  const auto zero_at = [&](std::size_t odd) {
    std::size_t zeros = 0;
    for (std::size_t i = odd; i < begin.size(); i += 2) zeros += begin[i] == '\0' ? 1 : 0;
    return 10 * zeros >= 9 * (begin.size() / 2) && zeros > 1;
  };
  if (zero_at(1)) return from_utf16(all, false);
  if (zero_at(0)) return from_utf16(all, true);
  if (std::ranges::count(begin, '\0') > 0)
    return fail(Errc::BadFormat, "%s: a text expected, found binary data", file.c_str());
  return bytes;
}

}  // namespace biteline::cloud
