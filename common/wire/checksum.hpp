// SPDX-License-Identifier: MIT
#pragma once
/// \file CRC-32C (Castagnoli; RFC 3720, appendix B.4): finds what a network card, a cable or a bug changed.
///
/// TCP's own 16-bit sum lets about one in 65536 damaged packets pass.  It is no protection against intent:
/// CurveZMQ is.

#include <cstdint>
#include <span>

namespace biteline::wire {

[[nodiscard]] std::uint32_t crc32c(std::span<const std::uint8_t> bytes);

}  // namespace biteline::wire
