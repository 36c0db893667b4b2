// SPDX-License-Identifier: MIT
#pragma once
/// \file What goes between centre and cells about releases.  Texts are JSON; a part is one line of it, then
/// bytes.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::fleet {

inline constexpr const char* k_all_release_words = "biteline/1/cells/+/release";
inline constexpr const char* k_all_asks = "biteline/1/cells/+/ask";
/// Of a file, in one message; what the broker takes in one is 65536.
inline constexpr std::size_t k_part_bytes = 48 * 1024;
/// Asked for at once.
inline constexpr int k_parts_at_once = 8;

/// Centre to cell: which release it is to have, and when which one begins.
struct ReleasePlan {
  std::string manifest;   ///< signed text; empty: none is wanted
  std::string signature;  ///< 64 bytes, hexadecimal on the way
  struct Switch {
    std::string order;      ///< signed text (host/records/release/order.hpp)
    std::string signature;  ///< as above
    bool sure{false};       ///< all cells have said that they know
  };
  std::optional<Switch> turn{};
};
[[nodiscard]] std::string to_text(const ReleasePlan& plan);
[[nodiscard]] Result<ReleasePlan> read_release_plan(std::string_view text);

/// Cell to centre: what it has.
struct ReleaseWord {
  std::vector<std::string> has;  ///< SHA-256 of whole, checked releases, at most 16
  std::string current;           ///< in force now; empty: the cell's own files
  std::int64_t number{0};        ///< of the switch that stands in its plan
  std::int64_t newest{0};        ///< of all orders that stood there
  std::int64_t refused{0};       ///< the order that is told now, where it is not followed; 0: none
  std::string fault;             ///< why it does not have what is wanted; empty: none
  std::int64_t clock_ms{0};      ///< its own, when it said this
};
[[nodiscard]] std::string to_text(const ReleaseWord& word);
[[nodiscard]] Result<ReleaseWord> read_release_word(std::string_view text);

/// Cell to centre: bytes from `at` on, at most k_parts_at_once parts of them.
struct PartAsk {
  std::string sha256;
  std::int64_t at{0};
};
[[nodiscard]] std::string to_text(const PartAsk& ask);
[[nodiscard]] Result<PartAsk> read_part_ask(std::string_view text);

struct Part {
  std::string sha256;
  std::int64_t at{0};
  std::string bytes;  ///< at most k_part_bytes
};
[[nodiscard]] std::string to_payload(const Part& part);
[[nodiscard]] Result<Part> read_part(std::string_view payload);

}  // namespace biteline::fleet
