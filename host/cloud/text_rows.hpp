// SPDX-License-Identifier: MIT
#pragma once
/// \file A text's rows and their fields, parted as one file parts them.

#include <cstddef>
#include <cstring>
#include <string_view>

namespace biteline::cloud {

/// The rows of a text, one after another, with their numbers.  Ends of any system: LF, CR LF or CR.
class TextRows {
 public:
  explicit TextRows(std::string_view text)
      : text_{text}, end_{text.find('\n') == std::string_view::npos ? '\r' : '\n'} {}

  /// The next row without its end, blank ones as well; false behind the last one.
  bool next(std::string_view& row) {
    if (at_ >= text_.size()) return false;
    const char* const begin = text_.data() + at_;
    const void* const found = std::memchr(begin, end_, text_.size() - at_);
    const std::size_t size = found == nullptr
                                 ? text_.size() - at_
                                 : static_cast<std::size_t>(static_cast<const char*>(found) - begin);
    row = {begin, size};
    begin_ = at_;
    at_ += size + 1;
    while (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }  ///< of the last row, from 1
  [[nodiscard]] std::size_t begin() const { return begin_; }    ///< its first byte

 private:
  std::string_view text_;
  char end_;
  std::size_t at_{0}, begin_{0}, number_{0};
};

/// What stands between two fields: one separator (blanks about it do not count), or any number of blanks.
inline constexpr char k_blanks = ' ';

/// Takes fields off a row's front.  Between blanks there are no empty fields, between separators there are.
class TextFields {
 public:
  TextFields(std::string_view row, char separator)
      : at_{row.data()}, end_{row.data() + row.size()}, separator_{separator} {
    skip_blanks();
    more_ = at_ != end_;
  }

  /// False: no further field.  Quotes stay about a field; a separator within them does not part.
  bool next(std::string_view& field) {
    if (!more_) return false;
    skip_blanks();
    const char* const begin = at_;
    if (at_ != end_ && *at_ == '"') {
      const void* const close = std::memchr(at_ + 1, '"', static_cast<std::size_t>(end_ - at_ - 1));
      if (close != nullptr) at_ = static_cast<const char*>(close) + 1;
    }
    if (separator_ == k_blanks) {
      while (at_ != end_ && !is_blank(*at_)) ++at_;
      field = {begin, static_cast<std::size_t>(at_ - begin)};
      skip_blanks();
      more_ = at_ != end_;
      return true;
    }
    while (at_ != end_ && *at_ != separator_) ++at_;
    field = {begin, static_cast<std::size_t>(at_ - begin)};
    while (!field.empty() && is_blank(field.back())) field.remove_suffix(1);
    more_ = at_ != end_;
    if (more_) ++at_;
    return true;
  }

 private:
  [[nodiscard]] bool is_blank(char c) const { return c == ' ' || (c == '\t' && separator_ != '\t'); }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }

  const char* at_;
  const char* end_;
  char separator_;
  bool more_;
};

}  // namespace biteline::cloud
