// SPDX-License-Identifier: MIT
#pragma once
/// \file stages/ of a transfer: how the sample lies on the upper, and what became of its line.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/core/result.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::results {

/// Writes into `folder` (made when missing), replacing an earlier run's files: 1_alignment, 2_placed_line,
/// 3_carried_line, each .png and .ply.  A refused transfer has those that it reached.  Pre: the upper's cloud
/// is not empty.
[[nodiscard]] Result<void> write_transfer_stages(const std::filesystem::path& folder,
                                                 const cloud::PointCloud& upper,
                                                 const transfer::Transfer& transfer);

/// The pictures that `folder` holds, in order: file name and what it shows.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> transfer_pictures(
    const std::filesystem::path& folder);

}  // namespace biteline::results
