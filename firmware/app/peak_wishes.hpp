// SPDX-License-Identifier: MIT
#pragma once
/// \file How stripes are found: what was told of it, by whom, and what comes of it.

#include <optional>

#include "common/core/result.hpp"
#include "common/session/recording_facts.hpp"
#include "common/settings/settings.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"

namespace biteline::sensor {

/// What was told of how a stripe is found; the rest is as recorded, or by default.
struct PeakWishes {
  std::optional<stripe::PeakMode> mode;
  std::optional<stripe::PeakChoice> choice;
  std::optional<float> threshold_grey, width_min_px, width_max_px;
};

/// The defaults, a recording's own settings over them, and over these what was told.
[[nodiscard]] Result<pipeline::ProfilePipeline::Config> pipeline_config(
    const PeakWishes& wishes, const std::optional<session::RecordingFacts>& recorded);

/// What was told, and beneath it what the set says.
[[nodiscard]] PeakWishes put_over(const PeakWishes& told, const settings::SettingsSet& set);

/// Into the set of what is in use.
void put_into(settings::SettingsSet& set, const pipeline::ProfilePipeline::Config& config);

}  // namespace biteline::sensor
