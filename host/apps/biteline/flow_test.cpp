// SPDX-License-Identifier: MIT
// biteline flow-test: strokes on a plate, and what their films tell of gun and pump.
#include <memory>
#include <numbers>

#include "common/core/fixed_text.hpp"
#include "common/csv/table.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/plan_options.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/robot/path/flow_test.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using options::number;
using path::FlowFit;
using path::FlowStroke;
using path::MeasuredStroke;

constexpr double k_ms_per_s = 1e3;

struct FlowTestOptions {
  fs::path process, out, measured;
  CellOptions cell;
  std::vector<double> at{0, 0, 0, 0};  // x y z [mm], turn [deg]
};

Result<path::PlanRequest> read_request(const FlowTestOptions& options, report::Report& report) {
  path::PlanRequest request;
  BITELINE_ASSIGN(request.process, path::read_process(options.process));
  BITELINE_TRY(take_cell(options.cell, request, report));
  BITELINE_TRY(path::ask_for_flow_test(request, {.middle = Vec3{options.at[0], options.at[1], options.at[2]},
                                                 .turn_rad = options.at[3] * std::numbers::pi / 180}));
  return request;
}

/// A row for each stroke; its last three fields are for whoever measures.
std::string stroke_table(const std::vector<FlowStroke>& strokes, const SE3& T_line_base) {
  std::string table =
      "#stroke,begins x [mm],y [mm],z [mm],ends x [mm],y [mm],z [mm],speed [mm/s],step at [mm],"
      "film begins behind [mm],film ends behind [mm],widest at the step over its width []\n";
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const Vec3 a = T_line_base * strokes[i].begins_base, b = T_line_base * strokes[i].ends_base;
    table += FixedText<300>::format("%zu,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,", i + 1, a.x(), a.y(), a.z(),
                                    b.x(), b.y(), b.z(), strokes[i].speed_mm_s)
                 .view();
    if (strokes[i].step_mm) table += FixedText<40>::format("%.2f", *strokes[i].step_mm).view();
    table += ",,,\n";
  }
  return table;
}

Result<std::vector<MeasuredStroke>> read_measured(const fs::path& file) {
  std::vector<MeasuredStroke> measured;
  BITELINE_TRY(csv::read_table(file, 12, 12, [&](const csv::Row& row) -> Result<void> {
    MeasuredStroke stroke;
    BITELINE_ASSIGN(const double index, row.number(0));
    if (index != static_cast<double>(measured.size() + 1))
      return fail(Errc::BadValue, "%s row %d: stroke %zu expected", file.c_str(), row.number(),
                  measured.size() + 1);
    BITELINE_ASSIGN(stroke.begin_mm, row.number(9));
    BITELINE_ASSIGN(stroke.end_mm, row.number(10));
    if (!row.text(11).empty()) {
      BITELINE_ASSIGN(stroke.widest_ratio, row.number(11, {.minimum = 1, .maximum = 5}));
    }
    measured.push_back(stroke);
    return {};
  }));
  return measured;
}

nlohmann::ordered_json fit_json(const FlowFit& fit) {
  return {{"gun_on_ms", k_ms_per_s * fit.gun_on_s},
          {"gun_off_ms", k_ms_per_s * fit.gun_off_s},
          {"lag_ms",
           fit.lag_s ? nlohmann::ordered_json(k_ms_per_s * *fit.lag_s) : nlohmann::ordered_json(nullptr)},
          {"shift_mm", fit.shift_mm},
          {"rms_mm", fit.rms_mm}};
}

std::string words_of(const FlowFit& fit) {
  std::string words = FixedText<200>::format("gun_on_ms: %.0f\ngun_off_ms: %.0f\n", k_ms_per_s * fit.gun_on_s,
                                             k_ms_per_s * fit.gun_off_s)
                          .c_str();
  if (fit.lag_s) words += FixedText<80>::format("lag_ms: %.0f\n", k_ms_per_s * *fit.lag_s).view();
  return words + FixedText<120>::format("the plate lay off by %.2f mm; %.2f mm are left (rms)", fit.shift_mm,
                                        fit.rms_mm)
                     .c_str();
}

Result<ExitStatus> flow_test(const FlowTestOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(results::prepare_plan_folder(options.out));
  BITELINE_ASSIGN(const path::PlanRequest request, read_request(options, report));
  const path::PlanOutcome outcome = report.timed("plan", [&] { return path::plan(request); });
  if (!outcome.path || options.measured.empty()) {
    if (outcome.path)
      BITELINE_TRY(report::write_file_atomically(
          options.out / "strokes.csv",
          stroke_table(path::flow_strokes(outcome.path->path()), request.T_line_base)));
    BITELINE_TRY(results::write_plan_result(options.out, request, outcome, report));
    return tell(report, global,
                outcome.path ? "strokes to be laid and measured: " + (options.out / "strokes.csv").string()
                             : "biteline: refused: " + outcome.reason());
  }
  BITELINE_ASSIGN(const std::vector<MeasuredStroke> measured, read_measured(options.measured));
  BITELINE_ASSIGN(const FlowFit fit, path::fit_flow(outcome.path->path(), measured));
  report.fields["flow"] = fit_json(fit);
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, words_of(fit));
}

}  // namespace

void add_flow_test(options::Command& app, Context& context) {
  auto options = std::make_shared<FlowTestOptions>();
  options::Command* command = app.add_subcommand(
      "flow-test", "Plan strokes on a flat plate, and take a gun's and a pump's delays from their films");
  command->add_option("--process", options->process, "Process YAML: the tool, its outputs, its speed")
      ->required();
  command
      ->add_option("--at", options->at,
                   "The plate: x y z [mm] of its top's middle, turn [deg] of the first stroke from x")
      ->check(number(k_plausible_mm, "mm, deg"))
      ->expected(4)
      ->required();
  command->add_option("--measured", options->measured,
                      "strokes.csv of the plan with its last fields filled in: the delays are told");
  command->add_option("--out", options->out, "Folder for strokes.csv, path.script, report.json")->required();
  add_cell_options(*command, options->cell);
  command->callback([options, &context] {
    context.run = [options, &context] { return flow_test(*options, context.options); };
  });
}

}  // namespace biteline::app
