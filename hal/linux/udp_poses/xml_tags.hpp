// SPDX-License-Identifier: MIT
#pragma once
/// \file The little of XML that a robot controller writes: tags, attributes and text; no entities, comments
/// or character data sections.

#include <optional>
#include <string_view>

namespace biteline::hal {

/// Walks over the tags of one text.  Memory: none; the text is borrowed.
class XmlTags {
 public:
  struct Tag {
    std::string_view name;
    std::string_view attributes;  ///< as written; well formed
    std::string_view text_after;  ///< up to the next tag
    bool opens{false};            ///< `<name>`
    bool closes{false};           ///< `</name>`; with `opens`: `<name/>`
  };

  explicit XmlTags(std::string_view text) : rest_{text} {}

  /// The next tag; nothing at the end, or where the text is none of this (whole() tells).
  [[nodiscard]] std::optional<Tag> next();
  [[nodiscard]] bool whole() const { return whole_; }

 private:
  [[nodiscard]] std::optional<Tag> tag();

  std::string_view rest_;
  bool whole_{true};
};

/// The value of that attribute; nothing: it has none of that name.  Pre: well formed, as XmlTags has them.
[[nodiscard]] std::optional<std::string_view> attribute(std::string_view attributes, std::string_view name);

}  // namespace biteline::hal
