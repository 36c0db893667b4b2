// SPDX-License-Identifier: MIT
#include "hal/sim/app/world_options.hpp"

#include <cmath>

#include "common/options/command.hpp"
#include "hal/sim/record/surroundings.hpp"

namespace biteline::cell {

void add_world_options(options::Command& command, WorldOptions& options) {
  command
      .add_option(
          "--world", options.world,
          "real: elastic joints, a controller's following error and latency, motion blur, speckle that "
          "stays on the surface, table, fixture, flickering lamps; ideal: none of these")
      ->check(options::one_of({"ideal", "real"}))
      ->capture_default_str();
  command.add_option("--elastic-hz", options.elastic_hz, "Own frequency of the softest joint; 0: stiff")
      ->check(options::number({.minimum = 0, .maximum = 60}, "Hz"));
  command
      .add_option("--unseen-ratio", options.unseen_ratio,
                  "Share of the arm's give that its encoders do not see")
      ->check(options::number({.minimum = 0, .maximum = 1}, ""));
  // JointDynamics' steps are too coarse for less than 1.4 ms: the drives would swing up.
  command.add_option("--following-ms", options.following_ms, "The drives' lag behind their target; 0: none")
      ->check(options::one_of_numbers({0.0}) | options::number({.minimum = 2, .maximum = 200}, "ms"));
  command
      .add_option("--latency-ms", options.latency_ms,
                  "From the controller's target to the drives, rounded to whole ones")
      ->check(options::number({.minimum = 0, .maximum = 200}, "ms"));
}

sim::Disturbances disturbances_of(const WorldOptions& options) {
  sim::Disturbances disturbances;
  if (options.world == "real") disturbances = sim::common_disturbances();
  sim::ArmDynamics& arm = disturbances.arm;
  arm.elastic_hz = options.elastic_hz.value_or(arm.elastic_hz);
  arm.unseen_ratio = options.unseen_ratio.value_or(arm.unseen_ratio);
  if (options.following_ms) arm.following_s = 1e-3 * *options.following_ms;
  if (options.latency_ms) arm.latency = Nanoseconds{1'000'000 * std::llround(*options.latency_ms)};
  return disturbances;
}

void set_surroundings(sim::SceneSettings& scene, const WorldOptions& options) {
  if (options.world != "real") return;
  scene.surroundings = true;
  if (scene.ambient_grey <= 0) scene.ambient_grey = sim::k_hall_grey;
}

}  // namespace biteline::cell
