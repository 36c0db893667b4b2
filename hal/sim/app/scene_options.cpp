// SPDX-License-Identifier: MIT
#include "common/options/number.hpp"
#include "hal/sim/app/command.hpp"

namespace biteline::cell {

void add_scene_options(CLI::App& command, SceneOptions& options) {
  std::string classes;
  for (const auto name : sim::k_shoe_class_names)
    classes += (classes.empty() ? "" : ", ") + std::string(name);
  command.add_option("--seed", options.seed, "Which shoe of its class; the same seed makes the same shoe")
      ->capture_default_str();
  command.add_option("--shoe", options.shoe, "Class of shoe: " + classes)->capture_default_str();
  command.add_option("--head", options.head, "Which head: its true calibration is drawn from this seed")
      ->capture_default_str();
  command.add_option("--place", options.place, "Where the shoe stands, by seed; 0: as the shoe's seed")
      ->capture_default_str();
  command.add_flag("--upper", options.upper,
                   "The same shoe's upper before it gets a sole; its line is the sample's");
  command
      .add_option("--last-difference-mm", options.last_difference_mm,
                  "How far that upper's last differs, root mean square")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 2}, "mm"));
  command.add_option("--speed-mm-s", options.speed_mm_s, "Of the stripe along the outline")
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""));
  command
      .add_option("--ambient-grey", options.ambient_grey, "Grey levels of the room's light in the pictures")
      ->check(options::number({.minimum = 0.0, .maximum = 200.0}, ""))
      ->capture_default_str();
  command.add_option("--rate-hz", options.rate_hz, "Pictures a second")
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""));
}

Result<sim::SceneSettings> scene_settings(const SceneOptions& options) {
  const auto shoe_class = sim::shoe_class_named(options.shoe);
  if (!shoe_class)
    return fail(Errc::InvalidArgument, "--shoe %s: no such class (see --help)", options.shoe.c_str());
  sim::SceneSettings settings{.shoe = sim::draw_shoe(*shoe_class, options.seed),
                              .place_seed = options.place == 0 ? options.seed : options.place,
                              .head_seed = options.head,
                              .scan_speed_mm_s = options.speed_mm_s,
                              .rate_hz = options.rate_hz,
                              .ambient_grey = options.ambient_grey};
  if (options.upper) {
    settings.shoe = sim::bare_upper_of(settings.shoe, options.last_difference_mm, settings.place_seed);
  }
  return settings;
}

}  // namespace biteline::cell
