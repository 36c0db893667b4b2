// SPDX-License-Identifier: MIT
#include "firmware/app/options.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "common/options/command.hpp"
#include "common/settings/settings.hpp"
#include "common/stripe/peak_names.hpp"

namespace biteline::sensor {
namespace {

int log_error(const std::string& line) {
  std::fprintf(stderr, "biteline-sensor: %s\n", line.c_str());
  return static_cast<int>(ExitStatus::BadInput);
}

/// How a stripe is found, under the names that profile sensors give it.
void add_peak_options(options::Command& app, PeakWishes& wishes) {
  app.add_option_function(
         "--peak-mode", [&](const std::string& name) { wishes.mode = stripe::k_peak_modes.at(name); },
         "Where in a column the stripe is: by its whole shape (matched, the default), or as other sensors do")
      ->check(options::one_of(stripe::k_peak_modes).unshown())
      ->type_name("matched|maximum|threshold|centre-of-gravity|fir");
  app.add_option_function(
         "--peak", [&](const std::string& name) { wishes.choice = stripe::k_peak_choices.at(name); },
         "Which of several peaks in a column: the one that goes on from its neighbours, or by strength or "
         "place")
      ->check(options::one_of(stripe::k_peak_choices).unshown())
      ->type_name("continuity|strongest|first|last");
  const stripe::PeakConfig defaults;
  app.add_option("--peak-threshold", wishes.threshold_grey,
                 "A peak is at least so many grey levels above its background")
      ->check(options::number({.minimum = 1, .maximum = 254}, "grey levels"))
      ->default_str(std::to_string(static_cast<int>(defaults.threshold_grey)));
  app.add_option("--peak-width-min", wishes.width_min_px,
                 "Narrower peaks are no stripe, in pixels at half height")
      ->check(options::number({.minimum = 0.1, .maximum = 1000}, "px"));
  app.add_option("--peak-width-max", wishes.width_max_px, "Wider peaks are no stripe")
      ->check(options::number({.minimum = 0.1, .maximum = 1000}, "px"));
}

}  // namespace

ParsedOptions parse_options(int argc, char** argv) {
  ParsedOptions parsed;
  Options& options = parsed.options;
  std::string listen = "tcp://127.0.0.1:0";
  std::string realtime;
  options::Command app{"Biteline's sensor program: camera frames in, 3-D profiles out to the host.",
                       "biteline-sensor"};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option("--source", options.source.source,
                 "replay:SESSION, a recorded session's folder; board:FILE, the devices of a board.yaml");
  app.add_option("--sensor", options.source.sensor_file,
                 "Calibration that replaces the head's own (sensor.yaml)");
  std::filesystem::path settings_file;
  app.add_option(
      "--settings", settings_file,
      "A settings file, or a folder whose start-up.yaml it is (biteline settings); what this command "
      "line says goes before");
  app.add_option("--listen", listen, "Where hosts connect; port 0: any free one")->capture_default_str();
  app.add_option("--keys", options.keys, "Folder of keys; compulsory beyond loopback");
  app.add_option("--make-keys", options.make_keys,
                 "Make this sensor's keys and an empty hosts.allowed in a folder, and leave");
  app.add_option("--name", options.name, "What the sensor calls itself");
  app.add_option("--rt", realtime,
                 "required: refuse to run without real-time rights; ignore: run as any program")
      ->check(options::one_of({"required", "ignore"}));
  app.add_option("--store-mb", options.store_megabytes, "Room for what hosts have not fetched yet, in MB")
      ->check(options::number({.minimum = 1, .maximum = 16384}, "MB"))
      ->capture_default_str();
  Capture& capture = options.source.capture;
  double second_exposure_us = 0;
  app.add_flag("--auto-exposure", capture.auto_exposure,
               "The exposure follows the surface: share of valid and of saturated columns");
  app.add_flag("--follow-stripe", capture.follow_stripe,
               "The camera shows only the rows about the stripe, all of the head's region when it is lost");
  app.add_flag("--laser-off-frames", capture.laser_off_frames,
               "Every second frame without laser, taken off the next: against the room's light");
  app.add_option("--second-exposure-us", second_exposure_us,
                 "Every second frame so long, merged per column: black beside white")
      ->check(options::number({.minimum = 1, .maximum = 1e6}, "us"));
  app.add_option("--record", options.record,
                 "Write each live scan into a session folder of that name, or with NAME.mcap into one file "
                 "(-2, -3, ... behind it where it is taken): pictures, poses, settings, profiles");
  app.add_option(
         "--record-pictures", options.record_pictures_every,
         "Of a recording: every so many pictures one; 1: all, 0: none.  Poses and profiles are all kept")
      ->check(options::number({.minimum = 0, .maximum = 1e6}, "pictures"))
      ->capture_default_str();
  app.add_option("--record-keep-gb", options.record_keep_gb,
                 "The oldest recordings of that name go once all of them have more; not told: all stay")
      ->check(options::number({.minimum = 0.001, .maximum = 1e6}, "GB"));
  app.add_option("--record-every", options.record_every, "Record the first of so many scans; 1: all")
      ->check(options::number({.minimum = 1, .maximum = 1e6}, "scans"))
      ->capture_default_str();
  app.add_flag("--record-asked", options.record_asked,
               "Keep the newest scan alone, beside under NAME-last, until --keep asks for it");
  app.add_option(
         "--keep", options.keep,
         "last: give the scan that waits under --record NAME its own name; next: the one that ends next; "
         "and leave")
      ->check(options::one_of({"last", "next"}));
  add_peak_options(app, options.peaks);
  app.add_option(
      "--upkeep", options.upkeep,
      "Count starts, boots, hours, laser hours and the head's temperatures in upkeep.yaml of this folder; "
      "under systemd the unit's own (STATE_DIRECTORY)");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  app.add_flag("--stay", options.stay_after_scan, "Keep serving a recording after it was delivered");
  app.add_flag(
      "--stills", options.stills,
      "Single pictures of --source board:FILE with the arm's pose, by orders on stdin (biteline capture)");
  app.add_flag("--check", options.check,
               "Open and close each device of --source board:FILE, say what is missing, and leave");
  app.add_flag("--check-rate", options.check_rate,
               "With --sensor: take pictures for three seconds in the dark, and fail where "
               "this program does not keep up with the head's rate");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv)) {
    parsed.leave_with = leave->fault.empty() ? 0 : log_error(leave->fault + " (see --help)");
    return parsed;
  }
  if (options.check_rate && !options.source.sensor_file) {
    parsed.leave_with = log_error("--check-rate: --sensor is needed (see --help)");
    return parsed;
  }
  if ((options.keep || options.record_asked) && !options.record) {
    parsed.leave_with = log_error("--keep, --record-asked: --record is needed (see --help)");
    return parsed;
  }
  if (options.source.source.empty() && !options.make_keys && !options.keep) {
    parsed.leave_with = log_error("--source is needed (see --help)");
    return parsed;
  }
  // systemd's name for it; an older program of the same unit knows no such option.
  if (const char* state = std::getenv("STATE_DIRECTORY");
      !options.upkeep && state != nullptr && *state == '/')
    options.upkeep = state;
  options.told_peaks = options.peaks;
  if (!settings_file.empty()) {
    std::error_code unseen;  // reading tells what is wrong with it
    if (std::filesystem::is_directory(settings_file, unseen)) settings_file /= settings::k_start_file;
    Result<settings::SettingsSet> set = settings::read_settings(settings_file);
    if (!set) {
      parsed.leave_with = log_error(to_line(set.error()));
      return parsed;
    }
    options.peaks = put_over(options.peaks, *set);
    options.source.set = std::move(*set);
  }
  const Result<wire::Endpoint> endpoint = wire::parse_endpoint(listen);
  if (!endpoint) {
    parsed.leave_with = log_error(to_line(endpoint.error()));
    return parsed;
  }
  options.listen = *endpoint;
  capture.second_exposure = Nanoseconds{std::llround(1e3 * second_exposure_us)};
  if (realtime == "required") options.realtime = runtime::RealtimeDemand::Required;
  if (realtime == "ignore") options.realtime = runtime::RealtimeDemand::Ignored;
  return parsed;
}

}  // namespace biteline::sensor
