// SPDX-License-Identifier: MIT
// biteline extract: the line in a scattered cloud.
#include <cstdio>

#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/method.hpp"
#include "host/cloud/ply.hpp"
#include "host/results/line_result.hpp"

namespace biteline::app {
namespace {

struct Options {
  std::filesystem::path cloud, out;
  Method method{Method::Default};
};

Result<ExitStatus> extract(const Options& options, const GlobalOptions& global) {
  report::Report report;
  std::size_t dropped = 0;
  BITELINE_ASSIGN(const cloud::PointCloud cloud,
                  report.timed("read", [&] { return cloud::read_cloud(options.cloud, &dropped); }));
  BITELINE_TRY(results::prepare_result_folder(options.out));
  const FoundLine found = report.timed("extract", [&] { return find_line(cloud, options.method); });
  report.fields["input"] = options.cloud.filename().string();
  report.fields["points_not_finite"] = dropped;
  BITELINE_TRY(results::write_line_result(options.out, cloud, found.extraction, found.stages, report));
  return tell(report, global, results::summary(found.extraction));
}

}  // namespace

void add_extract(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("extract", "Find the bite line in a point cloud (PLY, mm)");
  command->add_option("cloud", options->cloud, "The cloud: PLY, properties x y z in mm")->required();
  command->add_option("--out", options->out, "Folder for line.csv, report.json, stages/")->required();
  add_method_option(*command, options->method);
  command->callback([options, &context] {
    context.run = [options, &context] { return extract(*options, context.options); };
  });
}

}  // namespace biteline::app
