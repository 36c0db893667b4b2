// SPDX-License-Identifier: MIT
// biteline target: a ring target to print to scale, and its target.yaml.
#include <memory>

#include "common/options/number.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/calibration/rings/target_drawing.hpp"
#include "host/records/report/report.hpp"

namespace biteline::app {
namespace {

struct TargetOptions {
  std::filesystem::path out;
  calibration::RingTarget target{
      .rows = 4, .cols = 7, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6};
};

/// Somebody may have corrected it by the ruler: numbers of another target are not written over.
Result<void> check_numbers(const std::filesystem::path& file, const calibration::RingTarget& target) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  const Result<calibration::RingTarget> there = calibration::read_target(file);
  if (there && calibration::target_text(*there) == calibration::target_text(target)) return {};
  return fail(Errc::InvalidArgument, "%s is there and has other numbers: another name, or remove it",
              file.c_str());
}

Result<ExitStatus> draw(const TargetOptions& options, const GlobalOptions& global) {
  const calibration::RingTarget& t = options.target;
  if (t.outer_diameter_mm >= t.pitch_mm)
    return fail(Errc::InvalidArgument, "--outer-diameter: less than the pitch expected");
  if (t.inner_diameter_mm >= t.outer_diameter_mm)
    return fail(Errc::InvalidArgument, "--inner-diameter: less than the outer diameter expected");
  const bool pdf = options.out.extension() == ".pdf";
  if (!pdf && options.out.extension() != ".svg")
    return fail(Errc::InvalidArgument, "--out %s: a name ending in .pdf or .svg expected",
                options.out.c_str());
  std::filesystem::path numbers = options.out;
  numbers.replace_extension(".yaml");
  BITELINE_TRY(check_numbers(numbers, t));
  BITELINE_TRY(report::write_file_atomically(options.out,
                                             pdf ? calibration::target_pdf(t) : calibration::target_svg(t)));
  BITELINE_TRY(report::write_file_atomically(numbers, calibration::target_text(t)));
  report::Report report;
  report.fields["file"] = options.out.filename().string();
  report.fields["numbers"] = numbers.filename().string();
  report.fields["planes"] = t.planes;
  report.fields["rows"] = t.rows;
  report.fields["cols"] = t.cols;
  report.fields["pitch_mm"] = t.pitch_mm;
  report.fields["outer_diameter_mm"] = t.outer_diameter_mm;
  report.fields["inner_diameter_mm"] = t.inner_diameter_mm;
  return tell(report, global, "");
}

}  // namespace

void add_target(CLI::App& app, Context& context) {
  const auto options = std::make_shared<TargetOptions>();
  CLI::App* command =
      app.add_subcommand("target", "Draws a ring target to print to scale, and writes its target.yaml");
  command
      ->add_option("--out", options->out,
                   "The drawing, FILE.pdf or FILE.svg; FILE.yaml with its numbers is written beside it")
      ->required();
  command->add_option("--rows", options->target.rows, "Rows of rings")
      ->check(options::number({.minimum = 2, .maximum = 100}, ""))
      ->capture_default_str();
  command->add_option("--cols", options->target.cols, "Rings in a row")
      ->check(options::number({.minimum = 2, .maximum = 100}, ""))
      ->capture_default_str();
  command->add_option("--pitch", options->target.pitch_mm, "From ring to ring [mm]")
      ->check(options::number({.minimum = 1, .maximum = 500}, "mm"))
      ->capture_default_str();
  command->add_option("--outer-diameter", options->target.outer_diameter_mm, "[mm]")
      ->check(options::number({.minimum = 0.5, .maximum = 500}, "mm"))
      ->capture_default_str();
  command->add_option("--inner-diameter", options->target.inner_diameter_mm, "[mm]")
      ->check(options::number({.minimum = 0.1, .maximum = 500}, "mm"))
      ->capture_default_str();
  command->add_option("--planes", options->target.planes, "2: two grids, for the laser's two plates")
      ->check(options::number({.minimum = 1, .maximum = 2}, ""))
      ->capture_default_str();
  command->callback(
      [options, &context] { context.run = [options, &context] { return draw(*options, context.options); }; });
}

}  // namespace biteline::app
