// SPDX-License-Identifier: MIT
// biteline extract: the line in a scattered cloud.
#include <cstdio>

#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/method.hpp"
#include "host/records/results/line_result.hpp"

namespace biteline::app {
namespace {

struct ExtractOptions {
  std::filesystem::path cloud, out;
  std::optional<cloud::Unit> unit;
  Method method{Method::Default};
};

Result<ExitStatus> extract(const ExtractOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const cloud::CloudFile file,
                  report.timed("read", [&] { return cloud::read_cloud_file(options.cloud, options.unit); }));
  BITELINE_TRY(results::prepare_result_folder(options.out));
  report.fields["input"] = options.cloud.filename().string();
  report.fields["points_not_finite"] = file.dropped;
  if (const auto refusal = cloud::unit_refusal(file.cloud, options.unit)) {
    report.refuse(*refusal);
    BITELINE_TRY(report.write(options.out));
    return tell(report, global, "biteline: refused: " + refusal->reason);
  }
  const FoundLine found = report.timed("extract", [&] { return find_line(file.cloud, options.method); });
  BITELINE_TRY(results::write_line_result(options.out, file.cloud, found.extraction, found.stages, report));
  return tell(report, global, results::summary(found.extraction));
}

}  // namespace

void add_extract(options::Command& app, Context& context) {
  auto options = std::make_shared<ExtractOptions>();
  options::Command* command = app.add_subcommand("extract", "Find the bite line in a point cloud");
  command->add_option("cloud", options->cloud, std::string{"The cloud: "} + k_cloud_kinds)->required();
  add_unit_option(*command, options->unit);
  command->add_option("--out", options->out, "Folder for line.csv, report.json, stages/")->required();
  add_method_option(*command, options->method);
  command->callback([options, &context] {
    context.run = [options, &context] { return extract(*options, context.options); };
  });
}

}  // namespace biteline::app
