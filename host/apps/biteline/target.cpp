// SPDX-License-Identifier: MIT
// biteline target: a ring target or chessboard to print to scale, and its target.yaml.
#include <memory>

#include "common/options/command.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/calibration/rings/target_drawing.hpp"
#include "host/report/report.hpp"

namespace biteline::app {
namespace {

struct TargetOptions {
  std::filesystem::path out;
  std::string kind{"rings"};
  calibration::RingTarget target{
      .rows = 4, .cols = 7, .pitch_mm = 14, .outer_diameter_mm = 12, .inner_diameter_mm = 6};
  /// In place of what the rings have.
  int square_rows{8}, square_cols{11};
  double square_mm{8};
};

/// Options of the other kind of target: told, not passed over.
struct KindOptions {
  std::vector<options::Option*> rings, chessboard;
  options::Option* pitch{nullptr};  ///< of both
};

Result<calibration::RingTarget> target_of(const TargetOptions& options, const KindOptions& kinds) {
  const bool chessboard = options.kind == "chessboard";
  for (const options::Option* other : chessboard ? kinds.rings : kinds.chessboard) {
    if (other->count() > 0)
      return fail(Errc::InvalidArgument, "%s: not of --kind %s", other->name().c_str(), options.kind.c_str());
  }
  calibration::RingTarget target = options.target;
  if (!chessboard) return target;
  return calibration::RingTarget{.rows = options.square_rows - 1,
                                 .cols = options.square_cols - 1,
                                 .pitch_mm = kinds.pitch->count() > 0 ? target.pitch_mm : options.square_mm,
                                 .planes = target.planes,
                                 .kind = calibration::TargetKind::Chessboard};
}

/// Somebody may have corrected it by the ruler: numbers of another target are not written over.
Result<void> check_numbers(const std::filesystem::path& file, const calibration::RingTarget& target) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  const Result<calibration::RingTarget> there = calibration::read_target(file);
  if (there && calibration::target_text(*there) == calibration::target_text(target)) return {};
  return fail(Errc::InvalidArgument, "%s is there and has other numbers: another name, or remove it",
              file.c_str());
}

Result<ExitStatus> draw(const TargetOptions& options, const KindOptions& kinds, const GlobalOptions& global) {
  BITELINE_ASSIGN(const calibration::RingTarget t, target_of(options, kinds));
  if (!t.chessboard() && t.outer_diameter_mm >= t.pitch_mm)
    return fail(Errc::InvalidArgument, "--outer-diameter: less than the pitch expected");
  if (!t.chessboard() && t.inner_diameter_mm >= t.outer_diameter_mm)
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
  report.fields["kind"] = options.kind;
  report.fields["pitch_mm"] = t.pitch_mm;
  if (t.chessboard()) {
    report.fields["square_rows"] = t.rows + 1;
    report.fields["square_cols"] = t.cols + 1;
    return tell(report, global, "");
  }
  report.fields["rows"] = t.rows;
  report.fields["cols"] = t.cols;
  report.fields["outer_diameter_mm"] = t.outer_diameter_mm;
  report.fields["inner_diameter_mm"] = t.inner_diameter_mm;
  return tell(report, global, "");
}

}  // namespace

void add_target(options::Command& app, Context& context) {
  const auto options = std::make_shared<TargetOptions>();
  options::Command* command = app.add_subcommand(
      "target", "Draws a ring target or a chessboard to print to scale, and writes its target.yaml");
  const auto kinds = std::make_shared<KindOptions>();
  command
      ->add_option("--out", options->out,
                   "The drawing, FILE.pdf or FILE.svg; FILE.yaml with its numbers is written beside it")
      ->required();
  command
      ->add_option("--kind", options->kind,
                   "rings or chessboard; what a chessboard costs in accuracy: docs/calibration.md")
      ->check(options::one_of({"rings", "chessboard"}))
      ->capture_default_str();
  const auto add_count = [&](const char* name, int& value, const char* words, double minimum) {
    return command->add_option(name, value, words)
        ->check(options::number({.minimum = minimum, .maximum = 100}, ""))
        ->capture_default_str();
  };
  kinds->rings.push_back(add_count("--rows", options->target.rows, "Rows of rings", 2));
  kinds->rings.push_back(add_count("--cols", options->target.cols, "Rings in a row", 2));
  kinds->chessboard.push_back(
      add_count("--square-rows", options->square_rows, "Rows of squares, of a chessboard", 3));
  kinds->chessboard.push_back(
      add_count("--square-cols", options->square_cols, "Squares in a row, of a chessboard", 3));
  kinds->pitch = command
                     ->add_option("--pitch", options->target.pitch_mm,
                                  "From ring to ring; the side of a square (then 8) [mm]")
                     ->check(options::number({.minimum = 1, .maximum = 500}, "mm"))
                     ->capture_default_str();
  kinds->rings.push_back(command->add_option("--outer-diameter", options->target.outer_diameter_mm, "[mm]")
                             ->check(options::number({.minimum = 0.5, .maximum = 500}, "mm"))
                             ->capture_default_str());
  kinds->rings.push_back(command->add_option("--inner-diameter", options->target.inner_diameter_mm, "[mm]")
                             ->check(options::number({.minimum = 0.1, .maximum = 500}, "mm"))
                             ->capture_default_str());
  command->add_option("--planes", options->target.planes, "2: two grids, for the laser's two plates")
      ->check(options::number({.minimum = 1, .maximum = 2}, ""))
      ->capture_default_str();
  command->callback([options, kinds, &context] {
    context.run = [options, kinds, &context] { return draw(*options, *kinds, context.options); };
  });
}

}  // namespace biteline::app
