// SPDX-License-Identifier: MIT
#pragma once
/// \file The subcommands of biteline-cell.

#include <functional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/options/command.hpp"
#include "hal/sim/record/made_scene.hpp"

namespace biteline::cell {

/// What the chosen subcommand does once everything is parsed.
struct Context {
  std::function<Result<void>()> run;
};

/// The options that choose a head's lens and laser, the same for every subcommand that makes pictures.
struct LightOptions {
  sim::HeadLight light{};
  std::string source{"laser"};

  [[nodiscard]] sim::HeadLight chosen() const;
};

/// The options that choose a scene, the same for every subcommand.
struct SceneOptions {
  std::uint64_t seed{1};
  std::string shoe{"deep"};
  std::string decoy{};  ///< empty: the seed draws one for a designed sole
  bool one_colour{false};
  bool painted{false};
  double size{0};  ///< European; 0: as the class draws it
  bool straight_holder{true};
  std::uint64_t head{21};
  std::uint64_t place{0};  ///< 0: the shoe's seed
  bool upper{false};
  double last_difference_mm{0.15};
  double speed_mm_s{100};
  double rate_hz{100};
  double ambient_grey{0};
  LightOptions light{};
  double scan_begin_ratio{0};  ///< of the way round, from the heel, anticlockwise
  bool scan_clockwise{false};
  double check_lap_mm{0};  ///< the scan's ends overlap by so much, differently held; 0: they do not
  std::string work{};      ///< what was done to the shoe; empty: nothing
  std::vector<double> work_band_mm{2, 10};  ///< from the line, its low edge and its high one
  std::vector<double> work_gap_mm{};        ///< middle along the outline, length
  std::string reach_of{};  ///< an arm: the shoe stands where it gets all the way round; empty: anywhere
};

void add_scene_options(options::Command& command, SceneOptions& options);
/// Of what goes round the shoe.
void add_way_round_options(options::Command& command, SceneOptions& options);
/// Of the head's lens and laser: what speckle they make.
void add_light_options(options::Command& command, LightOptions& options);
/// What a process did before the scan.  Of recordings alone, too.
void add_work_options(options::Command& command, SceneOptions& options);
/// Of recordings alone: a live cell has its own arm and says how the head hangs on it.
void add_reach_option(options::Command& command, SceneOptions& options);
[[nodiscard]] Result<sim::SceneSettings> scene_settings(const SceneOptions& options);

void add_record(options::Command& app, Context& context);
void add_record_calibration(options::Command& app, Context& context);
void add_record_cloud(options::Command& app, Context& context);
void add_serve(options::Command& app, Context& context);

}  // namespace biteline::cell
