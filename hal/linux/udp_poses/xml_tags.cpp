// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/xml_tags.hpp"

#include <algorithm>

namespace biteline::hal {
namespace {

constexpr std::string_view k_blank = " \t\r\n";

bool is_name(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '_' || letter == '.' || letter == '-' || letter == ':';
}

void skip_blank(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(k_blank), text.size()));
}

std::string_view take_name(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_name);
  const std::string_view name = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(name.size());
  return name;
}

struct Attribute {
  std::string_view name, value;
};

/// `name = "value"` from the front; nothing: there is none.
std::optional<Attribute> take_attribute(std::string_view& text) {
  skip_blank(text);
  const std::string_view name = take_name(text);
  skip_blank(text);
  if (name.empty() || !text.starts_with('=')) return std::nullopt;
  text.remove_prefix(1);
  skip_blank(text);
  if (text.empty() || (text.front() != '"' && text.front() != '\'')) return std::nullopt;
  const std::size_t end = text.find(text.front(), 1);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view value = text.substr(1, end - 1);
  text.remove_prefix(end + 1);
  return Attribute{name, value};
}

/// All attributes up to `>` or `/>`, as written; nothing: they are not well formed.
std::optional<std::string_view> take_attributes(std::string_view& text) {
  const std::string_view begin = text;
  while (true) {
    skip_blank(text);
    if (text.starts_with('>') || text.starts_with("/>")) return begin.substr(0, begin.size() - text.size());
    if (!take_attribute(text)) return std::nullopt;
  }
}

}  // namespace

std::optional<XmlTags::Tag> XmlTags::next() {
  skip_blank(rest_);
  if (rest_.empty() || !whole_) return std::nullopt;
  const std::optional<Tag> found = tag();
  whole_ = found.has_value();
  return found;
}

std::optional<XmlTags::Tag> XmlTags::tag() {
  if (!rest_.starts_with('<')) return std::nullopt;
  rest_.remove_prefix(1);
  Tag found{.name = {}, .attributes = {}, .text_after = {}, .opens = !rest_.starts_with('/')};
  found.closes = !found.opens;
  if (found.closes) rest_.remove_prefix(1);
  found.name = take_name(rest_);
  const std::optional<std::string_view> attributes = take_attributes(rest_);
  if (found.name.empty() || !attributes) return std::nullopt;
  found.attributes = *attributes;
  if (rest_.starts_with('/')) {
    if (found.closes) return std::nullopt;
    found.closes = true;
    rest_.remove_prefix(1);
  }
  rest_.remove_prefix(1);
  const std::size_t end = std::min(rest_.find('<'), rest_.size());
  found.text_after = rest_.substr(0, end);
  rest_.remove_prefix(end);
  return found;
}

std::optional<std::string_view> attribute(std::string_view attributes, std::string_view name) {
  while (const std::optional<Attribute> found = take_attribute(attributes)) {
    if (found->name == name) return found->value;
  }
  return std::nullopt;
}

}  // namespace biteline::hal
