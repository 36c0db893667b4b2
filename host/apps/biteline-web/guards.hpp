// SPDX-License-Identifier: MIT
#pragma once
/// \file What a request is judged by before anything is done with it: pure functions over its texts.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace biteline::web {

/// A path without its query, decoded.  Nothing: a bad escape, a NUL or control character, a backslash, an
/// empty, `.` or `..` part, or no leading slash.
[[nodiscard]] std::optional<std::string> decode_path(std::string_view path);

/// `a=b&c=d`, decoded; nothing where an escape is bad, a name comes twice, or there are more than 32.
[[nodiscard]] std::optional<std::map<std::string, std::string>> decode_query(std::string_view query);

/// The value of one cookie of a Cookie header; empty when it is not there.
[[nodiscard]] std::string cookie_value(std::string_view header, std::string_view name);

/// Of `Authorization: Bearer TOKEN`; empty when it is something else.
[[nodiscard]] std::string bearer_token(std::string_view header);

/// A token as the service makes them: 1 to 128 letters of base64url.  Others are not passed on.
[[nodiscard]] bool is_token(std::string_view text);

/// The Host header without its port, in lower case.  Empty: unreadable.
[[nodiscard]] std::string host_name(std::string_view host);

/// `host` (a Host header) is one of `names`; a page of another name that was made to lead here (DNS
/// rebinding) is not.
[[nodiscard]] bool host_allowed(std::string_view host, const std::vector<std::string>& names);

struct OriginFacts {
  std::string_view origin;      ///< Origin header; empty: none
  std::string_view fetch_site;  ///< Sec-Fetch-Site header; empty: none
  std::string_view host;        ///< Host header
  bool tls{false};
};
/// Not sent by a page of another origin.  Programs send neither header.
[[nodiscard]] bool origin_allowed(const OriginFacts& facts);

/// First and last byte, both included.
struct ByteRange {
  std::uint64_t first{0};
  std::uint64_t last{0};
};
enum class RangeKind { Whole, Part, Refused };
struct RangeAnswer {
  RangeKind kind{RangeKind::Whole};
  ByteRange range;
};
/// A Range header against a file's size.  More than one range is answered with the whole (RFC 9110, 14.2).
[[nodiscard]] RangeAnswer read_range(std::string_view header, std::uint64_t size_bytes);

}  // namespace biteline::web
