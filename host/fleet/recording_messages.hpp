// SPDX-License-Identifier: MIT
#pragma once
/// \file What goes between centre and cells about recordings: a JSON text, or one line of it and then bytes.

#include <cstdint>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

namespace biteline::fleet {

inline constexpr const char* k_all_recordings = "biteline/1/cells/+/recording";
/// In one message; what the broker takes in one is 65536.
inline constexpr std::size_t k_piece_bytes = 48 * 1024;
/// For each ask, at most.
inline constexpr int k_pieces_an_ask = 8;
/// Of one recording.
inline constexpr std::uint64_t k_most_recording_bytes = 64ULL << 30U;

/// "scan-" and 4 to 9 digits: it names a folder.
[[nodiscard]] bool is_scan_folder(std::string_view name);
/// A memory's name: 1 to 64 letters or digits.
[[nodiscard]] bool is_book(std::string_view name);

/// Centre to cell: the recording of this scan, from this byte on.
struct FetchAsk {
  std::int64_t number{0};  ///< of the fetch
  std::string book, scan;
  std::int64_t at{0};
};
[[nodiscard]] std::string to_text(const FetchAsk& ask);
[[nodiscard]] Result<FetchAsk> read_fetch_ask(std::string_view text);

/// Cell to centre.
struct Piece {
  std::int64_t number{0};
  std::int64_t at{0};
  std::int64_t total{0};  ///< bytes of the whole
  std::string sha256;     ///< of the whole
  std::string refused;    ///< why it cannot be had; empty: it can
  std::string bytes;      ///< at most k_piece_bytes
};
[[nodiscard]] std::string to_payload(const Piece& piece);
[[nodiscard]] Result<Piece> read_piece(std::string_view payload);

}  // namespace biteline::fleet
