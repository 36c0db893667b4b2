// SPDX-License-Identifier: MIT
#include "host/records/batch/work.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/core/fixed_text.hpp"
#include "common/system/file.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, gone with its owner.
class Scratch {
 public:
  static Result<Scratch> make() {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    std::string pattern = (temporary / "biteline-batch-XXXXXX").string();
    if (error || ::mkdtemp(pattern.data()) == nullptr)
      return fail_errno(Errc::WriteFailed, errno, "scratch folder %s", pattern.c_str());
    return Scratch{pattern};
  }
  Scratch(Scratch&& other) noexcept : path_{std::move(other.path_)} { other.path_.clear(); }
  Scratch& operator=(Scratch&&) = delete;
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  explicit Scratch(fs::path path) : path_{std::move(path)} {}
  fs::path path_;
};

std::string without(std::string text, const std::string& part) {
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part)) text.erase(at, part.size());
  return text;
}

void add(Cost& cost, const ProcessEnd& end) {
  cost.wall_s += end.wall_s;
  cost.cpu_s += end.cpu_s;
  cost.peak_memory_mb = std::max(cost.peak_memory_mb, end.peak_memory_mb);
}

/// The outcome of a process that gave no result.  `scratch` has another name each time, so it is left out.
Outcome without_result(const ProcessEnd& end, const char* program, const ProcessLimits& limits,
                       const fs::path& scratch) {
  using Text = FixedText<160>;
  Outcome outcome;
  const std::string words = without(end.last_words, scratch.string());
  if (words.find("out of memory") != std::string::npos) {
    outcome.verdict = "out_of_memory";
    outcome.reason = Text::format("%s: more than %.0f MB wanted", program, limits.memory_mb).c_str();
  } else if (end.how == ProcessEnd::How::TimedOut) {
    outcome.verdict = "timed_out";
    outcome.reason = Text::format("%s: killed after %.6g s", program, limits.time_s).c_str();
  } else if (end.how == ProcessEnd::How::Signalled) {
    outcome.verdict = "crashed";
    outcome.reason = Text::format("%s: signal %d (%s)", program, end.status, ::strsignal(end.status)).c_str();
  } else {
    outcome.verdict = end.status == static_cast<int>(ExitStatus::BadInput) ? "unreadable" : "failed";
    outcome.reason = words.empty() ? Text::format("%s: exit status %d", program, end.status).c_str() : words;
  }
  return outcome;
}

/// What report.json says; the figures that are there.
Result<Outcome> read_report(const fs::path& file) {
  BITELINE_ASSIGN(const nlohmann::ordered_json json, read_json_object(file));
  const JsonFields fields{json, file};
  Outcome outcome;
  BITELINE_ASSIGN(outcome.verdict, fields.text("status"));
  outcome.reason_code = fields.text("reason_code").value_or("");
  outcome.reason = fields.text("reason").value_or("");
  BITELINE_ASSIGN(outcome.length_mm, fields.number_if("length_mm"));
  BITELINE_ASSIGN(outcome.confidence, fields.number_if("confidence"));
  BITELINE_ASSIGN(outcome.bridged_mm, fields.number_if("bridged_mm"));
  if (const auto u95 = fields.object("u95")) {
    const JsonFields parts{**u95, file};
    BITELINE_ASSIGN(outcome.u95_mm, parts.number_if("pooled_mm"));
    BITELINE_ASSIGN(outcome.u95_max_mm, parts.number_if("max_mm"));
  }
  return outcome;
}

/// Reads the line and judges it; line.csv becomes part of `worked`.
Result<void> take_line(Worked& worked, const fs::path& line_file, const fs::path& truth_file) {
  BITELINE_ASSIGN(worked.line_csv, read_regular_file(line_file, k_most_table_bytes));
  worked.outcome.line_hash = Digest{}.add(worked.line_csv).hex();
  if (truth_file.empty()) return {};
  BITELINE_ASSIGN(const cloud::ClosedLine line, cloud::read_line(line_file));
  BITELINE_ASSIGN(const cloud::ClosedLine truth, cloud::read_positions(truth_file));
  judge_by_truth(worked.outcome, line, truth);
  return {};
}

std::vector<std::string> arguments_for(RecordingKind kind, const fs::path& path,
                                       const BatchSettings& settings, const fs::path& out) {
  const bool session = kind == RecordingKind::Session || kind == RecordingKind::MadeSession;
  std::vector<std::string> words{session ? "replay" : "extract", path.string()};
  if (!session && !settings.unit.empty()) words.insert(words.end(), {"--unit", settings.unit});
  words.insert(words.end(), {"--method", settings.method, "--out", out.string(), "--quiet"});
  return words;
}

std::optional<Outcome> changed_since_planned(const Recording& recording) {
  const Result<Fingerprint> now = fingerprint(recording.kind, recording.path);
  if (now && now->hash == recording.hash) return std::nullopt;
  Outcome outcome;
  outcome.verdict = "changed";
  outcome.reason = now ? "other contents than when it was planned" : to_line(now.error());
  return outcome;
}

}  // namespace

Result<BatchBuild> build_of(const fs::path& program, const fs::path& cell) {
  Digest digest;
  BITELINE_ASSIGN(const std::string own, digest_of_file(program));
  digest.add_text(own);
  const fs::path sensor = program.parent_path() / "biteline-sensor";
  std::error_code ignored;
  if (fs::exists(sensor, ignored)) {
    BITELINE_ASSIGN(const std::string sisters, digest_of_file(sensor));
    digest.add_text(sisters);
  }
  return BatchBuild{.program = fs::absolute(program), .cell = cell, .identity = digest.hex()};
}

Result<Worked> work_on(const Recording& recording, const BatchSettings& settings, const BatchBuild& build,
                       const ProcessLimits& limits) {
  BITELINE_ASSIGN(const Scratch scratch, Scratch::make());
  Worked worked;
  fs::path path = recording.path;
  if (is_made(recording.kind)) {
    const bool session = recording.kind == RecordingKind::MadeSession;
    std::vector<std::string> words{session ? "record" : "record-cloud"};
    words.insert(words.end(), recording.recipe.begin(), recording.recipe.end());
    words.insert(words.end(), {"--out", (scratch.path() / "made").string()});
    BITELINE_ASSIGN(const ProcessEnd made, run_limited(build.cell, words, scratch.path(), limits));
    path = session ? scratch.path() / "made" : scratch.path() / "made" / "cloud.ply";
    if (made.how != ProcessEnd::How::Exited || made.status != 0) {
      worked.outcome = without_result(made, "biteline-cell", limits, scratch.path());
      worked.outcome.verdict = "failed";  // not the recording's, and not the line's
      add(worked.cost, made);
      return worked;
    }
  } else if (std::optional<Outcome> changed = changed_since_planned(recording)) {
    worked.outcome = std::move(*changed);
    return worked;
  }

  const fs::path out = scratch.path() / "out";
  BITELINE_ASSIGN(
      const ProcessEnd end,
      run_limited(build.program, arguments_for(recording.kind, path, settings, out), scratch.path(), limits));
  add(worked.cost, end);
  const bool answered =
      end.how == ProcessEnd::How::Exited && (end.status == static_cast<int>(ExitStatus::Done) ||
                                             end.status == static_cast<int>(ExitStatus::Review) ||
                                             end.status == static_cast<int>(ExitStatus::Refused));
  if (!answered) {
    worked.outcome = without_result(end, "biteline", limits, scratch.path());
    return worked;
  }
  Result<Outcome> outcome = read_report(out / "report.json");
  if (outcome) worked.outcome = std::move(*outcome);
  const Result<void> line = !outcome ? Result<void>{}
                            : has_line(worked.outcome.verdict)
                                ? take_line(worked, out / "line.csv", truth_of(recording.kind, path))
                                : Result<void>{};
  if (!outcome || !line) {
    worked = {.outcome = {}, .cost = worked.cost, .line_csv = {}};
    worked.outcome.verdict = "failed";
    worked.outcome.reason =
        without(to_line(outcome ? line.error() : outcome.error()), scratch.path().string());
  }
  return worked;
}

}  // namespace biteline::batch
