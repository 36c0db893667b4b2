// SPDX-License-Identifier: MIT
#pragma once
/// \file Bytes as text: base64 of RFC 4648, with padding.

#include <optional>
#include <string>
#include <string_view>

namespace biteline {

[[nodiscard]] std::string to_base64(std::string_view bytes);

/// Nothing where `text` is not what to_base64() writes: other letters, no padding, bits behind the last byte.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

}  // namespace biteline
