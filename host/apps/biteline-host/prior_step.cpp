// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/prior_step.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/bite_line/edit/prior.hpp"
#include "host/records/results/mended_result.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Text = FixedText<240>;

cloud::ClosedLine placed(const cloud::ClosedLine& line, const SE3& T_scan_model) {
  cloud::ClosedLine out = line;
  for (cloud::LinePoint& point : out.points) {
    point.position = T_scan_model * point.position;
    point.normal = T_scan_model.linear() * point.normal;
    point.tangent = T_scan_model.linear() * point.tangent;
  }
  return out;
}

/// Fails (Refused) where the model is not the scan's.
Result<OnScan> align_model(const transfer::SampleFiles& sample, const cloud::PointCloud& cloud) {
  BITELINE_ASSIGN(const transfer::Sample prepared, transfer::prepare_sample(sample.cloud, sample.line));
  BITELINE_ASSIGN(const transfer::Upper upper, transfer::prepare_upper(cloud));
  const transfer::Alignment alignment = transfer::align(prepared, upper, {});
  if (!alignment.accepted()) return fail(Errc::Refused, "%s", alignment.reason.c_str());
  return OnScan{.line = placed(sample.line, alignment.T_upper_sample), .sigma_mm = alignment.line_sigma_mm};
}

Json json_of(const std::string& model, const edit::OffPrior& off, int candidate) {
  return {{"model", model},
          {"candidate", candidate},
          {"mean_mm", off.mean_mm},
          {"most_mm", off.most_mm},
          {"u95_mm", off.u95_mm},
          {"most_at", {off.most_at.x(), off.most_at.y(), off.most_at.z()}},
          {"beyond_mm", off.beyond_mm}};
}

/// `prior` in the scan's report; what it says, on stdout.
Result<void> tell(const fs::path& folder, Json prior, const std::string& words) {
  log_step("%s", words.c_str());
  prior["words"] = words;
  BITELINE_ASSIGN(const std::string text, read_regular_file(folder / "report.json", k_most_settings_bytes));
  Json report = Json::parse(text, nullptr, false);
  if (!report.is_object())
    return fail(Errc::FileUnreadable, "%s is no report", (folder / "report.json").c_str());
  report["prior"] = std::move(prior);
  return report::write_file_atomically(folder / "report.json", report::to_text(report) + "\n");
}

/// The line as found, or the candidate that is nearer, as a new version.
Result<int> take_nearest(const fs::path& folder, const cloud::PointCloud& cloud,
                         const cloud::ClosedLine& prior, const std::string& model, LineStep& line) {
  const edit::OrRefusal<edit::Surface> surface = edit::Surface::of(cloud);
  if (!surface) return 1;
  const int candidate = edit::nearest_candidate(*surface, prior);
  if (candidate == 1) return 1;
  report::Report report;
  const results::MendOrder order{
      .steps = {{.kind = edit::Step::Kind::Candidate, .candidate = candidate}},
      .who = "model " + model,
      .why = "nearest to the model's mended line of the candidates that pass their gates",
      .by = edit::By::Model};
  BITELINE_ASSIGN(const edit::OrRefusal<results::MendedScan> taken,
                  results::mend_scan(folder, order, report));
  if (!taken) return 1;
  line = {.status = taken->status, .confidence = taken->confidence, .line = {}};
  if (taken->status == ExitStatus::Done) line.line = taken->line;
  log_step("%s", taken->words.c_str());
  return candidate;
}

}  // namespace

Result<LineStep> heed_mended_model(const fs::path& folder, LineStep found, const cloud::PointCloud& cloud,
                                   const MendedModel& model) {
  if (!found.line || found.status != ExitStatus::Done || !edit::is_mended(model.sample.line)) return found;
  // Before the report gets what follows, and the line perhaps another version.
  BITELINE_TRY(found.pages.write(cloud));
  const Result<OnScan> on_scan =
      model.on_scan ? Result<OnScan>{*model.on_scan} : align_model(model.sample, cloud);
  if (!on_scan) {
    BITELINE_TRY(tell(
        folder, {{"model", model.name}},
        "the mended line of " + model.name + " has no say: " + std::string{on_scan.error().where.view()}));
    return found;
  }
  const cloud::ClosedLine& prior = on_scan->line;
  edit::OffPrior off = edit::off_prior(*found.line, prior, on_scan->sigma_mm);
  int candidate = 1;
  if (off.beyond_mm > 0) {
    BITELINE_ASSIGN(candidate, take_nearest(folder, cloud, prior, model.name, found));
    if (candidate > 1 && found.line) off = edit::off_prior(*found.line, prior, on_scan->sigma_mm);
  }
  Json prior_json = json_of(model.name, off, candidate);
  Text words = Text::format("the line keeps to the mended line of %.64s: %.2f mm off at most",
                            model.name.c_str(), off.most_mm);
  if (off.beyond_mm > 0) {
    words = Text::format(
        "the line lies up to %.1f mm off the mended line of %.64s, where the difference is known to %.1f mm, "
        "and %.0f mm of it beyond what is known",
        off.most_mm, model.name.c_str(), off.u95_mm, off.beyond_mm);
    const report::ToldRefusal told =
        report::told(Refusal{.code = Refused::LineOffMended, .reason = words.c_str()});
    prior_json["reason_code"] = told.reason_code;
    prior_json["next_step"] = told.next_step;
  }
  BITELINE_TRY(tell(folder, std::move(prior_json), words.c_str()));
  return found;
}

}  // namespace biteline::service
