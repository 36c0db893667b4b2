// SPDX-License-Identifier: MIT
#pragma once
/// \file A tar file's headers (POSIX.1-1988, ustar), as this room writes and reads them.

#include <array>
#include <cstdint>
#include <string>

namespace biteline::archive::tar {

inline constexpr std::size_t k_block = 512;
using Block = std::array<char, k_block>;

/// The fields of a header by their place.
struct Field {
  std::size_t at, bytes;
};
inline constexpr Field k_name{0, 100}, k_mode{100, 8}, k_owner{108, 8}, k_group{116, 8}, k_size{124, 12},
    k_time{136, 12}, k_sum{148, 8}, k_kind{156, 1}, k_magic{257, 8};

/// No part that leads out, hides, or means something to a shell or a terminal.
[[nodiscard]] bool good_name(const std::string& name);
/// Over all bytes, its own field taken as blanks.
[[nodiscard]] std::uint64_t sum_of(Block block);
/// Of a plain file; no owner and no time, so that the same file has the same header.
[[nodiscard]] Block header_of(const std::string& name, std::uint64_t bytes);

}  // namespace biteline::archive::tar
