// SPDX-License-Identifier: MIT
#pragma once
/// \file What noise a head will have, and what another lens, speed or laser would give, in words.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/optics/stripe_noise.hpp"
#include "common/options/command.hpp"

namespace biteline::app {

/// One head and its forecast.
struct LightChoice {
  std::string what;
  optics::ScanLight light;
  optics::StripeNoise noise;
};

/// The head itself first, then one change each: stops, speeds, half and twice the laser, a sheet half as
/// thick, blue light.
[[nodiscard]] std::vector<LightChoice> light_choices(const optics::ScanLight& light);

/// What limits it, and the one change of light_choices() that helps most, in a sentence each.
[[nodiscard]] std::string light_advice(const std::vector<LightChoice>& choices);

/// What the command line says of it.
struct LightQuestion {
  bool asked{false};
  optics::ScanLight light{};
  std::filesystem::path sensor, report;  ///< a sensor.yaml and a scan's report.json; empty: none
};
void add_light_options(options::Command& command, LightQuestion& question);

/// Contrasts of speckle that were measured; nothing where the files do not tell them.
struct MeasuredLight {
  std::optional<double> calibrated;  ///< at rest, of sensor.yaml
  std::optional<double> scanned;     ///< median of a scan, of report.json
};
[[nodiscard]] Result<MeasuredLight> read_measured_light(const LightQuestion& question);
/// What was measured beside what is forecast, and what to look at where they disagree; empty: nothing was.
[[nodiscard]] std::string measured_words(const MeasuredLight& measured, const optics::StripeNoise& forecast);

void print_light(const std::vector<LightChoice>& choices, const MeasuredLight& measured);
[[nodiscard]] nlohmann::ordered_json light_json(const std::vector<LightChoice>& choices,
                                                const MeasuredLight& measured);

}  // namespace biteline::app
