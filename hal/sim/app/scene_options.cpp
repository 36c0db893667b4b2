// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "common/options/command.hpp"
#include "hal/sim/app/command.hpp"
#include "hal/sim/shoe/designed_shoe.hpp"

namespace biteline::cell {

void add_scene_options(options::Command& command, SceneOptions& options) {
  std::string classes;
  for (const auto name : sim::k_shoe_class_names)
    classes += (classes.empty() ? "" : ", ") + std::string(name);
  command.add_option("--seed", options.seed, "Which shoe of its class; the same seed makes the same shoe")
      ->capture_default_str();
  command.add_option("--shoe", options.shoe, "Class of shoe: " + classes)->capture_default_str();
  std::string decoys;
  for (const auto name : sim::k_decoy_names) decoys += (decoys.empty() ? "" : ", ") + std::string(name);
  command.add_option("--decoy", options.decoy,
                     "What else runs round a designed sole (cupsole to wedge): " + decoys +
                         "; without it the seed draws one");
  command.add_flag("--one-colour", options.one_colour, "Sole and upper of a designed sole look the same");
  command.add_flag("--painted", options.painted,
                   "Ledges, tapes and overlays of a designed sole have colours of their own");
  command
      .add_option("--size", options.size,
                  "European size, 36 to 47 for grown-ups; 0: as long as the class draws it, a child's too")
      ->check(options::one_of_numbers({0.0}) | options::number({.minimum = 14, .maximum = 52}, ""))
      ->capture_default_str();
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
      .add_option("--check-lap", options.check_lap_mm,
                  "The scan's end and begin see the same wall over so much, with the head turned [mm]: a "
                  "drifted calibration shows; 50 is usual, which the ramps at 250 mm/s do anyway; 0: off")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 100}, "mm"));
  command
      .add_option("--ambient-grey", options.ambient_grey, "Grey levels of the room's light in the pictures")
      ->check(options::number({.minimum = 0.0, .maximum = 200.0}, ""))
      ->capture_default_str();
  command.add_option("--rate-hz", options.rate_hz, "Pictures a second")
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""));
}

sim::HeadLight LightOptions::chosen() const {
  sim::HeadLight chosen = light;
  chosen.coherent = source == "laser";
  return chosen;
}

void add_light_options(options::Command& command, LightOptions& options) {
  sim::HeadLight& light = options.light;
  command
      .add_option(
          "--f-number", light.f_number,
          "Of the head's lens: the smaller, the less speckle, and the less depth of field; the stripe "
          "stays as bright")
      ->check(options::number({.minimum = 2, .maximum = 22}, ""))
      ->capture_default_str();
  command.add_option("--wavelength-nm", light.wavelength_nm, "Of the head's laser")
      ->check(options::number({.minimum = 400, .maximum = 900}, "nm"))
      ->capture_default_str();
  command
      .add_option("--line-width-nm", light.line_width_nm,
                  "Of the laser's spectrum, full width at half height: rough and translucent surfaces have "
                  "less speckle in a wider one")
      ->check(options::number({.minimum = 0, .maximum = 20}, "nm"))
      ->capture_default_str();
  command
      .add_option("--light", options.source,
                  "laser: coherent, with speckle; lamp: a line of a lamp's light, without")
      ->check(options::one_of({"laser", "lamp"}))
      ->capture_default_str();
}

void add_way_round_options(options::Command& command, SceneOptions& options) {
  command
      .add_option(
          "--scan-begin", options.scan_begin_ratio,
          "Where on the way round the scan begins and ends, anticlockwise from the heel; 0.25: in the "
          "waist, where the wrist is slow")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 1}, ""));
  command.add_flag("--scan-clockwise,!--scan-anticlockwise", options.scan_clockwise,
                   "Which way round the arm takes the head, as seen from above: a path that goes "
                   "anticlockwise then turns the wrist back (default: anticlockwise)");
}

void add_work_options(options::Command& command, SceneOptions& options) {
  const std::vector<std::string> works{sim::k_work_names.begin(), sim::k_work_names.end()};
  options::Option* work =
      command
          .add_option("--work", options.work,
                      "The shoe was worked before: a band of film, or of ground surface, runs along its line")
          ->check(options::one_of(works));
  command
      .add_option("--work-band", options.work_band_mm,
                  "Its low and its high edge above the line, on the surface [mm]")
      ->check(options::number({.minimum = -20, .maximum = 30}, "mm"))
      ->expected(2)
      ->needs(work);
  command
      .add_option("--work-gap", options.work_gap_mm,
                  "A gap in it: its middle along the outline, and its length [mm]")
      ->check(options::number({.minimum = 0, .maximum = 2000}, "mm"))
      ->expected(2)
      ->needs(work);
}

void add_reach_option(options::Command& command, SceneOptions& options) {
  command
      .add_option("--within-reach-of", options.reach_of,
                  "The shoe stands where this arm gets all the way round: ur3e, ur5e or ur10e")
      ->check(options::one_of({"ur3e", "ur5e", "ur10e"}));
}

namespace {

Result<sim::ShoeParameters> shoe_of(const SceneOptions& options) {
  const auto shoe_class = sim::shoe_class_named(options.shoe);
  if (!shoe_class)
    return fail(Errc::InvalidArgument, "--shoe %s: no such class (see --help)", options.shoe.c_str());
  const auto length_mm =
      options.size > 0 ? std::optional(sim::length_of_size_mm(options.size)) : std::nullopt;
  if (options.decoy.empty() && !options.one_colour && !options.painted)
    return sim::draw_shoe(*shoe_class, options.seed, length_mm);
  if (!sim::is_designed(*shoe_class))
    return fail(Errc::InvalidArgument,
                "--shoe %s: only a designed sole takes --decoy, --one-colour and --painted",
                options.shoe.c_str());
  const auto decoy = sim::decoy_named(options.decoy.empty() ? "none" : options.decoy);
  if (!decoy)
    return fail(Errc::InvalidArgument, "--decoy %s: no such decoy (see --help)", options.decoy.c_str());
  return sim::draw_designed_shoe(
      {.shoe_class = *shoe_class,
       .decoy = *decoy,
       .materials = options.one_colour ? sim::Materials::OneColour : sim::Materials::Contrast,
       .painted = options.painted,
       .length_mm = length_mm},
      options.seed);
}

}  // namespace

Result<sim::SceneSettings> scene_settings(const SceneOptions& options) {
  BITELINE_ASSIGN(sim::ShoeParameters shoe, shoe_of(options));
  sim::SceneSettings settings{
      .shoe = std::move(shoe),
      .place_seed = options.place == 0 ? options.seed : options.place,
      .head_seed = options.head,
      .holder = options.straight_holder ? sim::Holder::Straight : sim::Holder::Bracket,
      .scan_speed_mm_s = options.speed_mm_s,
      .scan_begin_ratio = options.scan_begin_ratio,
      .scan_clockwise = options.scan_clockwise,
      .rate_hz = options.rate_hz,
      .ambient_grey = options.ambient_grey,
      .light = options.light.chosen(),
      .check = {.length_mm = options.check_lap_mm}};
  if (!options.reach_of.empty()) settings.places = sim::places_within_reach_of(options.reach_of);
  if (options.upper) {
    settings.shoe = sim::bare_upper_of(settings.shoe, options.last_difference_mm, settings.place_seed);
  }
  if (!options.work.empty()) {
    const double low_mm = options.work_band_mm[0], high_mm = options.work_band_mm[1];
    if (!(low_mm < high_mm)) return fail(Errc::InvalidArgument, "--work-band: the low edge first expected");
    const auto named = std::ranges::find(sim::k_work_names, std::string_view{options.work});
    settings.work = {.work = static_cast<sim::Work>(named - sim::k_work_names.begin()),
                     .film_seed = settings.place_seed,
                     .plan = {.offset_mm = (low_mm + high_mm) / 2, .width_mm = high_mm - low_mm}};
    if (!options.work_gap_mm.empty())
      settings.work->plan.faults.push_back({.kind = sim::WorkFault::Kind::Gap,
                                            .s_mm = options.work_gap_mm[0],
                                            .length_mm = options.work_gap_mm[1]});
  }
  return settings;
}

}  // namespace biteline::cell
