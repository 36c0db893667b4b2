// SPDX-License-Identifier: MIT
#pragma once
/// \file Short texts of lines "key value", in one order and nothing else: what is signed has one reading.

#include <cstdint>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

namespace biteline::release {

/// 64 small hexadecimal digits.
[[nodiscard]] bool is_sha256(std::string_view text);
/// Letters, digits, '.', '_', '-', at most 64, no '.' in front.
[[nodiscard]] bool is_release_name(std::string_view text);

/// Takes line after line; the first that is not as expected is remembered.
class KeyLines {
 public:
  KeyLines(std::string_view text, const char* what) : rest_{text}, what_{what} {}

  /// The value of the next line, whose key this must be.
  std::string_view value(std::string_view key);
  /// A SHA-256, or nothing where "-" stands.
  std::string hash_if(std::string_view key);
  std::int64_t whole(std::string_view key);
  void fault(std::string_view key);
  /// Errc::BadFormat names the first wrong line; also where more follows.
  [[nodiscard]] Result<void> finish();

 private:
  std::string_view rest_;
  const char* what_;
  std::string wrong_;
};

}  // namespace biteline::release
