// SPDX-License-Identifier: MIT
// biteline replay: a recorded session through the sensor program and the host's pipeline, or recorded
// profiles through the host's.
#include <cstdio>
#include <memory>
#include <optional>

#include "common/stripe/peak_names.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/method.hpp"
#include "host/calibration/consistency/picture_check.hpp"
#include "host/cloud/uncertainty/uncertainty_file.hpp"
#include "host/intake/account.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/recorded_scan.hpp"
#include "host/intake/scan_cause.hpp"
#include "host/intake/session_run.hpp"
#include "host/records/recording/import.hpp"
#include "host/records/results/line_result.hpp"
#include "host/records/results/refused_result.hpp"
#include "host/report/progress.hpp"

namespace biteline::app {
namespace {

struct ReplayOptions {
  std::filesystem::path session, out, sensor, uncertainty;
  std::string peak_mode;
  Method method{Method::Default};
};

/// The line of a scan that is in; its time from the last profile on is a stage of its own.
FoundLine finish_line(intake::LiveLine& line, report::Report& report) {
  intake::LiveLine::Outcome outcome = line.wait();
  report.add_stage("last profile to line", outcome.last_profile_to_line_s);
  return {std::move(outcome.extraction), results::stages_of(std::move(outcome.workings))};
}

/// Told by the option, or by the file beside the sensor.yaml that counts.
Result<std::optional<uncertainty::HeadUncertainty>> uncertainty_of(const ReplayOptions& options) {
  if (!options.uncertainty.empty()) {
    BITELINE_ASSIGN(const uncertainty::HeadUncertainty told,
                    uncertainty::read_uncertainty(options.uncertainty));
    return std::optional{told};
  }
  return uncertainty::read_uncertainty_beside(
      options.sensor.empty() ? options.session / "cam0" / "sensor.yaml" : options.sensor);
}

Result<intake::RecordedScan> take_in_profiles(const intake::ProfileSource& input,
                                              const ReplayOptions& options,
                                              const intake::OnProfile& on_profile, report::Report& report) {
  if (!options.sensor.empty() || !options.peak_mode.empty()) {
    return fail(Errc::InvalidArgument, "--sensor and --peak-mode need pictures, but %s", input.why.c_str());
  }
  BITELINE_ASSIGN(intake::RecordedScan scan, intake::read_recorded_scan(input.file, on_profile));
  report.fields["from_profiles"] = input.why;
  if (scan.lacks) {
    report.fields["scan_lacks"] = *scan.lacks;
    std::fprintf(stderr, "biteline: %s: %s\n", input.file.c_str(), scan.lacks->c_str());
  }
  return scan;
}

Result<intake::RecordedScan> take_in(const std::optional<intake::ProfileSource>& profiles,
                                     const ReplayOptions& options,
                                     const intake::SessionRunOptions& run_options, report::Report& report) {
  if (profiles) return take_in_profiles(*profiles, options, run_options.on_profile, report);
  BITELINE_ASSIGN(intake::SessionRun run, intake::run_sensor_on_session(run_options));
  return intake::RecordedScan{.run = std::move(run), .lacks = {}};
}

/// What an MCAP file holds, as a folder beside the results for as long as the replay runs.
class Unpacked {
 public:
  explicit Unpacked(std::filesystem::path folder) : folder_{std::move(folder)} {}
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;
  ~Unpacked() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// The session, or the scan's own file.
  Result<std::filesystem::path> take(const std::filesystem::path& file, report::Report& report) const {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
    BITELINE_ASSIGN(const recording::Imported imported, recording::import_mcap(file, folder_));
    if (!imported.lacks.empty()) {
      report.fields["file_lacks"] = imported.lacks;
      std::fprintf(stderr, "biteline: %s: cut or damaged at %s\n", file.c_str(), imported.lacks.c_str());
    }
    return imported.has_session() ? folder_ : folder_ / "scan.btln";
  }

 private:
  std::filesystem::path folder_;
};

Result<ExitStatus> replay(ReplayOptions options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(results::prepare_result_folder(options.out));
  const std::string input_name = options.session.filename().string();
  std::optional<Unpacked> unpacked;
  if (recording::is_mcap(options.session)) {
    unpacked.emplace(options.out / "unpacked");
    BITELINE_ASSIGN(options.session,
                    report.timed("unpack", [&] { return unpacked->take(options.session, report); }));
  }

  BITELINE_ASSIGN(const std::optional<uncertainty::HeadUncertainty> known, uncertainty_of(options));
  intake::SessionRunOptions run_options;
  run_options.session = options.session;
  if (!options.sensor.empty()) run_options.sensor_file = options.sensor;
  if (!options.peak_mode.empty()) run_options.sensor_options = {"--peak-mode", options.peak_mode};
  std::optional<report::Progress> progress;
  run_options.progress = [&](std::size_t done, std::size_t total) {
    if (!progress) progress.emplace("profiles", total, global.quiet);
    progress->set(done);
  };
  // The other ways want the whole cloud; the default works along with the scan.
  std::optional<intake::LiveLine> line;
  std::vector<drift::PosedProfile> poses;
  if (options.method == Method::Default) line.emplace(bite_line::Config{});
  run_options.on_profile = [&](const profile::Profile& profile, std::span<const Eigen::Vector3f> points_base,
                               const cloud::StripeSpan& stripe) {
    const uncertainty::ProfilePose pose = intake::pose_of(profile.header);
    if (!points_base.empty())
      poses.push_back({.profile = static_cast<std::uint32_t>(profile.header.sequence), .pose = pose});
    if (line) line->add_profile(profile.header.sequence, points_base, pose, stripe);
  };
  BITELINE_ASSIGN(const std::optional<intake::ProfileSource> input, intake::choose_profiles(options.session));
  BITELINE_ASSIGN(const intake::RecordedScan scan,
                  report.timed("scan", [&] { return take_in(input, options, run_options, report); }));
  const intake::SessionRun& run = scan.run;
  progress.reset();

  std::shared_ptr<const uncertainty::KnownHead> head;
  if (known) head = std::make_shared<const uncertainty::KnownHead>(run.sensor.model, *known);
  if (line) line->close(head);
  // Beside the line's own thread.
  const consistency::PictureCheck pictures = report.timed("picture check", [&] {
    return consistency::check_pictures({run.cloud.points, run.cloud.profile, poses}, run.sensor.model,
                                       {.head = known, .arm = {}});
  });
  FoundLine found = line ? finish_line(*line, report)
                         : report.timed("extract", [&] { return find_line(run.cloud, options.method); });

  intake::name_scan_cause(found.extraction, run.counts, run.sensor_counters);
  // What was cut is judged only where it shows a line all the same.
  if (!found.extraction.found && !found.extraction.scan_cause && scan.lacks)
    intake::tell_scan_cause(found.extraction, report::told(intake::Refusal{
                                                  .code = intake::Refused::ScanNotComplete,
                                                  .reason = "the scan is not complete: " + *scan.lacks}));

  const bool state_compared = run.sensor.camera_state.told();
  report.fields["picture_check"] = consistency::as_json(pictures, state_compared);
  report.fields["input"] = input_name;
  report.fields["scan"] = intake::account_of(run.counts, run.sensor_counters, run.sensor_stages);
  report.fields["frames_per_s"] =
      run.stream_s > 0 ? static_cast<double>(run.counts.profiles) / run.stream_s : 0.0;
  if (const auto refusal = consistency::refusal_of(pictures)) {
    BITELINE_TRY(results::write_refused_result(options.out, run.cloud, report::told(*refusal), report));
    return tell_folder(report, global, "refused: " + refusal->reason, options.out, report::told(*refusal),
                       {});
  }
  BITELINE_TRY(results::write_line_result(options.out, run.cloud, found.extraction, found.stages, report));
  // A sure line may lie beside the shoe then; one that is refused has its own reason.
  if (consistency::vouched_by(pictures, state_compared) == consistency::VouchedBy::Nobody &&
      found.extraction.found && !global.quiet) {
    std::fprintf(stderr,
                 "biteline: nobody vouches for the pictures' place: no camera state was recorded; %s\n",
                 pictures.words.c_str());
  }
  return tell_folder(report, global, results::summary(found.extraction), options.out, found.extraction.told(),
                     plan_step(options.out));
}

}  // namespace

void add_replay(options::Command& app, Context& context) {
  auto options = std::make_shared<ReplayOptions>();
  options::Command* command =
      app.add_subcommand("replay", "Run a recorded session through the sensor's pipeline and the host's");
  command
      ->add_option("session", options->session,
                   "The session's folder, its MCAP file, or a recorded scan's profiles (scan.btln)")
      ->required();
  command->add_option("--out", options->out, "Folder for cloud.ply, line.csv, report.json, stages/")
      ->required();
  command->add_option(
      "--sensor", options->sensor,
      "A sensor.yaml whose intrinsics, distortion, laser plane and T_flange_cam replace the session's");
  command->add_option(
      "--uncertainty", options->uncertainty,
      "How well the head is known (uncertainty.yaml of `biteline calibrate`); without: the one "
      "beside the sensor.yaml");
  command
      ->add_option("--peak-mode", options->peak_mode,
                   "Where in a column the stripe is: by its whole shape (matched, the default), or as other "
                   "sensors do")
      ->check(options::one_of(stripe::k_peak_modes).unshown())
      ->type_name("matched|maximum|threshold|centre-of-gravity|fir");
  add_method_option(*command, options->method);
  command->callback([options, &context] {
    context.run = [options, &context] { return replay(*options, context.options); };
  });
}

}  // namespace biteline::app
