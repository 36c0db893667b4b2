// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/guards.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "common/core/text.hpp"

namespace biteline::web {
namespace {

constexpr std::size_t k_most_query_entries = 32;

int hex_digit(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  if (letter >= 'A' && letter <= 'F') return letter - 'A' + 10;
  return -1;
}

/// Escapes resolved; nothing where one is bad or what comes out is no clean text.
std::optional<std::string> unescape(std::string_view text, bool plus_is_space) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hex_digit(text[i + 1]);
      const int low = hex_digit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      out += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      out += plus_is_space && text[i] == '+' ? ' ' : text[i];
    }
  }
  if (clean_text(out) != out) return std::nullopt;
  return out;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string out{text};
  std::ranges::transform(out, out.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return out;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::string> decode_path(std::string_view path) {
  if (path.empty() || path.front() != '/') return std::nullopt;
  std::optional<std::string> text = unescape(path, false);
  if (!text || text->find('\\') != std::string::npos) return std::nullopt;
  // Judged after the escapes are resolved: %2e%2e and %2f are what they stand for.
  std::string_view rest{*text};
  rest.remove_prefix(1);
  while (!rest.empty()) {
    const std::size_t end = rest.find('/');
    const std::string_view part = rest.substr(0, end);
    if (part.empty() || part == "." || part == "..") return std::nullopt;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  return text;
}

std::optional<std::map<std::string, std::string>> decode_query(std::string_view query) {
  std::map<std::string, std::string> entries;
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view entry = query.substr(0, end);
    const std::size_t equals = entry.find('=');
    const auto name = unescape(entry.substr(0, equals), true);
    const auto value =
        unescape(equals == std::string_view::npos ? std::string_view{} : entry.substr(equals + 1), true);
    if (!name || name->empty() || !value || entries.size() >= k_most_query_entries) return std::nullopt;
    if (!entries.emplace(*name, *value).second) return std::nullopt;
    if (end == std::string_view::npos) break;
    query.remove_prefix(end + 1);
  }
  return entries;
}

std::string cookie_value(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = header.find(';');
    const std::string_view entry = trimmed(header.substr(0, end));
    const std::size_t equals = entry.find('=');
    if (equals != std::string_view::npos && entry.substr(0, equals) == name) {
      return std::string{entry.substr(equals + 1)};
    }
    if (end == std::string_view::npos) break;
    header.remove_prefix(end + 1);
  }
  return {};
}

std::string bearer_token(std::string_view header) {
  constexpr std::string_view k_scheme = "bearer ";
  if (header.size() <= k_scheme.size() || lower(header.substr(0, k_scheme.size())) != k_scheme) return {};
  return std::string{trimmed(header.substr(k_scheme.size()))};
}

bool is_token(std::string_view text) {
  return !text.empty() && text.size() <= 128 && std::ranges::all_of(text, [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '_' || letter == '=';
  });
}

std::string host_name(std::string_view host) {
  host = trimmed(host);
  std::string_view name = host;
  std::string_view port;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    name = host.substr(0, end + 1);
    port = host.substr(end + 1);
  } else if (const std::size_t colon = host.find(':'); colon != std::string_view::npos) {
    name = host.substr(0, colon);
    port = host.substr(colon);
  }
  if (!port.empty()) {
    const auto number = port.front() == ':' ? whole_number(port.substr(1)) : std::nullopt;
    if (!number || *number < 1 || *number > 65535) return {};
  }
  return lower(name);
}

bool host_allowed(std::string_view host, const std::vector<std::string>& names) {
  const std::string name = host_name(host);
  return !name.empty() && std::ranges::find(names, name) != names.end();
}

bool origin_allowed(const OriginFacts& facts) {
  if (!facts.fetch_site.empty() && facts.fetch_site != "same-origin" && facts.fetch_site != "none")
    return false;
  if (facts.origin.empty()) return true;
  const std::string own = (facts.tls ? "https://" : "http://") + lower(trimmed(facts.host));
  return lower(facts.origin) == own;
}

RangeAnswer read_range(std::string_view header, std::uint64_t size_bytes) {
  constexpr std::string_view k_unit = "bytes=";
  header = trimmed(header);
  if (header.empty() || !header.starts_with(k_unit) || header.find(',') != std::string_view::npos) return {};
  header.remove_prefix(k_unit.size());
  const std::size_t dash = header.find('-');
  if (dash == std::string_view::npos) return {};
  const auto first = whole_number(trimmed(header.substr(0, dash)));
  const auto last = whole_number(trimmed(header.substr(dash + 1)));
  const bool has_first = !trimmed(header.substr(0, dash)).empty();
  const bool has_last = !trimmed(header.substr(dash + 1)).empty();
  if ((has_first && !first) || (has_last && !last) || (!has_first && !has_last)) return {};
  if (first) {
    if (last && *last < *first) return {};
    if (*first >= size_bytes) return {.kind = RangeKind::Refused, .range = {}};
    return {.kind = RangeKind::Part,
            .range = {.first = *first, .last = std::min(last.value_or(size_bytes - 1), size_bytes - 1)}};
  }
  if (*last == 0 || size_bytes == 0) return {.kind = RangeKind::Refused, .range = {}};
  return {.kind = RangeKind::Part,
          .range = {.first = size_bytes - std::min(*last, size_bytes), .last = size_bytes - 1}};
}

}  // namespace biteline::web
