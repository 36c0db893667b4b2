// SPDX-License-Identifier: MIT
#pragma once
/// \file Within the centre's side of releases: how a release's cells stand.

#include <pqxx/pqxx>
#include <string>
#include <vector>

#include "host/fleet/releases.hpp"

namespace biteline::fleet {

/// Two that plan at once do so one after the other.
inline constexpr const char* k_release_lock = "SELECT pg_advisory_xact_lock(7119)";

[[nodiscard]] std::vector<ReleaseCell> cells_of(pqxx::work& work, std::int64_t release,
                                                const std::string& sha256);

}  // namespace biteline::fleet
