// SPDX-License-Identifier: MIT
// biteline line: a found line for other people's programs.
#include "host/apps/biteline/line_edit.hpp"
#include "host/cloud/far_line.hpp"
#include "host/records/line_files/line_file.hpp"

namespace biteline::app {
namespace {

struct LineOptions {
  std::filesystem::path line, out;
};

Result<ExitStatus> export_line(const LineOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const cloud::ClosedLine line, cloud::read_far_line(options.line));
  BITELINE_TRY(line_files::write_line_file(options.out, line));
  report.fields["file"] = options.out.filename().string();
  report.fields["points"] = line.points.size();
  report.fields["length_mm"] = cloud::length_mm(line);
  return tell(report, global, "biteline: " + options.out.string() + " written");
}

}  // namespace

void add_line(options::Command& app, Context& context) {
  auto options = std::make_shared<LineOptions>();
  options::Command* command = app.add_subcommand("line", "Mend a found line, and give it to other programs");
  command->require_subcommand(1);
  add_line_edit(*command, context);
  options::Command* to_file =
      command->add_subcommand("export", "Write a line as CSV, PLY, DXF, STEP or JSON");
  to_file->add_option("line", options->line, "The line: line.csv of a result folder")->required();
  to_file->add_option("--out", options->out, "File: .csv .ply .dxf .step .stp or .json")->required();
  to_file->callback([options, &context] {
    context.run = [options, &context] { return export_line(*options, context.options); };
  });
}

}  // namespace biteline::app
