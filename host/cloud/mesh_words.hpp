// SPDX-License-Identifier: MIT
#pragma once
/// \file The words of a text mesh, with their rows.

#include <filesystem>
#include <limits>
#include <string_view>

#include <Eigen/Core>

#include "common/core/result.hpp"
#include "common/core/text.hpp"
#include "host/cloud/written_number.hpp"

namespace biteline::cloud {

/// Words of a text, row by row.  A backslash at a row's end joins the next one to it.
class MeshWords {
 public:
  explicit MeshWords(std::string_view text) : text_{text} {}

  /// Goes on from a row, the first one to begin with, to the next; false at the end.
  bool next_row() {
    while (at_ < text_.size() && !is_end(text_[at_])) ++at_;
    take_end();
    return at_ < text_.size();
  }
  /// The row's next word; empty at its end.
  std::string_view next() {
    while (at_ < text_.size()) {
      if (is_blank(text_[at_])) {
        ++at_;
      } else if (text_[at_] == '\\' && at_ + 1 < text_.size() && is_end(text_[at_ + 1])) {
        ++at_;
        take_end();
      } else {
        break;
      }
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && !is_end(text_[at_]) && text_[at_] != '\\') ++at_;
    if (at_ == begin && at_ < text_.size() && text_[at_] == '\\') ++at_;  // alone within a row: a word
    return text_.substr(begin, at_ - begin);
  }
  /// The next word, whichever row it is in; empty at the text's end.
  std::string_view next_anywhere() {
    std::string_view word = next();
    while (word.empty() && next_row()) word = next();
    return word;
  }
  [[nodiscard]] std::size_t row() const { return row_; }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t'; }
  static bool is_end(char c) { return c == '\n' || c == '\r'; }
  void take_end() {
    if (at_ >= text_.size()) return;
    at_ += text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n' ? 2 : 1;
    ++row_;
  }

  std::string_view text_;
  std::size_t at_{0}, row_{1};
};

/// Three numbers; NaN for words that stand for none.
inline Result<Eigen::Vector3d> next_place(MeshWords& words, const std::filesystem::path& file) {
  Eigen::Vector3d place = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = words.next();
    if (word.empty() || written_number(word, '.', place[axis]) == Written::Wrong) {
      return fail(Errc::BadValue, "%s row %zu, %c: a number expected, found '%s'", file.c_str(), words.row(),
                  'x' + axis, clean_text(word, 20).c_str());
    }
  }
  return place;
}

}  // namespace biteline::cloud
