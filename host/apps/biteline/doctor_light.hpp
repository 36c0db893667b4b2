// SPDX-License-Identifier: MIT
#pragma once
/// \file What noise a head will have, and what another lens, speed or laser would give, in words.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/optics/stripe_noise.hpp"
#include "common/options/command.hpp"

namespace biteline::app {

/// One head and its forecast.
struct LightChoice {
  std::string what;
  optics::ScanLight light;
  optics::StripeNoise noise;
};

/// The head itself first, then one change each: stops, speeds, half and twice the laser, blue light.
[[nodiscard]] std::vector<LightChoice> light_choices(const optics::ScanLight& light);

/// What limits it, and the one change of light_choices() that helps most, in a sentence each.
[[nodiscard]] std::string light_advice(const std::vector<LightChoice>& choices);

/// What the command line says of it.
struct LightQuestion {
  bool asked{false};
  optics::ScanLight light{};
};
void add_light_options(options::Command& command, LightQuestion& question);

void print_light(const std::vector<LightChoice>& choices);
[[nodiscard]] nlohmann::ordered_json light_json(const std::vector<LightChoice>& choices);

}  // namespace biteline::app
