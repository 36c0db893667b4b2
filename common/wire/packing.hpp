// SPDX-License-Identifier: MIT
#pragma once
/// \file Lossless packing of number columns: differences between neighbours, as few bytes each as they need.
///
/// Neighbouring stripe points are alike, so the difference of their bit patterns is small: zigzag of the
/// difference modulo 2^32, then a two-bit length and the low bytes (the scheme of D. Lemire, N. Kurz, C.
/// Rupp, "Stream VByte: Faster byte-oriented integer compression", 2018, section 3).  Every bit pattern, NaN
/// included, comes back as it was.

#include <cstdint>
#include <span>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::wire {

/// Bytes per two-bit length code.
enum class Lengths : std::uint8_t {
  Dense,   ///< 1, 2, 3, 4 bytes: numbers that always differ a little (measurements)
  Sparse,  ///< 0, 1, 2, 4 bytes: numbers that mostly equal their prediction (flags, column numbers)
};

/// Appends the packed form of `values`.  Each is predicted as its predecessor plus `step` (the first from 0).
void pack(std::span<const std::uint32_t> values, Lengths lengths, std::uint32_t step,
          std::vector<std::uint8_t>& out);

/// Unpacks exactly `values.size()` numbers; Errc::Truncated or BadFormat unless `packed` is exactly their
/// packed form's length.  Never reads beyond `packed`.
[[nodiscard]] Result<void> unpack(std::span<const std::uint8_t> packed, Lengths lengths, std::uint32_t step,
                                  std::span<std::uint32_t> values);

}  // namespace biteline::wire
