// SPDX-License-Identifier: MIT
// biteline rework: what a second look misses becomes a path of its own, once.
#include <memory>

#include "common/core/fixed_text.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/plan_options.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/look/rework_files.hpp"
#include "host/records/results/coverage_result.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/robot/path/zones.hpp"
#include "host/second_look/rework.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using look::LookRead;
using second_look::NoRework;
using second_look::Rework;

struct ReworkOptions {
  fs::path first, look, process, out;
  CellOptions cell;
  bool narrow{false};
  std::string decided_by;
};

/// The look is one of this line and this process: what it misses is theirs.
Result<LookRead> read_own_look(const ReworkOptions& options) {
  BITELINE_ASSIGN(LookRead look, look::read_look(options.look));
  BITELINE_ASSIGN(const std::string line, digest_of_file(options.first / "line.csv"));
  if (line != look.line_sha256)
    return fail(Errc::InvalidArgument, "%s looked at another line than that of %s", options.look.c_str(),
                options.first.c_str());
  BITELINE_ASSIGN(const std::string process, digest_of_file(options.process));
  if (process != look.process_sha256)
    return fail(Errc::InvalidArgument, "%s looked at the work of another process than %s",
                options.look.c_str(), options.process.c_str());
  return look;
}

Result<path::PlanRequest> read_request(const ReworkOptions& options, const LookRead& look,
                                       const Rework& rework, report::Report& report) {
  path::PlanRequest request;
  BITELINE_ASSIGN(path::Process process, path::read_process(options.process));
  request.process = path::on_foot(std::move(process), look.foot);
  BITELINE_TRY(take_cell(options.cell, request, report));
  BITELINE_ASSIGN(request.line, cloud::read_line(options.first / "line.csv"));
  const fs::path cloud_file = options.first / "cloud.ply";
  BITELINE_ASSIGN(cloud::CloudFile cloud, cloud::read_cloud_file(cloud_file));
  BITELINE_TRY(near_origin(cloud, cloud_file));
  request.cloud = std::move(cloud.cloud.points);
  for (const second_look::ReworkPiece& piece : rework.pieces)
    request.process.only.push_back({.from_mm = piece.along.from_mm, .to_mm = piece.along.to_mm});
  return request;
}

nlohmann::ordered_json rework_json(const ReworkOptions& options, const LookRead& look, const Rework& rework) {
  nlohmann::ordered_json pieces = nlohmann::ordered_json::array();
  for (const second_look::ReworkPiece& piece : rework.pieces)
    pieces.push_back(
        {{"from_mm", piece.along.from_mm}, {"to_mm", piece.along.to_mm}, {"faults", piece.faults}});
  return {{"look", options.look.filename().string()},
          {"look_sha256", look.sha256},
          {"pieces", pieces},
          {"for_a_person", rework.for_a_person},
          {"decided_by", options.decided_by}};
}

/// Why nothing is worked once more; none: there are pieces, and this is the first time or a person's word.
std::optional<report::Refusal<NoRework>> why_not(const ReworkOptions& options, const LookRead& look,
                                                 const Rework& rework, std::size_t before) {
  using Refusal = report::Refusal<NoRework>;
  if (before > 0 && options.decided_by.empty())
    return Refusal{.code = NoRework::ReworkedBefore,
                   .reason = "what this shoe missed was worked once more already: a person decides"};
  if (look.refused || look.faults.empty())
    return Refusal{
        .code = NoRework::NothingMissing,
        .reason = look.refused ? "the look was refused: it tells of nothing" : "the look tells of no fault"};
  if (!rework.pieces.empty()) return std::nullopt;
  return Refusal{
      .code = NoRework::ForAPerson,
      .reason = FixedText<160>::format("none of the %zu faults goes away without working more than "
                                       "%.0f mm twice",
                                       look.faults.size(), second_look::k_most_twice_mm)
                    .c_str()};
}

std::string summary(const path::PlanOutcome& outcome, const Rework& rework, const fs::path& out) {
  if (!outcome.path) return "biteline: refused: " + outcome.reason();
  std::string words = FixedText<300>::format("%zu pieces once more in %.1f s: %s", rework.pieces.size(),
                                             outcome.path->duration_s(), out.c_str())
                          .c_str();
  if (!rework.for_a_person.empty())
    words += FixedText<80>::format("; %zu faults for a person", rework.for_a_person.size()).view();
  return words;
}

Result<ExitStatus> rework(const ReworkOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(results::prepare_plan_folder(options.out));
  BITELINE_ASSIGN(const LookRead look, read_own_look(options));
  BITELINE_ASSIGN(const std::size_t before, look::reworks_of(options.first));
  const Rework pieces =
      second_look::rework_of(look.faults, look.plan, look.line_mm, {.narrow = options.narrow});
  report.fields["rework"] = rework_json(options, look, pieces);
  if (const auto refusal = why_not(options, look, pieces, before)) {
    report.refuse(*refusal);
    BITELINE_TRY(report.write(options.out));
    return tell(report, global, "biteline: refused: " + refusal->reason);
  }
  BITELINE_ASSIGN(const path::PlanRequest request,
                  report.timed("read", [&] { return read_request(options, look, pieces, report); }));
  const path::PlanOutcome outcome = report.timed("plan", [&] { return path::plan(request); });
  if (outcome.path)
    BITELINE_TRY(look::record_rework(
        options.first,
        {.look_sha256 = look.sha256, .pieces = pieces.pieces.size(), .decided_by = options.decided_by}));
  BITELINE_TRY(report.timed_aside(
      "coverage", [&] { return results::write_coverage(options.out, request, outcome, report); }));
  BITELINE_TRY(results::write_plan_result(options.out, request, outcome, report));
  return tell(report, global, summary(outcome, pieces, options.out));
}

}  // namespace

void add_rework(options::Command& app, Context& context) {
  auto options = std::make_shared<ReworkOptions>();
  options::Command* command =
      app.add_subcommand("rework", "Plan a path over what a second look misses: once, then a person decides");
  command->add_option("FIRST", options->first, "Folder of the scan before the work: cloud.ply and line.csv")
      ->required();
  command->add_option("LOOK", options->look, "Folder of the look: the report of 'inspect'")->required();
  command->add_option("--process", options->process, "Process YAML: the one that the look was told")
      ->required();
  command->add_option("--out", options->out, "Folder for path.csv, path.script, report.json")->required();
  command->add_flag("--narrow", options->narrow,
                    "Also where the band is only too narrow: all of its width is worked twice there");
  command->add_option("--decided-by", options->decided_by,
                      "Who has decided on working it again, after the first time");
  add_cell_options(*command, options->cell);
  command->callback([options, &context] {
    context.run = [options, &context] { return rework(*options, context.options); };
  });
}

}  // namespace biteline::app
