// SPDX-License-Identifier: MIT
#pragma once
/// \file scan.btln: a scan's messages as they went over the wire, one after the other.
///
/// File: "BTLNSCAN", then records of a 32-bit little-endian length and a message (with its own checksum), the
/// sensor's hello first.  Only ever appended to, so that what is there before a cut is good.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "common/core/result.hpp"
#include "common/wire/messages.hpp"

namespace biteline::wire {

inline constexpr std::string_view k_scan_file_magic = "BTLNSCAN";

/// Replaces `out` by the message with its length in front.
void make_scan_record(std::span<const std::uint8_t> message, Bytes& out);

struct ScanFileEnd {
  std::uint64_t messages{0};
  std::uint64_t bytes_left{0};  ///< behind the last whole message: cut or damaged
};

/// Hands out every whole message in order, as decoded and as its bytes; changes nothing.  An Error of
/// `on_message` ends it.  Errc::BadFormat when the file is no scan's or does not begin with a hello.
[[nodiscard]] Result<ScanFileEnd> read_scan_file(
    const std::filesystem::path& file,
    const std::function<Result<void>(Message message, std::span<const std::uint8_t> bytes)>& on_message);

}  // namespace biteline::wire
