// SPDX-License-Identifier: MIT
#include "firmware/app/peak_wishes.hpp"

#include "common/stripe/peak_names.hpp"

namespace biteline::sensor {

PeakWishes put_over(const PeakWishes& told, const settings::SettingsSet& set) {
  using settings::Key;
  PeakWishes wishes = told;
  const auto number = [&](std::optional<float>& wish, Key key) {
    if (const auto value = set.number(key); value && !wish) wish = static_cast<float>(*value);
  };
  if (const auto mode = set.word(Key::PeakMode); mode && !wishes.mode)
    wishes.mode = stripe::k_peak_modes.at(*mode);
  if (const auto choice = set.word(Key::PeakChoice); choice && !wishes.choice)
    wishes.choice = stripe::k_peak_choices.at(*choice);
  number(wishes.threshold_grey, Key::PeakThreshold);
  number(wishes.width_min_px, Key::PeakWidthMin);
  number(wishes.width_max_px, Key::PeakWidthMax);
  return wishes;
}

Result<pipeline::ProfilePipeline::Config> pipeline_config(
    const PeakWishes& wishes, const std::optional<session::RecordingFacts>& recorded) {
  pipeline::ProfilePipeline::Config config;
  if (recorded) {
    const auto mode = stripe::k_peak_modes.find(recorded->peak_mode);
    const auto choice = stripe::k_peak_choices.find(recorded->peak_choice);
    if (mode == stripe::k_peak_modes.end() || choice == stripe::k_peak_choices.end()) {
      return fail(Errc::BadValue, "recording.yaml: peaks: mode '%s' or choice '%s' is not known",
                  recorded->peak_mode.c_str(), recorded->peak_choice.c_str());
    }
    config.peaks.mode = mode->second;
    config.selector.choice = choice->second;
    config.peaks.threshold_grey = static_cast<float>(recorded->peak_threshold_grey);
    config.peaks.width_min_px = static_cast<float>(recorded->peak_width_min_px);
    config.peaks.width_max_px = static_cast<float>(recorded->peak_width_max_px);
  }
  config.peaks.mode = wishes.mode.value_or(config.peaks.mode);
  config.selector.choice = wishes.choice.value_or(config.selector.choice);
  config.peaks.threshold_grey = wishes.threshold_grey.value_or(config.peaks.threshold_grey);
  config.peaks.width_min_px = wishes.width_min_px.value_or(config.peaks.width_min_px);
  config.peaks.width_max_px = wishes.width_max_px.value_or(config.peaks.width_max_px);
  return config;
}

void put_into(settings::SettingsSet& set, const pipeline::ProfilePipeline::Config& config) {
  using settings::Key;
  const auto number = [&](Key key, float value) { set.set(key, {.number = static_cast<double>(value)}); };
  set.set(Key::PeakMode, {.word = stripe::name_of(stripe::k_peak_modes, config.peaks.mode)});
  set.set(Key::PeakChoice, {.word = stripe::name_of(stripe::k_peak_choices, config.selector.choice)});
  number(Key::PeakThreshold, config.peaks.threshold_grey);
  number(Key::PeakWidthMin, config.peaks.width_min_px);
  number(Key::PeakWidthMax, config.peaks.width_max_px);
}

}  // namespace biteline::sensor
