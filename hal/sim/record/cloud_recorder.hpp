// SPDX-License-Identifier: MIT
#pragma once
/// \file A made scan as a finished cloud, without pictures: some hundred times faster than a session.

#include <filesystem>

#include "hal/sim/record/made_scene.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"

namespace biteline::sim {

/// FOLDER/cloud.ply in scan order, with truth/groove.csv (none for a shoe without line) and
/// truth/T_base_shoe.txt.  Same arguments, same files.  Of the scene only shoe, place and places are used.
[[nodiscard]] Result<void> record_cloud(const std::filesystem::path& folder, const SceneSettings& scene,
                                        const ScanSettings& scan);

}  // namespace biteline::sim
