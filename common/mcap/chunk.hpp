// SPDX-License-Identifier: MIT
#pragma once
/// \file A chunk's records: packed, unpacked, and one after the other.

#include <functional>

#include "common/mcap/records.hpp"

namespace biteline::mcap {

/// No chunk of more is unpacked, and no record of more is read: memory stays bounded.
inline constexpr std::uint64_t k_most_chunk_bytes = 64ULL << 20U;

enum class Compression : std::uint8_t { None, Zstd };

/// Replaces `out` by the packed bytes.  False: they would be no smaller (pictures, say) and stay as they are.
[[nodiscard]] bool pack_zstd(View bytes, Bytes& out);

/// The chunk's records.  Errc::BadFormat when size or check sum differ, NotSupported for another compression.
[[nodiscard]] Result<Bytes> unpack(const Chunk& chunk);

/// Hands out every record in `records`: opcode, content, and where it begins.  Errc::BadFormat when one goes
/// beyond the end.
[[nodiscard]] Result<void> for_each_record(
    View records,
    const std::function<Result<void>(std::uint8_t opcode, View content, std::uint64_t at)>& take);

}  // namespace biteline::mcap
