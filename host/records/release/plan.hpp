// SPDX-License-Identifier: MIT
#pragma once
/// \file Which release is in force at a cell, and from when on another one will be.
///
/// One small file, written beside and renamed.  Whoever works a scan reads it once: the moment of a switch
/// needs no program to run then, and whoever is killed leaves the old plan or the new one.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::release {

inline constexpr const char* k_plan_file = "plan";

/// Hashes are SHA-256; empty: none.
struct Plan {
  std::string current;
  std::string before;      ///< in force before `current`; kept, so that the way back is short
  std::string next;        ///< in force from `at_ms` on, if `sure`
  std::int64_t at_ms{0};   ///< since 1970, UTC, by this machine's clock
  bool sure{false};        ///< every cell has the next one and knows the time
  std::int64_t number{0};  ///< of the switch that made `next`, else `current`; 0: none, or not known any more
  std::int64_t newest{0};  ///< of all orders that stood here; it never falls, so none comes twice
  std::string order;       ///< SHA-256 of that order's text

  /// The release that a scan is worked with that begins now.
  [[nodiscard]] const std::string& in_force(std::int64_t now_ms) const {
    return !next.empty() && sure && now_ms >= at_ms ? next : current;
  }
  /// The same plan once its time has come.
  [[nodiscard]] Plan settled(std::int64_t now_ms) const;
  bool operator==(const Plan&) const = default;
};

[[nodiscard]] std::string to_text(const Plan& plan);
[[nodiscard]] Result<Plan> read_plan(std::string_view text);
/// Of the folder of releases; an empty plan where there is none yet.
[[nodiscard]] Result<Plan> plan_of(const std::filesystem::path& folder);

}  // namespace biteline::release
