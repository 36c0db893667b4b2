// SPDX-License-Identifier: MIT
#pragma once
/// \file The messages of refused scans stay for whoever asks why, within bounds.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace biteline::service {

/// Some hundred scans of a shoe.
inline constexpr double k_default_refused_gb = 2.0;

/// Which scans' messages go so that those of the others have at most `most_bytes`: the oldest first, by the
/// number in the folder's name, and never the newest.  `may_go`: of a scan by its folder's name; it was
/// refused, is not marked, and nobody has to decide about it any more.
[[nodiscard]] std::vector<std::filesystem::path> messages_to_go(
    const std::filesystem::path& folder, std::uint64_t most_bytes,
    const std::function<bool(const std::string&)>& may_go);

}  // namespace biteline::service
