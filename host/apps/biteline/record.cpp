// SPDX-License-Identifier: MIT
// biteline record: recordings as one MCAP file, back again, and whether a file is what was written.
#include <cstdio>
#include <memory>
#include <optional>

#include "common/mcap/verify.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/recording/export.hpp"
#include "host/records/recording/import.hpp"
#include "host/records/recording/refused.hpp"
#include "host/report/progress.hpp"

namespace biteline::app {
namespace {

constexpr const char* k_program = "biteline " BITELINE_VERSION;

struct RecordOptions {
  std::filesystem::path input, out, results;
  std::string last_link;
  bool stored{false}, ros2{false};
};

template <class Counts>
void add_counts(report::Report& report, const Counts& counts) {
  report.fields["pictures"] = counts.pictures;
  report.fields["poses"] = counts.poses;
  report.fields["messages"] = counts.messages;
  report.fields["files"] = counts.files;
}

template <class Counts>
std::string counts_text(const Counts& counts) {
  return std::to_string(counts.pictures) + " pictures, " + std::to_string(counts.poses) + " poses, " +
         std::to_string(counts.messages) + " messages of the scan";
}

void warn(const std::filesystem::path& file, const std::string& what) {
  std::fprintf(stderr, "biteline: %s: %s\n", file.c_str(), what.c_str());
}

Result<ExitStatus> export_recording(const RecordOptions& options, const GlobalOptions& global) {
  report::Report report;
  std::optional<report::Progress> progress;
  BITELINE_ASSIGN(const recording::Exported exported, recording::export_mcap({
                                                          .input = options.input,
                                                          .out = options.out,
                                                          .results = options.results,
                                                          .library = k_program,
                                                          .build = k_program,
                                                          .packed = !options.stored,
                                                          .ros2 = options.ros2,
                                                          .progress =
                                                              [&](std::size_t done, std::size_t total) {
                                                                if (!progress)
                                                                  progress.emplace("pictures", total,
                                                                                   global.quiet);
                                                                progress->set(done);
                                                              },
                                                      }));
  progress.reset();
  if (!exported.lacks.empty()) {
    report.fields["scan_lacks"] = exported.lacks;
    warn(options.input, exported.lacks);
  }
  report.fields["file"] = options.out.filename().string();
  add_counts(report, exported);
  report.fields["last_link"] = exported.last_link;
  return tell(report, global,
              options.out.string() + ": " + counts_text(exported) + "; last link " + exported.last_link);
}

Result<ExitStatus> import_recording(const RecordOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const recording::Imported imported, recording::import_mcap(options.input, options.out));
  if (!imported.lacks.empty()) {
    report.fields["file_lacks"] = imported.lacks;
    report.fields["pictures_without_pose"] = imported.pictures_without_pose;
    warn(options.input, "cut or damaged at " + imported.lacks + "; what is before that was taken");
  }
  add_counts(report, imported);
  report.fields["left_out"] = imported.strange;
  return tell(report, global, options.out.string() + ": " + counts_text(imported));
}

Result<ExitStatus> verify_recording(const RecordOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const mcap::Verdict verdict, mcap::verify(options.input));
  report.fields["library"] = verdict.library;
  report.fields["messages"] = verdict.messages;
  report.fields["chunks"] = verdict.chunks;
  report.fields["attachments"] = verdict.attachments;
  report.fields["metadata"] = verdict.metadata;
  report.fields["links"] = verdict.links;
  report.fields["last_link"] = verdict.last_link;
  report.fields["all_check_sums"] = verdict.check_sums;
  auto& topics = report.fields["topics"] = nlohmann::ordered_json::object();
  for (const auto& [topic, count] : verdict.topics)
    topics[topic] = {{"messages", count.messages}, {"sha256", count.sha256}};
  auto& faults = report.fields["faults"] = nlohmann::ordered_json::array();
  for (const mcap::Fault& fault : verdict.faults)
    faults.push_back({{"at_byte", fault.at}, {"what", fault.what}});

  std::string words;
  if (!verdict.faults.empty()) {
    const mcap::Fault& first = verdict.faults.front();
    const std::uint64_t more = verdict.faults.size() - 1 + verdict.more_faults;
    words = "byte " + std::to_string(first.at) + ": " + first.what;
    if (more > 0) words += " (and " + std::to_string(more) + " more faults)";
    report.refuse(recording::Refusal{.code = recording::Refused::Damaged, .reason = words});
  } else if (!options.last_link.empty() && options.last_link != verdict.last_link) {
    words = "its last link is " + (verdict.last_link.empty() ? "missing" : verdict.last_link);
    report.refuse(recording::Refusal{.code = recording::Refused::OtherLink, .reason = words});
  } else {
    words = "whole: " + std::to_string(verdict.messages) + " messages in " + std::to_string(verdict.chunks) +
            " chunks";
    words += verdict.links > 0 ? "; last link " + verdict.last_link : "; without a hash chain";
    if (!verdict.check_sums) words += "; some check sums are not there";
  }
  return tell(report, global, options.input.string() + ": " + words);
}

}  // namespace

void add_record(options::Command& app, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  options::Command* command = app.add_subcommand("record", "Recordings as one MCAP file, and back");
  command->require_subcommand(1);

  options::Command* to_file =
      command->add_subcommand("export", "Write a session or a scan.btln as one MCAP file");
  to_file->add_option("recording", options->input, "The session's folder, or scan.btln")->required();
  to_file->add_option("--out", options->out, "The MCAP file; nothing is overwritten")->required();
  to_file->add_option("--results", options->results,
                      "A result folder whose report.json, line.csv and gate.json go along");
  to_file->add_flag("--stored", options->stored, "Chunks as they are, not packed by zstd");
  to_file->add_flag("--ros2", options->ros2,
                    "Poses and points also as ROS 2's messages (PoseStamped, PointCloud2; metres, base)");
  to_file->callback([options, &context] {
    context.run = [options, &context] { return export_recording(*options, context.options); };
  });

  options::Command* from_file =
      command->add_subcommand("import", "Write what an MCAP file holds as a session or a scan.btln");
  from_file->add_option("file", options->input, "The MCAP file; of a cut one all before the cut")->required();
  from_file->add_option("--out", options->out, "Folder, made here; nothing is overwritten")->required();
  from_file->callback([options, &context] {
    context.run = [options, &context] { return import_recording(*options, context.options); };
  });

  options::Command* judge = command->add_subcommand(
      "verify", "Check every sum, index, count and link of an MCAP file; exit status 3 where one is wrong");
  judge->add_option("file", options->input, "The MCAP file, of any program")->required();
  judge->add_option("--last-link", options->last_link,
                    "The last link that export told: who kept it sees any later change");
  judge->callback([options, &context] {
    context.run = [options, &context] { return verify_recording(*options, context.options); };
  });
}

}  // namespace biteline::app
