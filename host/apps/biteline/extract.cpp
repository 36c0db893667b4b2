// SPDX-License-Identifier: MIT
// biteline extract: the line in a scattered cloud.
#include <cstdio>

#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/method.hpp"
#include "host/apps/biteline/other_reading.hpp"
#include "host/cloud/ply_file.hpp"
#include "host/records/results/line_result.hpp"

namespace biteline::app {
namespace {

struct ExtractOptions {
  std::filesystem::path cloud, out;
  cloud::Reading reading;
  Method method{Method::Default};
};

/// A cloud that is to be read otherwise: report.json alone.
Result<ExitStatus> refuse(const ExtractOptions& options, report::ToldRefusal refusal,
                          const cloud::CloudFile& file, report::Report& report, const GlobalOptions& global) {
  const std::string words = "biteline: refused: " + refusal.reason + " (read: " + file.understood + ")";
  report.refuse(std::move(refusal));
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, words);
}

/// Files from far away get their line and cloud back where they were.
Result<void> put_back(const std::filesystem::path& out, const cloud::CloudFile& file,
                      cloud::ClosedLine line) {
  if (file.origin.isZero()) return {};
  BITELINE_TRY(cloud::write_far_cloud(out / "cloud.ply", file.cloud, file.origin));
  if (line.points.empty()) return {};
  for (cloud::LinePoint& point : line.points) point.position += file.origin;
  return cloud::write_line(out / "line.csv", line);
}

Result<ExitStatus> extract(const ExtractOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const cloud::CloudFile file, report.timed("read", [&] {
    return cloud::read_cloud_file(options.cloud, options.reading);
  }));
  BITELINE_TRY(results::prepare_result_folder(options.out));
  report.fields["input"] = options.cloud.filename().string();
  report.fields["points_not_finite"] = file.dropped;
  report.fields["cloud_file"] = as_json(file, options.reading);
  const auto other = [&] { return other_reading(options.cloud, options.reading, file); };
  if (const auto refusal = cloud::unit_refusal(file)) {
    report::ToldRefusal told = report.timed("other_reading", other).value_or(report::told(*refusal));
    return refuse(options, std::move(told), file, report, global);
  }
  const FoundLine found = report.timed("extract", [&] { return find_line(file.cloud, options.method); });
  if (found.extraction.verdict() == bite_line::Verdict::Refused &&
      may_lie_otherwise(found.extraction.refusal->code)) {
    if (auto told = report.timed("other_reading", other))
      return refuse(options, std::move(*told), file, report, global);
  }
  BITELINE_TRY(results::write_line_result(options.out, file.cloud, found.extraction, found.stages, report));
  BITELINE_TRY(put_back(options.out, file, found.extraction.line));
  const std::string summary = results::summary(found.extraction);
  return tell_folder(report, global,
                     found.extraction.found ? "read: " + file.understood + "\n" + summary
                                            : summary + " (read: " + file.understood + ")",
                     options.out, found.extraction.told(), plan_step(options.out));
}

}  // namespace

void add_extract(options::Command& app, Context& context) {
  auto options = std::make_shared<ExtractOptions>();
  options::Command* command = app.add_subcommand("extract", "Find the bite line in a point cloud");
  command->add_option("cloud", options->cloud, std::string{"The cloud: "} + k_cloud_kinds)->required();
  add_reading_options(*command, options->reading);
  command->add_option("--out", options->out, "Folder for line.csv, report.json, stages/")->required();
  add_method_option(*command, options->method);
  command->callback([options, &context] {
    context.run = [options, &context] { return extract(*options, context.options); };
  });
}

}  // namespace biteline::app
