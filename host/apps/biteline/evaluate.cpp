// SPDX-License-Identifier: MIT
// biteline evaluate: a result against a truth.
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/core/fixed_text.hpp"
#include "common/csv/table.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/bite_line/evaluation/cloud_error.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/cloud/far_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/report/json_text.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
  fs::path line, truth, cloud, surface;
  cloud::Reading reading;
  bool align{false};
};

/// The shoe's z in base, from T_base_shoe.txt beside the truth; base z without one (the shoe stands on a
/// level table).
Vec3 up_beside(const fs::path& truth) {
  const Result<std::string> text =
      read_regular_file(truth.parent_path() / "T_base_shoe.txt", k_most_settings_bytes);
  std::istringstream file{text.value_or("")};
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 16; ++i) {
    if (!(file >> T(i / 4, i % 4))) return Vec3::UnitZ();
  }
  const Vec3 up = T.block<3, 1>(0, 2);
  return std::abs(up.norm() - 1) < 1e-3 ? Vec3(up.normalized()) : Vec3::UnitZ();
}

ExitStatus tell_figures(const nlohmann::ordered_json& figures, const GlobalOptions& global) {
  report::Report report;
  report.fields = figures;
  std::string words;
  for (const auto& [name, value] : figures.items()) {
    if (!value.is_number()) continue;
    if (!words.empty()) words += '\n';
    words += FixedText<80>::format("%-12s %.5g", name.c_str(), value.get<double>()).view();
  }
  // The figures are the result: --quiet leaves them.
  return tell(report, {.quiet = false, .json = global.json}, words);
}

Result<ExitStatus> evaluate_line(const EvaluateOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const cloud::ClosedLine result, cloud::read_far_line(options.line));
  BITELINE_ASSIGN(const cloud::ClosedLine truth, cloud::read_far_positions(options.truth));
  const evaluation::LineError error =
      options.align ? evaluation::line_error_aligned(result, truth) : evaluation::line_error(result, truth);
  nlohmann::ordered_json figures{{"mean", error.mean_mm},
                                 {"p95", error.p95_mm},
                                 {"max", error.max_mm},
                                 {"complete", error.complete},
                                 {"points", result.points.size()}};
  const fs::path beside = options.truth.parent_path() / "reference.ply";
  const fs::path surface =
      !options.surface.empty() ? options.surface : (fs::exists(beside) ? beside : fs::path{});
  if (!surface.empty()) {
    BITELINE_ASSIGN(const cloud::TriangleMesh mesh, cloud::read_mesh(surface));
    cloud::ClosedLine placed = result;
    for (auto& p : placed.points) {
      p.position = error.T_truth_line * p.position;
      p.normal = error.T_truth_line.linear() * p.normal;
    }
    if (const auto angle_deg = evaluation::normal_error_deg(placed, evaluation::ReferenceSurface{mesh},
                                                            up_beside(options.truth))) {
      figures["normal_deg"] = *angle_deg;
    }
  }
  return tell_figures(figures, global);
}

Result<ExitStatus> evaluate_cloud(const EvaluateOptions& options, const GlobalOptions& global) {
  BITELINE_ASSIGN(const cloud::CloudFile file, cloud::read_cloud_file(options.cloud, options.reading));
  BITELINE_TRY(near_origin(file, options.cloud));
  const cloud::PointCloud& cloud = file.cloud;
  BITELINE_ASSIGN(const cloud::TriangleMesh mesh, cloud::read_mesh(options.surface));
  const evaluation::ReferenceSurface surface{mesh};
  const evaluation::CloudError error = options.align ? evaluation::cloud_error_aligned(cloud, surface)
                                                     : evaluation::cloud_error(cloud, surface);
  if (error.points == 0) {
    return fail(Errc::BadValue, "%s: no point within %.0f mm of %s (another frame?)", options.cloud.c_str(),
                evaluation::k_surface_reach_mm, options.surface.c_str());
  }
  return tell_figures({{"mean", error.mean_mm},
                       {"rms", error.rms_mm},
                       {"pos", error.mean_positive_mm},
                       {"neg", error.mean_negative_mm},
                       {"q001", error.q001_mm},
                       {"q999", error.q999_mm},
                       {"min", error.min_mm},
                       {"max", error.max_mm},
                       {"points", error.points},
                       {"points_far", error.points_far},
                       {"cloud_file", as_json(file, options.reading)}},
                      global);
}

}  // namespace

void add_evaluate(options::Command& app, Context& context) {
  auto options = std::make_shared<EvaluateOptions>();
  options::Command* command =
      app.add_subcommand("evaluate", "Measure a result against a truth (mm, degrees)");
  auto* line = command->add_option("--line", options->line, "A line.csv to measure");
  auto* truth = command->add_option("--truth", options->truth, "The true line: rows that begin with x, y, z");
  auto* cloud =
      command->add_option("--cloud", options->cloud, std::string{"A cloud to measure: "} + k_cloud_kinds);
  add_reading_options(*command, options->reading);
  command->add_option("--surface", options->surface,
                      "The true surface, a PLY mesh; with --line it serves the normals' error");
  command->add_flag("--align", options->align, "Measure after the best rigid alignment");
  line->needs(truth);
  truth->needs(line);
  cloud->excludes(line);
  command->callback([options, &context] {
    context.run = [options, &context]() -> Result<ExitStatus> {
      if (!options->line.empty()) return evaluate_line(*options, context.options);
      if (options->cloud.empty())
        return fail(Errc::InvalidArgument, "evaluate: --line with --truth, or --cloud with --surface");
      if (options->surface.empty()) return fail(Errc::InvalidArgument, "evaluate: --cloud needs --surface");
      return evaluate_cloud(*options, context.options);
    };
  });
}

}  // namespace biteline::app
