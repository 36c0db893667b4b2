// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/scan_pipeline.hpp"

#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <memory>

#include "common/system/log_level.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/calibration/consistency/picture_check.hpp"
#include "host/cloud/ply.hpp"
#include "host/intake/account.hpp"
#include "host/intake/refused.hpp"
#include "host/intake/scan_cause.hpp"
#include "host/intake/whole_scan.hpp"
#include "host/records/results/line_result.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/records/results/refused_result.hpp"
#include "host/records/results/transfer_result.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

/// What kept the profiles out goes before the cut, as another scan alone would not help.  That the stripe was
/// not met yet, or that the first few profiles came before the first pose, is none.
std::optional<intake::Refusal> cause_before_the_cut(const intake::ScanOutcome& scan) {
  constexpr std::uint64_t k_enough_profiles = 50;  // half a second at 100 a second
  if (scan.counts.profiles < k_enough_profiles) return std::nullopt;
  std::optional<intake::Refusal> cause =
      intake::scan_cause(scan.counts, scan.sensor_counters, &scan.sensor_devices);
  if (!cause || cause->code == intake::Refused::NoStripe ||
      cause->code == intake::Refused::StripeAlongColumns)
    return std::nullopt;
  cause->reason += "; the scan is not complete either: " + to_line(*scan.failure);
  return cause;
}

intake::Refusal why_unfinished(const intake::ScanOutcome& scan) {
  using enum intake::Refused;
  const std::string profiles = std::to_string(scan.counts.profiles) + " profiles";
  if (!scan.stopped_by.empty()) {
    return {.code = StoppedByAPerson,
            .reason = "the scan was stopped by " + scan.stopped_by + " after " + profiles};
  }
  if (scan.sensor.test_pattern) return {.code = TestPattern, .reason = scan.failure->where.c_str()};
  if (scan.failure->code == Errc::Refused)
    return {.code = CameraState, .reason = scan.failure->where.c_str()};
  if (std::optional<intake::Refusal> cause = cause_before_the_cut(scan)) return std::move(*cause);
  return {.code = ScanNotComplete,
          .reason = "the scan is not complete after " + profiles + ": " + to_line(*scan.failure)};
}

Result<LineStep> keep_unfinished(const fs::path& folder, const intake::ScanOutcome& scan,
                                 report::Report& report) {
  const intake::Refusal refusal = why_unfinished(scan);
  report.refuse(refusal);
  BITELINE_TRY(cloud::write_cloud(folder / "cloud.ply", scan.cloud));
  BITELINE_TRY(report.write(folder));
  BITELINE_TRY(results::write_refused_view(folder, scan.cloud, report::told(refusal), report));
  warn_step("refused: %s", refusal.reason.c_str());
  return LineStep{.status = ExitStatus::Refused, .confidence = 0, .line = {}};
}

/// What became of a scan by its pictures.
struct HeededPictures {
  std::optional<LineStep> refused;  ///< they did not come as the head was calibrated; the cloud is kept
  bool vouched{false};
};

Result<HeededPictures> heed_pictures(const fs::path& folder, const intake::ScanOutcome& scan,
                                     const KnownBefore& known, report::Report& report) {
  std::vector<drift::PosedProfile> poses;
  for (const intake::TakenFrom& taken : scan.poses)
    poses.push_back({.profile = taken.profile, .pose = taken.pose});
  const consistency::PictureCheck pictures = report.timed("picture check", [&] {
    return consistency::check_pictures({scan.cloud.points, scan.cloud.profile, poses}, scan.sensor.model,
                                       {.head = known.head, .arm = known.arm});
  });
  const bool state_told = scan.sensor.camera_state.told();
  report.fields["picture_check"] = consistency::as_json(pictures, state_told);
  const auto refusal = consistency::refusal_of(pictures);
  if (!refusal)
    return HeededPictures{
        .refused = {},
        .vouched = consistency::vouched_by(pictures, state_told) != consistency::VouchedBy::Nobody};
  BITELINE_TRY(results::write_refused_result(folder, scan.cloud, report::told(*refusal), report));
  warn_step("refused: %s", refusal->reason.c_str());
  return HeededPictures{.refused = LineStep{.status = ExitStatus::Refused, .confidence = 0, .line = {}}};
}

void fill_scan(const intake::ScanOutcome& scan, const std::string& release, report::Report& report) {
  if (!release.empty()) report.fields["release"] = release;
  report.fields["input"] = scan.sensor.scan_name;
  report.fields["sensor"] = scan.sensor.name;
  report.fields["simulated"] = scan.sensor.simulated;
  report.fields["scan"] = intake::account_of(scan.counts, scan.sensor_counters, scan.sensor_stages);
  report.fields["devices"] = intake::account_of(scan.sensor_devices);
  report.fields["messages_lost"] = scan.messages_lost;
}

void say_line(LogLevel level, const char* pattern, std::va_list arguments) {
  char text[1024];
  std::vsnprintf(text, sizeof text, pattern, arguments);
  // One call: the link's thread and the result's both have something to say.
  std::printf("%s%s\n", level_prefix(STDOUT_FILENO, level), text);
  std::fflush(stdout);
}

}  // namespace

void log_step(const char* pattern, ...) {
  std::va_list arguments;
  va_start(arguments, pattern);
  say_line(LogLevel::Info, pattern, arguments);
  va_end(arguments);
}

void warn_step(const char* pattern, ...) {
  std::va_list arguments;
  va_start(arguments, pattern);
  say_line(LogLevel::Warning, pattern, arguments);
  va_end(arguments);
}

Result<LineStep> find_line(const fs::path& folder, const intake::ScanOutcome& scan, intake::LiveLine& line,
                           const KnownBefore& known, const std::string& release) {
  report::Report report;
  BITELINE_TRY(results::prepare_result_folder(folder));
  fill_scan(scan, release, report);
  if (scan.failure) return keep_unfinished(folder, scan, report);
  std::shared_ptr<const uncertainty::KnownHead> head;
  if (known.head) head = std::make_shared<const uncertainty::KnownHead>(scan.sensor.model, *known.head);
  line.close(std::move(head), known.arm);
  // Beside the line's own thread.
  BITELINE_ASSIGN(HeededPictures pictures, heed_pictures(folder, scan, known, report));
  intake::LiveLine::Outcome outcome = line.wait();
  if (pictures.refused) return std::move(*pictures.refused);
  report.add_stage("last profile to line", outcome.last_profile_to_line_s);
  bite_line::Extraction& extraction = outcome.extraction;
  intake::name_scan_cause(extraction, scan.counts, scan.sensor_counters, &scan.sensor_devices);
  BITELINE_ASSIGN(const ExitStatus status, results::write_line_files(folder, scan.cloud, extraction, report));
  if (status == ExitStatus::Done)
    log_step("%s", results::summary(extraction).c_str());
  else
    warn_step("%s", results::summary(extraction).c_str());
  LineStep step{.status = status, .confidence = extraction.confidence, .line = {}, .arm = extraction.arm};
  if (status != ExitStatus::Refused) step.line = extraction.line;
  step.pictures_vouched = pictures.vouched;
  step.too_little_seen = extraction.scan_cause.has_value();
  step.pages = LatePages{[folder, extraction = std::move(extraction),
                          stages = results::stages_of(std::move(outcome.workings)),
                          report](const cloud::PointCloud& cloud) mutable {
    return results::write_line_pages(folder, cloud, extraction, stages, report);
  }};
  return step;
}

Result<void> refuse_unknown(const fs::path& folder, const std::string& words, const std::string& release) {
  report::Report report;
  if (!release.empty()) report.fields["release"] = release;
  report.refuse(Refusal{.code = Refused::ModelUnknown, .reason = "the model is not known: " + words});
  BITELINE_TRY(results::prepare_result_folder(folder));
  BITELINE_TRY(report.write(folder));
  warn_step("refused: the model is not known: %s", words.c_str());
  return {};
}

Result<LineStep> carry_line(const fs::path& folder, const Carrier& carrier, const intake::ScanOutcome& scan,
                            const KnownBefore& known, const std::string& release) {
  report::Report report;
  if (!carrier.or_leave) BITELINE_TRY(results::prepare_result_folder(folder));
  fill_scan(scan, release, report);
  report.fields["sample"] = carrier.name;
  if (scan.failure) return keep_unfinished(folder, scan, report);
  BITELINE_ASSIGN(HeededPictures pictures, heed_pictures(folder, scan, known, report));
  if (pictures.refused) return std::move(*pictures.refused);
  transfer::TransferOptions options = carrier.options;
  transfer::Transfer transfer = report.timed("transfer", [&] {
    options.upper_scan = intake::whole_scan_of(scan, known.head, known.arm);
    return transfer::transfer_line(carrier.sample, scan.cloud, options);
  });
  if (carrier.or_leave && !transfer.found) {
    log_step("the line of %s has no say: %s", carrier.name.c_str(), transfer.reason().c_str());
    return LineStep{};
  }
  intake::name_scan_cause(transfer, scan.counts, scan.sensor_counters, &scan.sensor_devices);
  BITELINE_TRY(report.timed("write", [&] { return cloud::write_cloud(folder / "cloud.ply", scan.cloud); }));
  BITELINE_ASSIGN(const ExitStatus status,
                  results::write_transfer_files(folder, scan.cloud, transfer, report));
  if (status == ExitStatus::Done)
    log_step("%s", results::summary(transfer).c_str());
  else
    warn_step("%s", results::summary(transfer).c_str());
  LineStep step{
      .status = status, .confidence = transfer.confidence, .line = {}, .arm = options.upper_scan.arm};
  step.pictures_vouched = pictures.vouched;
  if (status == ExitStatus::Done) step.line = transfer.carried.line;
  step.pages =
      LatePages{[folder, transfer = std::move(transfer), report](const cloud::PointCloud& cloud) mutable {
        return results::write_transfer_pages(folder, cloud, transfer, report);
      }};
  return step;
}

Result<PlanStep> plan_path(const fs::path& folder, const PlanStepRequest& request,
                           const intake::ScanOutcome& scan, const cloud::ClosedLine& line) {
  path::PlanRequest plan_request;
  plan_request.process = request.process;
  plan_request.arm = request.arm;
  plan_request.table_z_mm = request.mounted.table_z_mm.value_or(request.table_z_mm);
  plan_request.fixture = request.fixture;
  plan_request.mounted = request.mounted;
  plan_request.near_rad = request.near_rad;
  plan_request.cloud = scan.cloud.points;
  return plan_again(folder, std::move(plan_request), line);
}

Result<PlanStep> plan_again(const fs::path& folder, path::PlanRequest plan_request, cloud::ClosedLine line) {
  report::Report report;
  BITELINE_TRY(results::prepare_plan_folder(folder));
  plan_request.line = std::move(line);
  path::PlanOutcome outcome = report.timed("plan", [&] { return path::plan(plan_request); });
  BITELINE_ASSIGN(const ExitStatus status, results::write_plan_result(folder, plan_request, outcome, report));
  // The scan's own page names the path, too.
  BITELINE_TRY(results::write_file_list(folder.parent_path()));
  if (outcome.path) {
    log_step("%s follows the line in %.1f s: every check passed", plan_request.arm.name.c_str(),
             outcome.path->duration_s());
  } else {
    warn_step("refused: no path: %s", outcome.reason().c_str());
  }
  return PlanStep{.status = status, .request = std::move(plan_request), .outcome = std::move(outcome)};
}

}  // namespace biteline::service
