// SPDX-License-Identifier: MIT
#pragma once
/// \file The options that say how real the simulated cell is.

#include <optional>
#include <string>

#include "common/options/command.hpp"
#include "hal/sim/record/disturbances.hpp"
#include "hal/sim/record/made_scene.hpp"

namespace biteline::cell {

/// What is named beside the world counts instead of the world's own.
struct WorldOptions {
  std::string world{"ideal"};
  std::optional<double> elastic_hz{}, unseen_ratio{}, following_ms{}, latency_ms{};
};

void add_world_options(options::Command& command, WorldOptions& options);
[[nodiscard]] sim::Disturbances disturbances_of(const WorldOptions& options);
/// Table, fixture and the hall's light, where the world has them.
void set_surroundings(sim::SceneSettings& scene, const WorldOptions& options);

}  // namespace biteline::cell
