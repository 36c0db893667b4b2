// SPDX-License-Identifier: MIT
#pragma once
/// \file The header of a PLY file, and scalar access to its rows.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::cloud {

enum class PlyEncoding { Ascii, LittleEndian, BigEndian };
enum class PlyScalar : std::uint8_t {
  Int8,
  Uint8,
  Int16,
  Uint16,
  Int32,
  Uint32,
  Int64,
  Uint64,
  Float32,
  Float64,
  Word,  ///< a type of no known size: passed over in ascii, refused in binary
};

[[nodiscard]] std::size_t size_bytes(PlyScalar type);

/// Names are in small letters.
struct PlyProperty {
  std::string name;
  PlyScalar type{PlyScalar::Float32};
  bool is_list{false};
  PlyScalar count_type{PlyScalar::Uint8};  ///< of a list
};

struct PlyElement {
  std::string name;
  std::size_t count{0};
  std::vector<PlyProperty> properties;

  /// Index of the property, or -1.
  [[nodiscard]] int find(std::string_view property) const;
  [[nodiscard]] bool has_list() const;
  /// Bytes of one binary row.  Pre: no lists.
  [[nodiscard]] std::size_t row_bytes() const;
};

struct PlyHeader {
  PlyEncoding encoding{PlyEncoding::Ascii};
  std::vector<PlyElement> elements;
  std::size_t body_begin{0};  ///< byte after end_header's line
  int body_first_line{0};     ///< its line number, for ascii
  char line_end{'\n'};        ///< '\r' in files of old Macs
};

/// `name` stands for the file in faults.
[[nodiscard]] Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& name);

/// Reads a file's body value by value, element by element, in the header's order.  Every read is checked
/// against the end.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header, const std::string& name);

  /// The next value, NaN for a word that stands for none; fails with Truncated or, in ascii, BadFormat naming
  /// the line.
  [[nodiscard]] Result<double> next(PlyScalar type);
  /// The next value is of no interest.
  [[nodiscard]] Result<void> skip(PlyScalar type);
  /// Ascii: ends the row, so that surplus or missing fields are told with their line.
  [[nodiscard]] Result<void> end_row();
  /// Leaves out `count` bytes (binary only).
  [[nodiscard]] Result<void> skip_bytes(std::size_t count);
  /// The next `count` bytes at once (binary only).
  [[nodiscard]] Result<std::string_view> take_bytes(std::size_t count);

  /// The file's, for faults.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool big_endian() const { return encoding_ == PlyEncoding::BigEndian; }
  [[nodiscard]] bool ascii() const { return encoding_ == PlyEncoding::Ascii; }

 private:
  [[nodiscard]] tl::unexpected<Error> truncated() const;
  [[nodiscard]] Result<std::string_view> next_word();
  [[nodiscard]] bool is_blank(char c) const { return c == ' ' || c == '\t' || (c == '\r' && end_ != '\r'); }

  std::string_view bytes_;
  std::size_t at_;
  PlyEncoding encoding_;
  int line_;
  char end_;
  const std::string& name_;
};

/// One binary scalar; `bytes` holds at least its size.
[[nodiscard]] double decode_scalar(const char* bytes, PlyScalar type, bool big_endian);

}  // namespace biteline::cloud
