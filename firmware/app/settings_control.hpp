// SPDX-License-Identifier: MIT
#pragma once
/// \file The settings that a sensor runs with, and how a host puts others in their place.

#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/settings/settings.hpp"
#include "common/wire/messages.hpp"
#include "firmware/app/peak_wishes.hpp"
#include "firmware/app/scanner.hpp"
#include "firmware/app/source.hpp"

namespace biteline::sensor {

/// What the command line says; it stays above every set.
struct Told {
  Capture capture;
  PeakWishes peaks;
};

/// A set takes effect as a whole or not at all: it is checked first, then told to the camera and read back,
/// and kept only when the camera took it.
///
/// | key                        | between scans | while a scan is on                                |
/// |----------------------------|---------------|---------------------------------------------------|
/// | camera.exposure_us         | yes           | at once; not beside automatic or second exposures |
/// | peaks.*                    | yes           | at once                                           |
/// | all others                 | yes           | refused by name                                   |
///
/// Thread: one owner (the stream thread).
class SettingsControl {
 public:
  /// Both are kept up to date.
  SettingsControl(SourceKind& kind, pipeline::ProfilePipeline::Config& pipeline, Told told);

  /// Between scans; takes as long as the camera takes to be opened and told, some hundred ms.
  [[nodiscard]] Result<void> use(const std::string& text);

  /// Hands it to a running scan, which takes it between two frames.
  [[nodiscard]] Result<void> offer(const std::string& text, Scanner& scanner);
  [[nodiscard]] bool offered() const { return offered_.has_value(); }
  /// What the scan said of the offered one.
  [[nodiscard]] Result<void> finish(const Result<Scanner::Changed>& changed);

  /// The camera was told anew.
  void refresh();
  /// Whole, as a file that `--settings` takes.
  [[nodiscard]] const wire::SettingsState& state() const { return state_; }

 private:
  struct Prepared {
    settings::SettingsSet set;    ///< as told
    settings::SettingsSet whole;  ///< what comes of it with the command line, the head and the defaults
    geometry::SensorModel model;
    Capture capture;
    pipeline::ProfilePipeline::Config pipeline;
  };
  [[nodiscard]] Result<Prepared> prepare(const std::string& text) const;
  [[nodiscard]] settings::SettingsSet whole_of(const Prepared& prepared) const;
  [[nodiscard]] Result<void> check_changes(const Prepared& next, const Scanner& scanner) const;
  void keep(Prepared next);

  SourceKind& kind_;
  pipeline::ProfilePipeline::Config& pipeline_;
  Told told_;
  settings::SettingsSet asked_;  ///< `whole` of what is in use
  std::optional<Prepared> offered_;
  wire::SettingsState state_;
};

}  // namespace biteline::sensor
