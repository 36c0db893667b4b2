// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "common/options/command.hpp"
#include "hal/sim/app/command.hpp"
#include "hal/sim/app/world_options.hpp"
#include "hal/sim/live/arm_way.hpp"
#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/record/calibration_recorder.hpp"
#include "hal/sim/record/cloud_recorder.hpp"
#include "hal/sim/record/session_recorder.hpp"

namespace biteline::cell {

namespace {

struct RecordOptions {
  SceneOptions scene;
  WorldOptions world;
  std::string arm;  ///< empty: the head goes by itself
  std::string out;
  double clock_offset_ms{0};
  bool hide_clock_offset{false};
  std::optional<sim::OutlinePart> part;
  std::optional<double> arrival_jitter_ms, arrival_late_ms;
  bool camera_stamps{false};
};

/// As of a camera without a trigger; none without one of the options.
std::optional<sim::ArrivalStamps> arrival_of(const RecordOptions& options) {
  if (!options.arrival_jitter_ms && !options.arrival_late_ms && !options.camera_stamps) return std::nullopt;
  return sim::ArrivalStamps{.jitter_ms = options.arrival_jitter_ms.value_or(0),
                            .unknown_late_ms = options.arrival_late_ms.value_or(0),
                            .camera_stamps = options.camera_stamps};
}

/// On a terminal only; the last one wipes its own trace.
void show_progress(double ratio) {
  static const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal) std::fprintf(stderr, ratio < 1 ? "\r%3.0f %%" : "\r      \r", 100 * ratio);
}

Result<void> record(const RecordOptions& options) {
  BITELINE_ASSIGN(sim::SceneSettings settings, scene_settings(options.scene));
  set_surroundings(settings, options.world);
  if (!options.arm.empty()) {
    settings.holder = sim::Holder::Bracket;
    settings.places = sim::places_within_reach_of(options.arm);
  }
  BITELINE_ASSIGN(const auto scene, sim::make_scene(settings));
  sim::RecordSettings record_settings{
      .pose_clock_offset = Nanoseconds{std::llround(options.clock_offset_ms * 1e6)},
      .tell_clock_offset = !options.hide_clock_offset,
      .noise_seed = settings.shoe.seed + (settings.work ? 1 : 0),  // a worked shoe is scanned a second time
      .part = options.part,
      .disturbances = disturbances_of(options.world),
      .arrival = arrival_of(options)};
  if (!options.arm.empty()) {
    const auto kinematics = sim::ArmKinematics::named(options.arm);
    if (!kinematics)
      return fail(Errc::InvalidArgument, "--arm %s: ur3e, ur5e or ur10e expected", options.arm.c_str());
    BITELINE_ASSIGN(const sim::ReachableScan reachable,
                    sim::place_within_reach(*scene, *kinematics, options.arm));
    record_settings.way = sim::way_of(*reachable.scan, *kinematics, record_settings.disturbances.arm);
  }
  BITELINE_TRY(sim::record_session(options.out, *scene, record_settings, show_progress));
  std::printf("simulated session of shoe %s %llu: %s\n",
              std::string(sim::name_of(settings.shoe.shoe_class)).c_str(),
              static_cast<unsigned long long>(settings.shoe.seed), options.out.c_str());
  return {};
}

struct CloudOptions {
  SceneOptions scene;
  sim::ScanSettings scan;
  std::string out;
};

Result<void> record_cloud(const CloudOptions& options) {
  BITELINE_ASSIGN(const sim::SceneSettings settings, scene_settings(options.scene));
  sim::ScanSettings scan = options.scan;
  scan.seed = settings.place_seed + (settings.work ? 1'000'000 : 0);
  BITELINE_TRY(sim::record_cloud(options.out, settings, scan));
  std::printf("simulated cloud of shoe %s %llu: %s\n",
              std::string(sim::name_of(settings.shoe.shoe_class)).c_str(),
              static_cast<unsigned long long>(settings.shoe.seed), options.out.c_str());
  return {};
}

struct CalibrationOptions {
  sim::CalibrationSettings settings;
  LightOptions light;
  std::string out;
  double clock_offset_ms{0};
};

Result<void> record_calibration(const CalibrationOptions& options, bool with_clock) {
  sim::CalibrationSettings settings = options.settings;
  settings.light = options.light.chosen();
  if (with_clock) settings.clock_offset = Nanoseconds{std::llround(options.clock_offset_ms * 1e6)};
  BITELINE_TRY(sim::record_calibration(options.out, settings, show_progress));
  std::printf("simulated calibration pictures of head %llu: %s\n",
              static_cast<unsigned long long>(settings.head_seed), options.out.c_str());
  return {};
}

}  // namespace

void add_record_calibration(options::Command& app, Context& context) {
  auto options = std::make_shared<CalibrationOptions>();
  sim::CalibrationSettings& settings = options->settings;
  options::Command* command = app.add_subcommand(
      "record-calibration", "Write a made head's calibration folder, with the true answer; no time runs");
  command
      ->add_option("--head", settings.head_seed, "Which head: its true calibration is drawn from this seed")
      ->capture_default_str();
  command->add_option("--seed", settings.view_seed, "Views and noise")->capture_default_str();
  add_light_options(*command, options->light);
  command->add_option("--out", options->out, "The calibration folder")->required();
  command->add_option("--camera-views", settings.camera_views)
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 99}, ""));
  command->add_option("--laser-views", settings.laser_views)
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 99}, ""));
  command->add_option("--handeye-views", settings.handeye_views)
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 99}, ""));
  command->add_option("--pose-noise-mm", settings.pose_noise_mm, "Of each hand-eye pose")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 5}, "mm"));
  command->add_option("--pose-noise-rad", settings.pose_noise_rad)
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 0.1}, "rad"));
  command->add_option("--averaged", settings.averaged, "Each picture is the mean of so many exposures")
      ->capture_default_str()
      ->check(options::number({.minimum = 1, .maximum = 1000}, ""));
  command
      ->add_option("--scaled-ratio", settings.scaled_ratio,
                   "Fills the lit pictures from ones of this size, nearest pixel, as a scaler does")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.5, .maximum = 1.0}, ""));
  command
      ->add_option("--chessboard", settings.chessboard_squares,
                   "Chessboards in place of rings, so many squares from one ring's centre to the next")
      ->check(options::number({.minimum = 1, .maximum = 4}, ""));
  options::Option* clock = command
                               ->add_option("--clock-offset-ms", options->clock_offset_ms,
                                            "Adds clock/, a scan with this offset between the clocks")
                               ->check(options::number({.minimum = -1000, .maximum = 1000}, "ms"));
  command->callback([options, clock, &context] {
    const bool with_clock = clock->count() > 0;
    context.run = [options, with_clock] { return record_calibration(*options, with_clock); };
  });
}

void add_record(options::Command& app, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  options::Command* command =
      app.add_subcommand("record", "Write a made scan as a session folder, with its truth; no time runs");
  add_scene_options(*command, options->scene);
  add_light_options(*command, options->scene.light);
  add_way_round_options(*command, options->scene);
  add_work_options(*command, options->scene);
  add_reach_option(*command, options->scene);
  add_world_options(*command, options->world);
  options::Option* arm = command->add_option(
      "--arm", options->arm,
      "This arm makes the scan with the head on a bracket, as its joints can: ur3e, ur5e or ur10e");
  for (const char* of_the_arm :
       {"--elastic-hz", "--unseen-ratio", "--following-ms", "--latency-ms", "--scan-clockwise"})
    command->get_option(of_the_arm)->needs(arm);
  command->add_option("--out", options->out, "The session's folder")->required();
  command->add_option("--clock-offset-ms", options->clock_offset_ms, "Pose clock minus camera clock")
      ->check(options::number({.minimum = -1000, .maximum = 1000}, "ms"));
  command
      ->add_option(
          "--arrival-jitter-ms", options->arrival_jitter_ms,
          "A camera without a trigger: pictures are stamped when they come, late by an exponential law of "
          "this mean, which is calibrated away")
      ->check(options::number({.minimum = 0, .maximum = 100}, "ms"));
  command
      ->add_option("--arrival-late-ms", options->arrival_late_ms, "Likewise, a delay that nobody calibrated")
      ->check(options::number({.minimum = -10, .maximum = 10}, "ms"));
  command->add_flag("--camera-stamps", options->camera_stamps,
                    "Likewise, but the camera has a clock, which is mapped by the least delays");
  command->add_flag("--hide-clock-offset", options->hide_clock_offset, "sensor.yaml says 0 instead");
  auto part = std::make_shared<sim::OutlinePart>();
  options::Option* from =
      command
          ->add_option("--from-mm", part->from_s_mm, "Only a part of the scan: from here along the outline")
          ->check(options::number({.minimum = 0, .maximum = 2000}, "mm"));
  options::Option* length = command->add_option("--length-mm", part->length_mm, "How long that part is")
                                ->check(options::number({.minimum = 0.1, .maximum = 2000}, "mm"))
                                ->needs(from);
  from->needs(length);
  from->excludes(arm)->excludes(command->get_option("--scan-begin"));
  command->callback([options, part, from, &context] {
    if (from->count() > 0) options->part = *part;
    context.run = [options] { return record(*options); };
  });
}

void add_record_cloud(options::Command& app, Context& context) {
  auto options = std::make_shared<CloudOptions>();
  options::Command* command = app.add_subcommand(
      "record-cloud", "Write a made scan as a finished cloud, with its truth; no pictures, no time runs");
  add_scene_options(*command, options->scene);
  add_work_options(*command, options->scene);
  add_reach_option(*command, options->scene);
  command->add_option("--out", options->out, "The folder of cloud.ply and truth/")->required();
  command->add_option("--profile-step-mm", options->scan.profile_step_mm, "Between stripes along the outline")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.05, .maximum = 20}, "mm"));
  command
      ->add_option("--column-step-mm", options->scan.column_step_mm, "Between points of a profile, upwards")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.01, .maximum = 20}, "mm"));
  command->add_option("--noise-mm", options->scan.noise_mm, "Standard deviation along the viewing ray")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 5}, "mm"));
  command->callback([options, &context] { context.run = [options] { return record_cloud(*options); }; });
}

}  // namespace biteline::cell
