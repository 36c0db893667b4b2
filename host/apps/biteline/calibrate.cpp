// SPDX-License-Identifier: MIT
// biteline calibrate: a calibration folder into sensor.yaml.
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <set>

#include "common/config/sensor_yaml.hpp"
#include "host/apps/biteline/calibrate_page.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/calibration/clock/clock_offset.hpp"
#include "host/calibration/head/camera_state.hpp"
#include "host/calibration/head/comparison.hpp"
#include "host/calibration/head/head_calibration.hpp"
#include "host/calibration/head/head_pictures.hpp"
#include "host/calibration/head/head_report.hpp"
#include "host/calibration/head/leftovers.hpp"
#include "host/calibration/head/verdict.hpp"
#include "host/calibration/refine/scan_refinement.hpp"
#include "host/cloud/uncertainty/uncertainty_file.hpp"
#include "host/report/json_text.hpp"
#include "host/report/progress.hpp"
#include "host/report/report.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> k_parts{"camera", "laser", "hand-eye", "clock"};

struct CalibrateOptions {
  fs::path calib, out, sensor, compare, refine;
  std::vector<std::string> only;
};

const char* folder_of(const std::string& part) {
  return part == "hand-eye" ? "handeye" : part.c_str();
}

/// What is asked for, or everything that the folder holds.
Result<std::set<std::string>> parts_of(const CalibrateOptions& options) {
  if (!fs::is_directory(options.calib))
    return fail(Errc::FileNotFound, "%s: a calibration folder expected", options.calib.c_str());
  if (!options.only.empty()) {
    std::set<std::string> parts(options.only.begin(), options.only.end());
    // The clock's scan is seen through the whole head; what is not given is calibrated.
    if (parts.contains("clock") && options.sensor.empty()) parts.insert({"laser", "hand-eye"});
    return parts;
  }
  std::set<std::string> parts{"camera", "laser", "hand-eye"};
  if (!options.sensor.empty()) {
    std::erase_if(
        parts, [&](const std::string& part) { return !fs::is_directory(options.calib / folder_of(part)); });
  }
  if (fs::is_directory(options.calib / "clock")) parts.insert("clock");
  return parts;
}

/// `more`: further lines for a person.
Result<ExitStatus> refuse(report::Report& report, const calibration::Refusal& refusal,
                          const CalibrateOptions& options, const GlobalOptions& global,
                          const std::string& more = {}) {
  report.refuse(refusal);
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, "biteline: refused: " + refusal.reason + more);
}

Result<calibration::HeadInput> read_input(const CalibrateOptions& options, const std::set<std::string>& parts,
                                          const std::optional<geometry::SensorModel>& known, bool quiet) {
  calibration::HeadInput input;
  report::Progress progress{"parts", k_parts.size(), quiet};
  if (known) {
    input.known_camera = known->camera;
    input.known_reach = {.width_px = known->region.offset_u_px + known->region.width_px,
                         .height_px = known->region.offset_v_px + known->region.height_px};
  }
  // The camera is under everything; its pictures are taken also when only a later part is asked for.
  if (parts.contains("camera") || !known) {
    BITELINE_ASSIGN(input.camera, calibration::read_camera_folder(options.calib));
  }
  progress.set(1);
  if (parts.contains("laser")) {
    BITELINE_ASSIGN(input.laser, calibration::read_laser_folder(options.calib));
  }
  progress.set(2);
  if (parts.contains("hand-eye")) {
    BITELINE_ASSIGN(input.hand_eye, calibration::read_hand_eye_folder(options.calib));
  }
  progress.set(3);
  return input;
}

/// Of the parts that were read: files without a partner, or of a name that nobody looks for.
std::vector<std::string> warnings_of(const fs::path& calib, const calibration::HeadInput& input) {
  std::vector<std::string> lines;
  const auto add = [&lines](const std::vector<std::string>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  };
  if (input.camera) add(calibration::camera_leftovers(calib));
  if (input.laser) add(calibration::laser_leftovers(calib));
  if (input.hand_eye) add(calibration::hand_eye_leftovers(calib));
  return lines;
}

/// What turns pixels into points: calibrated just now, or as the given sensor.yaml says.
calibration::ScanModel scan_model(const geometry::SensorModel& sensor) {
  return {.camera = sensor.camera,
          .plane = sensor.laser_plane,
          .T_flange_cam = sensor.T_flange_cam,
          .pose_clock_offset = sensor.pose_clock_offset};
}

/// Every eighth column: over a surface seen twice still thousands of points.
constexpr int k_scan_column_step = 8;
/// Two controllers' clocks, set by the same operator's network time, or a fieldbus cycle or two of delay.
constexpr double k_clock_search_ms = 20;

double ms_of(Nanoseconds duration) {
  return 1e-6 * static_cast<double>(duration.count());
}

Result<calibration::ClockOffset> clock_part(const CalibrateOptions& options,
                                            const geometry::SensorModel& sensor, report::Report& report) {
  BITELINE_ASSIGN(const calibration::Scan scan, report.timed("read", [&] {
    return calibration::read_scan(options.calib / "clock", k_scan_column_step);
  }));
  BITELINE_ASSIGN(const calibration::ClockOffset clock, report.timed("clock", [&] {
    return calibration::find_clock_offset(scan, scan_model(sensor), k_clock_search_ms);
  }));
  report.fields["clock"] = {{"determined", clock.determined()}, {"offset_ms", ms_of(clock.offset)},
                            {"sigma_ms", ms_of(clock.sigma)},   {"rms_before_mm", clock.rms_before_mm},
                            {"rms_mm", clock.rms_mm},           {"pairs", clock.pairs}};
  return clock;
}

/// The joint covariance of plane, mounting and clock as refine_from_scan() orders them.
calibration::RefineMatrix prior_of(const calibration::HeadFit& fit, Nanoseconds clock_sigma) {
  calibration::RefineMatrix prior = calibration::RefineMatrix::Zero();
  prior.topLeftCorner<9, 9>() = fit.covariance.bottomRightCorner<9, 9>();
  prior(9, 9) = std::pow(1e-9 * static_cast<double>(clock_sigma.count()), 2);
  return prior;
}

Result<void> refine_part(const CalibrateOptions& options, const calibration::HeadFit& fit,
                         Nanoseconds clock_sigma, geometry::SensorModel& sensor, report::Report& report) {
  BITELINE_ASSIGN(const calibration::Scan scan, report.timed("read", [&] {
    return calibration::read_scan(options.refine, k_scan_column_step);
  }));
  BITELINE_ASSIGN(const calibration::ScanRefinement refined, report.timed("refine", [&] {
    return calibration::refine_from_scan(scan, scan_model(sensor), prior_of(fit, clock_sigma),
                                         fit.plane_axes);
  }));
  sensor.laser_plane = refined.model.plane;
  sensor.T_flange_cam = refined.model.T_flange_cam;
  sensor.pose_clock_offset = refined.model.pose_clock_offset;
  report.fields["refine"] = {{"refined", true},
                             {"rms_before_mm", refined.rms_before_mm},
                             {"rms_after_mm", refined.rms_after_mm},
                             {"pairs", refined.pairs}};
  std::fprintf(stderr, "biteline: refined from %s: surfaces seen twice agree to %.4f mm, before %.4f mm\n",
               options.refine.filename().c_str(), refined.rms_after_mm, refined.rms_before_mm);
  return {};
}

/// What the fit states; a part that was not calibrated here has none, and then there is no file.
uncertainty::HeadUncertainty uncertainty_of(const calibration::HeadFit& fit,
                                            const calibration::HandEyeCalibration& hand_eye,
                                            Nanoseconds clock_sigma) {
  uncertainty::HeadUncertainty out{.plane_axes = fit.plane_axes,
                                   .plane_middle_cam = fit.plane_middle_cam,
                                   .pose_sigma_mm = hand_eye.pose_sigma_mm,
                                   .pose_sigma_rad = hand_eye.pose_sigma_rad};
  out.covariance.topLeftCorner<calibration::k_head_parameters, calibration::k_head_parameters>() =
      fit.covariance;
  out.covariance(uncertainty::k_clock_at, uncertainty::k_clock_at) =
      std::pow(1e-9 * static_cast<double>(clock_sigma.count()), 2);
  return out;
}

Result<void> compare_part(const CalibrateOptions& options, const calibration::HeadFit& fit, int width_px,
                          report::Report& report) {
  BITELINE_ASSIGN(const geometry::SensorModel before, config::read_sensor_yaml(options.compare));
  const calibration::Comparison c = calibration::compare_heads(fit, before, width_px);
  report.fields["compared"] = {
      {"moved", c.moved},
      {"rms_mm", c.rms_mm},
      {"largest_mm", c.largest_mm},
      {"turn_deg", c.turn_rad * 180 / std::numbers::pi},
      {"shift_flange_mm", {c.shift_flange_mm.x(), c.shift_flange_mm.y(), c.shift_flange_mm.z()}},
      {"sigma_mm", c.sigma_mm}};
  std::fprintf(stderr,
               "biteline: against %s the head %s: %.3f mm at the working distance, known to %.3f mm\n",
               options.compare.filename().c_str(), c.moved ? "moved" : "did not move", c.rms_mm, c.sigma_mm);
  return {};
}

void say(const calibration::HeadCalibration& result, const GlobalOptions& global) {
  if (global.quiet) return;
  if (result.pixel_grid.uneven()) {
    std::fprintf(
        stderr,
        "biteline: the pictures' columns and rows lie %.2f px off an even grid (scaled in the camera or "
        "its driver?); evened out for the rings, scans are taken as they are\n",
        result.pixel_grid.rms_px());
  }
  for (const calibration::SetAside& one : result.set_aside)
    std::fprintf(stderr, "biteline: set aside %s: %s\n", one.name.c_str(), one.reason.c_str());
}

std::string retake_words(const calibration::Verdict& verdict) {
  std::string words;
  for (const std::string& picture : verdict.retake) words += "\n  retake " + picture;
  return words;
}

/// "calibration: fair", what keeps it from good, and what to take again.
std::string words_of(const calibration::Verdict& verdict) {
  std::string words = std::string{"calibration: "} + calibration::name_of(verdict.grade);
  for (const std::string& reason : verdict.reasons) words += "\n  " + reason;
  return words + retake_words(verdict);
}

/// In which the pictures were taken; what is taken from another sensor.yaml must have been made in the same.
Result<geometry::CameraState> state_of(const CalibrateOptions& options,
                                       const std::optional<geometry::SensorModel>& known) {
  BITELINE_ASSIGN(const geometry::CameraState pictures, calibration::read_folder_state(options.calib));
  for (const fs::path& scan : {options.calib / "clock", options.refine})
    if (!scan.empty()) BITELINE_TRY(calibration::expect_scan_state(scan, pictures));
  if (!known) return pictures;
  BITELINE_TRY(geometry::expect_state(known->camera_state, pictures));
  return geometry::put_over(known->camera_state, pictures);
}

Result<ExitStatus> calibrate(const CalibrateOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const std::set<std::string> parts, parts_of(options));
  std::optional<geometry::SensorModel> known;
  if (!options.sensor.empty()) {
    BITELINE_ASSIGN(known, config::read_sensor_yaml(options.sensor));
  }
  BITELINE_ASSIGN(const calibration::HeadInput input,
                  report.timed("read", [&] { return read_input(options, parts, known, global.quiet); }));
  BITELINE_TRY(report::prepare_folder(options.out / "stages"));
  std::error_code ignored;
  // An older result must not outlive a refusal.
  for (const char* name : {"sensor.yaml", "index.html", uncertainty::k_file_name, "stages/coverage.png",
                           "stages/rings_camera.png", "stages/rings_laser.png", "stages/stripe.png",
                           "stages/rings_handeye.png", "stages/left_out.png"})
    fs::remove(options.out / name, ignored);
  BITELINE_ASSIGN(const geometry::CameraState state, state_of(options, known));

  const calibration::HeadCalibration result =
      report.timed("calibrate", [&] { return calibration::calibrate_head(input); });
  report.fields["input"] = options.calib.filename().string();
  report.fields["parts"] = parts;
  const std::vector<std::string> warnings = warnings_of(options.calib, input);
  report.fields["warnings"] = warnings;
  for (const std::string& warning : warnings)
    if (!global.quiet) std::fprintf(stderr, "biteline: warning: %s\n", warning.c_str());
  report.fields.update(calibration::report_fields(result));
  const calibration::Verdict verdict = calibration::judge(result);
  report.fields["verdict"] = {{"grade", calibration::name_of(verdict.grade)},
                              {"reasons", verdict.reasons},
                              {"retake", verdict.retake}};
  say(result, global);
  BITELINE_TRY(report.timed_aside("pictures", [&] {
    return calibration::draw_calibration(result, options.calib, options.out / "stages");
  }));
  BITELINE_TRY(write_calibration_page(report.fields, verdict, options.out));
  if (result.refused) {
    if (error_row(result.refused->code).exit_status != ExitStatus::Refused)
      return tl::unexpected<Error>(*result.refused);
    return refuse(report, calibration::refusal_of(result), options, global);
  }
  // Not to be used: what is not written cannot be.
  if (verdict.grade == calibration::Grade::Bad)
    return refuse(report, calibration::refusal_of(verdict), options, global, retake_words(verdict));

  geometry::SensorModel sensor = known.value_or(geometry::SensorModel{});
  std::set<std::string> told = parts;
  if (known) told.insert(k_parts.begin(), k_parts.end());
  sensor.camera = result.fit.state.camera;
  if (result.camera)
    sensor.region = {.offset_u_px = 0,
                     .offset_v_px = 0,
                     .width_px = result.camera->size.width_px,
                     .height_px = result.camera->size.height_px};
  sensor.camera_state = state;
  if (!state.told() && !global.quiet)
    std::fprintf(stderr,
                 "biteline: the pictures do not tell the camera's state (no camera_state.yaml beside them): "
                 "sensor.yaml tells none, and the sensor expects neither mirror, turn nor binning\n");
  if (result.laser) {
    sensor.laser_plane = result.fit.state.plane;
    sensor.speckle_contrast = result.laser->speckle_contrast;
  }
  if (result.hand_eye) sensor.T_flange_cam = result.fit.state.T_flange_cam;
  const auto refused_by = [](const Error& error) {
    return error_row(error.code).exit_status == ExitStatus::Refused;
  };
  Nanoseconds clock_sigma{100'000};  // not calibrated here: what a session's own offset is trusted to
  if (parts.contains("clock")) {
    const Result<calibration::ClockOffset> clock = clock_part(options, sensor, report);
    if (!clock && !refused_by(clock.error())) return tl::unexpected<Error>(clock.error());
    if (clock && clock->determined()) {
      sensor.pose_clock_offset = clock->offset;
      clock_sigma = clock->sigma;
    } else {
      const calibration::Refusal refusal =
          clock ? calibration::Refusal{.code = calibration::Refused::ClockNotDetermined,
                                       .reason = clock->reason}
                : calibration::refusal_of(calibration::Part::Clock, clock.error());
      if (!options.only.empty() || parts.size() == 1) return refuse(report, refusal, options, global);
      // The head's geometry stands on pictures at rest and is as good without the scan.
      report.fields["clock"]["reason_code"] = report::refusal_row(refusal.code).name;
      report.fields["clock"]["reason"] = refusal.reason;
      report.fields["clock"]["determined"] = false;
      std::fprintf(stderr, "biteline: clock offset not determined, %lld ns written: %s\n",
                   static_cast<long long>(sensor.pose_clock_offset.count()), refusal.reason.c_str());
    }
  }
  if (!options.compare.empty() || !options.refine.empty()) {
    if (!result.laser || !result.hand_eye)
      return fail(Errc::InvalidArgument,
                  "--compare, --refine: laser and hand-eye must be calibrated with them");
  }
  if (!options.refine.empty()) {
    const Result<void> refined = refine_part(options, result.fit, clock_sigma, sensor, report);
    if (!refined && !refused_by(refined.error())) return tl::unexpected<Error>(refined.error());
    if (!refined) {
      const std::string reason(refined.error().where.view());
      report.fields["refine"] = {{"refined", false}, {"reason", reason}};
      std::fprintf(stderr, "biteline: not refined, the pictures' calibration stays: %s\n", reason.c_str());
    }
  }
  if (!options.compare.empty())
    BITELINE_TRY(compare_part(options, result.fit, sensor.region.width_px, report));
  const std::string text = config::sensor_yaml_text(
      sensor, "calibrated by biteline; report.json beside it tells how well",
      {.laser_plane = told.contains("laser"), .T_flange_cam = told.contains("hand-eye")});
  BITELINE_TRY(report::write_file_atomically(options.out / "sensor.yaml", text));
  if (result.camera && result.laser && result.hand_eye) {
    BITELINE_TRY(report::write_file_atomically(
        options.out / uncertainty::k_file_name,
        uncertainty::uncertainty_text(uncertainty_of(result.fit, *result.hand_eye, clock_sigma))));
  }
  // Again: what came after the pictures is in it now.
  BITELINE_TRY(write_calibration_page(report.fields, verdict, options.out));
  BITELINE_TRY(report.write(options.out));
  std::string words = words_of(verdict);
  if (result.hand_eye) words += "\n  " + calibration::mounting_words(sensor.T_flange_cam);
  return tell(report, global, words);
}

void add_options(options::Command* command, const std::shared_ptr<CalibrateOptions>& options, bool whole) {
  command->add_option("CALIB", options->calib, "The calibration folder")->required(!whole);
  command->add_option("--out", options->out, "Where the results go")->required(!whole);
  command->add_option("--sensor", options->sensor, "A sensor.yaml to take from what is not calibrated here");
  command->add_option("--compare", options->compare,
                      "An earlier sensor.yaml of this head: did it move, and by how much?");
  command->add_option("--refine", options->refine,
                      "A scan (session folder) that sees some surface more than once, for the last word");
}

}  // namespace

void add_calibrate(options::Command& app, Context& context) {
  const auto options = std::make_shared<CalibrateOptions>();
  options::Command* command =
      app.add_subcommand("calibrate", "Calibrates a head: camera, laser plane, mounting, clock");
  add_options(command, options, true);
  command->add_option("--only", options->only, "Some of the parts: camera,laser,hand-eye,clock")
      ->delimiter(',')
      ->check(options::one_of(k_parts));
  command->callback([command, options, &context] {
    if (context.run) return;  // a part's own subcommand was given
    if (options->calib.empty()) throw options::Unfit{"CALIB is required"};
    if (options->out.empty()) throw options::Unfit{"--out is required"};
    context.run = [options, &context] { return calibrate(*options, context.options); };
  });
  for (const std::string& part : k_parts) {
    const auto own = std::make_shared<CalibrateOptions>();
    options::Command* sub = command->add_subcommand(part, "Only this part, and what it stands on");
    add_options(sub, own, false);
    own->only = {part};
    sub->callback(
        [own, &context] { context.run = [own, &context] { return calibrate(*own, context.options); }; });
  }
}

}  // namespace biteline::app
