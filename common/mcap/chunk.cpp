// SPDX-License-Identifier: MIT
#include "common/mcap/chunk.hpp"

#include <zstd.h>

namespace biteline::mcap {
namespace {

/// Fast; profiles are packed already and pictures do not get smaller.
constexpr int k_level = 1;

}  // namespace

bool pack_zstd(View bytes, Bytes& out) {
  out.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), k_level);
  if (ZSTD_isError(size) != 0 || size >= bytes.size()) return false;
  out.resize(size);
  return true;
}

Result<Bytes> unpack(const Chunk& chunk) {
  if (chunk.uncompressed_bytes > k_most_chunk_bytes) {
    return fail(Errc::BadFormat, "a chunk of %llu bytes; at most %llu are read",
                static_cast<unsigned long long>(chunk.uncompressed_bytes),
                static_cast<unsigned long long>(k_most_chunk_bytes));
  }
  Bytes out;
  if (chunk.compression.empty()) {
    out.assign(chunk.records.begin(), chunk.records.end());
  } else if (chunk.compression == "zstd") {
    out.resize(static_cast<std::size_t>(chunk.uncompressed_bytes));
    const std::size_t size =
        ZSTD_decompress(out.data(), out.size(), chunk.records.data(), chunk.records.size());
    if (ZSTD_isError(size) != 0) return fail(Errc::BadFormat, "a chunk whose zstd data are damaged");
    out.resize(size);
  } else {
    return fail(Errc::NotSupported, "compression '%.20s': zstd or none expected", chunk.compression.c_str());
  }
  if (out.size() != chunk.uncompressed_bytes) {
    return fail(Errc::BadFormat, "a chunk that has another size than it says");
  }
  if (chunk.uncompressed_crc != 0 && crc32(out) != chunk.uncompressed_crc) {
    return fail(Errc::BadFormat, "a chunk whose check sum differs");
  }
  return out;
}

Result<void> for_each_record(
    View records,
    const std::function<Result<void>(std::uint8_t opcode, View content, std::uint64_t at)>& take) {
  std::size_t at = 0;
  while (at < records.size()) {
    const View left = records.subspan(at);
    std::uint64_t size = 0;
    if (left.size() >= k_record_head_bytes) {
      for (std::size_t i = 0; i < 8; ++i) size |= std::uint64_t{left[1 + i]} << (8 * i);
    }
    if (left.size() < k_record_head_bytes || size > left.size() - k_record_head_bytes) {
      return fail(Errc::BadFormat, "a record that goes beyond its end");
    }
    const auto bytes = static_cast<std::size_t>(size);
    BITELINE_TRY(take(left[0], left.subspan(k_record_head_bytes, bytes), at));
    at += k_record_head_bytes + bytes;
  }
  return {};
}

}  // namespace biteline::mcap
