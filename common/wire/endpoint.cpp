// SPDX-License-Identifier: MIT
#include "common/wire/endpoint.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace biteline::wire {
namespace {

constexpr std::string_view k_scheme = "tcp://";

/// Four numbers below 256, the first 127: 127.0.0.0/8 (RFC 1122, 3.2.1.3).  "127.evil.example" is a name.
bool is_loopback_ipv4(std::string_view host) {
  int parts = 0;
  bool first_is_127 = false;
  while (true) {
    const std::size_t dot = std::min(host.find('.'), host.size());
    unsigned value = 256;
    const auto [end, error] = std::from_chars(host.data(), host.data() + dot, value);
    if (error != std::errc{} || end != host.data() + dot || value > 255) return false;
    if (parts == 0) first_is_127 = value == 127;
    ++parts;
    if (dot == host.size()) return parts == 4 && first_is_127;
    host.remove_prefix(dot + 1);
  }
}

}  // namespace

bool Endpoint::loopback() const {
  return host == "localhost" || host == "[::1]" || is_loopback_ipv4(host);
}

std::string Endpoint::text() const {
  return std::string{k_scheme} + host + ":" + std::to_string(port);
}

Result<Endpoint> parse_endpoint(const std::string& text) {
  const auto bad = [&] {
    return fail(Errc::InvalidArgument, "address '%s': tcp://HOST:PORT expected", text.c_str());
  };
  const std::string_view whole{text};
  const std::size_t colon = whole.rfind(':');
  if (!whole.starts_with(k_scheme) || colon == std::string_view::npos || colon <= k_scheme.size())
    return bad();
  const std::string_view host = whole.substr(k_scheme.size(), colon - k_scheme.size());
  const std::string_view port_text = whole.substr(colon + 1);
  Endpoint endpoint{.host = std::string{host}, .port = 0};
  const auto [end, error] =
      std::from_chars(port_text.data(), port_text.data() + port_text.size(), endpoint.port);
  if (error != std::errc{} || end != port_text.data() + port_text.size()) return bad();
  const bool bracketed = host.front() == '[' && host.back() == ']';
  const bool plain = std::all_of(host.begin(), host.end(), [](char letter) {
    return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
           (letter >= 'A' && letter <= 'Z') || letter == '.' || letter == '-' || letter == '_' ||
           letter == '*';
  });
  if (!bracketed && !plain) return bad();
  return endpoint;
}

}  // namespace biteline::wire
