// SPDX-License-Identifier: MIT
// biteline capture accept: a head's acceptance by pieces of known size, with a page to sign.
#include "host/apps/biteline/capture_accept.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "common/core/fixed_text.hpp"
#include "common/csv/table.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/intake/capture/known_piece.hpp"
#include "host/intake/capture/refused.hpp"
#include "host/records/digest/digest.hpp"
#include "host/report/page.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

enum class Trait { Form, Size, Spacing, Flatness, Step };

/// What is judged, and in how many places at least: VDI/VDE 2634 part 2, clauses 4.1 to 4.3.  It knows no
/// step; three heights show a scale that is wrong.
struct TraitRow {
  Trait trait;
  const char *name, *words;
  std::size_t least_places;
};
constexpr std::array k_traits{
    TraitRow{Trait::Form, "probing_form", "Probing error, form: range of the points about the ball", 10},
    TraitRow{Trait::Size, "probing_size", "Probing error, size: the ball's diameter", 10},
    TraitRow{Trait::Spacing, "spacing", "Spacing of the bar's balls", 7},
    TraitRow{Trait::Flatness, "flatness", "Flatness: range of the points about the plane", 6},
    TraitRow{Trait::Step, "step", "Height of the step", 3},
};

const TraitRow& row_of(Trait trait) {
  return k_traits.at(static_cast<std::size_t>(trait));
}

struct AcceptOptions {
  fs::path table, sensor, out;
  cloud::Reading reading;
  std::string head;
  std::map<Trait, double> limits_mm{{Trait::Form, 0.25},
                                    {Trait::Size, 0.1},
                                    {Trait::Spacing, 0.1},
                                    {Trait::Flatness, 0.25},
                                    {Trait::Step, 0.1}};
};

/// A row of the table.
struct Piece {
  std::string kind;
  fs::path cloud;
  std::string shown;  ///< its name in the table
  double first_mm{0}, second_mm{0};
};

struct Measured {
  Trait trait;
  std::string piece, cloud;
  double known_mm{0}, measured_mm{0}, off_mm{0}, limit_mm{0};
  [[nodiscard]] bool passed() const { return std::abs(off_mm) <= limit_mm; }
};

struct PieceKind {
  const char* name;
  std::size_t sizes;
};
constexpr std::array k_piece_kinds{PieceKind{"ball", 1}, PieceKind{"bar", 2}, PieceKind{"plane", 0},
                                   PieceKind{"step", 1}};

Result<std::vector<Piece>> read_pieces(const fs::path& table) {
  std::vector<Piece> pieces;
  BITELINE_TRY(csv::read_table(table, 2, 4, [&](const csv::Row& row) -> Result<void> {
    const auto kind = std::ranges::find(k_piece_kinds, row.text(0), &PieceKind::name);
    if (kind == k_piece_kinds.end() || row.size() != 2 + kind->sizes)
      return fail(Errc::BadFormat,
                  "%.150s row %d: 'ball,CLOUD,diameter', 'bar,CLOUD,diameter,distance', 'plane,CLOUD' or "
                  "'step,CLOUD,height' expected",
                  table.c_str(), row.number());
    Piece piece{.kind = std::string{row.text(0)},
                .cloud = table.parent_path() / std::string{row.text(1)},
                .shown = std::string{row.text(1)}};
    constexpr NumberRange k_sizes_mm{.minimum = 0.5, .maximum = 2000};
    if (kind->sizes > 0) {
      BITELINE_ASSIGN(piece.first_mm, row.number(2, k_sizes_mm));
    }
    if (kind->sizes > 1) {
      BITELINE_ASSIGN(piece.second_mm, row.number(3, k_sizes_mm));
    }
    pieces.push_back(std::move(piece));
    return {};
  }));
  if (pieces.empty()) return fail(Errc::BadFormat, "%.200s: no piece in it", table.c_str());
  return pieces;
}

/// A point of a piece may be off by more than is allowed: else what is far off would not be seen.
double within_mm(double limit_mm) {
  constexpr double k_least_mm = 0.3, k_limits = 3;
  return std::max(k_least_mm, k_limits * limit_mm);
}

class Measuring {
 public:
  explicit Measuring(const AcceptOptions& options) : options_{options} {}

  Result<void> take(const Piece& piece) {
    BITELINE_ASSIGN(const cloud::CloudFile file, cloud::read_cloud_file(piece.cloud, options_.reading));
    std::vector<Vec3> points;
    points.reserve(file.cloud.size());
    for (const Eigen::Vector3f& point : file.cloud.points) points.push_back(point.cast<double>());
    const Result<void> taken = measure(piece, points);
    if (!taken)
      return fail(taken.error().code, "%.150s: %s", piece.cloud.c_str(), taken.error().where.c_str());
    return {};
  }
  [[nodiscard]] const std::vector<Measured>& all() const { return all_; }

 private:
  Result<void> measure(const Piece& piece, const std::vector<Vec3>& points) {
    if (piece.kind == "ball") {
      BITELINE_ASSIGN(
          const capture::BallFit ball,
          capture::fit_ball(points, piece.first_mm, within_mm(options_.limits_mm.at(Trait::Form))));
      add(Trait::Form, piece, 0, ball.form_mm);
      add(Trait::Size, piece, piece.first_mm, ball.size.size_mm);
    } else if (piece.kind == "bar") {
      BITELINE_ASSIGN(
          const capture::BarFit bar,
          capture::measure_bar(points, {.diameter_mm = piece.first_mm, .distance_mm = piece.second_mm}));
      add(Trait::Spacing, piece, piece.second_mm, bar.distance_mm);
    } else if (piece.kind == "plane") {
      BITELINE_ASSIGN(const capture::FlatFit flat,
                      capture::measure_flat(points, within_mm(options_.limits_mm.at(Trait::Flatness))));
      add(Trait::Flatness, piece, 0, flat.flatness_mm);
    } else {
      BITELINE_ASSIGN(const capture::PieceSize step, capture::measure_step(points, piece.first_mm));
      add(Trait::Step, piece, piece.first_mm, step.size_mm);
    }
    return {};
  }
  void add(Trait trait, const Piece& piece, double known_mm, double measured_mm) {
    all_.push_back({.trait = trait,
                    .piece = piece.kind,
                    .cloud = piece.shown,
                    .known_mm = known_mm,
                    .measured_mm = measured_mm,
                    .off_mm = measured_mm - known_mm,
                    .limit_mm = options_.limits_mm.at(trait)});
  }

  const AcceptOptions& options_;
  std::vector<Measured> all_;
};

struct Summary {
  TraitRow row;
  std::size_t places{0};
  double worst_mm{0}, limit_mm{0};  ///< `worst`: farthest off, with its sign
  [[nodiscard]] bool passed() const { return std::abs(worst_mm) <= limit_mm; }
  [[nodiscard]] bool complete() const { return places >= row.least_places; }
};

std::vector<Summary> summaries_of(const std::vector<Measured>& all) {
  std::vector<Summary> summaries;
  for (const TraitRow& row : k_traits) {
    Summary of{.row = row};
    for (const Measured& one : all) {
      if (one.trait != row.trait) continue;
      ++of.places;
      of.limit_mm = one.limit_mm;
      if (std::abs(one.off_mm) > std::abs(of.worst_mm)) of.worst_mm = one.off_mm;
    }
    summaries.push_back(of);
  }
  return summaries;
}

std::string mm(double value, bool with_sign = false) {
  return std::string{FixedText<32>::format(with_sign ? "%+.4f" : "%.4f", value).view()};
}

std::string verdict_words(bool passed, bool complete) {
  if (!passed) return "failed";
  return complete ? "passed" : "passed where it was looked at, not complete";
}

std::string missing_words(const std::vector<Summary>& summaries) {
  std::string words;
  for (const Summary& of : summaries) {
    if (!of.complete())
      words += (words.empty() ? "" : "; ") + std::string{of.row.name} + ": " + std::to_string(of.places) +
               " of " + std::to_string(of.row.least_places) + " places";
  }
  return words;
}

std::string failed_words(const std::vector<Summary>& summaries) {
  std::string words;
  for (const Summary& of : summaries) {
    if (!of.passed())
      words += (words.empty() ? "" : "; ") + std::string{of.row.name} + " is off by " +
               mm(of.worst_mm, true) + " mm, limit " + mm(of.limit_mm) + " mm";
  }
  return words;
}

Result<void> write_page(const AcceptOptions& options, const std::vector<Measured>& all,
                        const std::vector<Summary>& summaries, const nlohmann::ordered_json& fields) {
  using Mood = report::Page::Mood;
  const bool passed = fields.at("passed").get<bool>(), complete = fields.at("complete").get<bool>();
  report::Page page{"Acceptance of a head", verdict_words(passed, complete),
                    !passed    ? Mood::Refused
                    : complete ? Mood::Good
                               : Mood::Look};
  if (!complete) page.paragraph("Missing for a whole protocol: " + missing_words(summaries) + ".");
  page.figures({{"head", options.head.empty() ? "not named" : options.head},
                {"calibration (SHA-256 of sensor.yaml)", fields.value("sensor_sha256", "not given")},
                {"program", "biteline " BITELINE_VERSION}});
  page.heading("Result");
  std::vector<std::vector<std::string>> rows;
  for (const Summary& of : summaries)
    if (of.places > 0)
      rows.push_back({of.row.words, std::to_string(of.places), mm(of.worst_mm, true), mm(of.limit_mm),
                      of.passed() ? "pass" : "fail"});
  page.table({"figure", "places", "worst [mm]", "limit [mm]", "verdict"}, rows);
  page.heading("Every measurement");
  rows.clear();
  for (const Measured& one : all)
    rows.push_back({row_of(one.trait).name, one.cloud, mm(one.known_mm), mm(one.measured_mm),
                    mm(one.off_mm, true), one.passed() ? "pass" : "fail"});
  page.table({"figure", "scan", "known [mm]", "measured [mm]", "off [mm]", "verdict"}, rows);
  page.heading("How it was done");
  page.paragraph(
      "In the spirit of VDI/VDE 2634 part 2: balls in 10 places, a bar in 7, a plane in 6, spread over all "
      "of the "
      "volume that is worked in; steps in 3. Ranges are without the 3 points in 1000 that are farthest off.");
  page.paragraph(
      "The arm moved the head, so its own error is in every figure. A verdict compares with the limit alone; "
      "the "
      "pieces' uncertainty is not taken off.");
  page.heading("To be filled in by hand, and signed");
  for (const char* line : {"Pieces: numbers of their certificates, and until when they count",
                           "Temperature of the pieces at the begin and at the end [degC]", "Place",
                           "Who measured: name, date, signature", "Who accepts: name, date, signature"})
    page.figures({{line, "______________________________"}});
  page.link("report.json", "All numbers");
  return page.write(options.out / "index.html");
}

Result<ExitStatus> accept(const AcceptOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(report::prepare_folder(options.out));
  BITELINE_ASSIGN(const std::vector<Piece> pieces, read_pieces(options.table));
  Measuring measuring{options};
  auto scans = nlohmann::ordered_json::object();
  for (const Piece& piece : pieces) {
    BITELINE_TRY(measuring.take(piece));
    BITELINE_ASSIGN(scans[piece.shown], digest_of_file(piece.cloud));
  }
  const std::vector<Summary> summaries = summaries_of(measuring.all());
  bool passed = true, complete = true;
  auto results = nlohmann::ordered_json::object();
  for (const Summary& of : summaries) {
    passed = passed && of.passed();
    complete = complete && of.complete();
    results[of.row.name] = {{"places", of.places},
                            {"least_places", of.row.least_places},
                            {"worst_mm", of.worst_mm},
                            {"limit_mm", options.limits_mm.at(of.row.trait)},
                            {"passed", of.passed()}};
  }
  auto measurements = nlohmann::ordered_json::array();
  for (const Measured& one : measuring.all())
    measurements.push_back({{"figure", row_of(one.trait).name},
                            {"scan", one.cloud},
                            {"known_mm", one.known_mm},
                            {"measured_mm", one.measured_mm},
                            {"off_mm", one.off_mm},
                            {"passed", one.passed()}});
  report.fields["head"] = options.head;
  if (!options.sensor.empty()) {
    BITELINE_ASSIGN(report.fields["sensor_sha256"], digest_of_file(options.sensor));
  }
  report.fields["passed"] = passed;
  report.fields["complete"] = complete;
  report.fields["results"] = std::move(results);
  report.fields["measurements"] = std::move(measurements);
  report.fields["scans_sha256"] = std::move(scans);
  BITELINE_TRY(write_page(options, measuring.all(), summaries, report.fields));
  if (!passed)
    report.refuse(report::Refusal<capture::AcceptRefused>{.code = capture::AcceptRefused::BeyondLimit,
                                                          .reason = failed_words(summaries)});
  BITELINE_TRY(report.write(options.out));
  std::string words = verdict_words(passed, complete);
  for (const Summary& of : summaries)
    if (of.places > 0)
      words += FixedText<160>::format("\n%-14s %2zu places, worst %+.4f mm, limit %.4f mm: %s", of.row.name,
                                      of.places, of.worst_mm, of.limit_mm, of.passed() ? "pass" : "fail")
                   .c_str();
  if (!complete) words += "\nmissing: " + missing_words(summaries);
  return tell(report, global, words);
}

}  // namespace

void add_capture_accept(options::Command& capture, Context& context) {
  auto options = std::make_shared<AcceptOptions>();
  options::Command* command = capture.add_subcommand("accept",
                                                     "A head's acceptance by scans of known pieces, in the "
                                                     "spirit of VDI/VDE 2634 part 2, as a page to sign");
  command
      ->add_option("TABLE", options->table,
                   "A row for each scan: ball,CLOUD,diameter; bar,CLOUD,diameter,distance; plane,CLOUD; "
                   "step,CLOUD,height [mm]; paths from the table's folder")
      ->required();
  command->add_option("--out", options->out, "Folder for index.html and report.json")->required();
  add_reading_options(*command, options->reading);
  command->add_option("--head", options->head, "The head's name or number, for the page");
  command->add_option("--sensor", options->sensor, "Its sensor.yaml: the page binds it by its SHA-256")
      ->check(options::existing_file());
  for (const auto& [name, trait, help] :
       {std::tuple{"--form-mm", Trait::Form, "Limit of a ball's form"},
        std::tuple{"--size-mm", Trait::Size, "Limit of a ball's diameter"},
        std::tuple{"--spacing-mm", Trait::Spacing, "Limit of a bar's distance"},
        std::tuple{"--flatness-mm", Trait::Flatness, "Limit of a plane's flatness"},
        std::tuple{"--step-mm", Trait::Step, "Limit of a step's height"}})
    command->add_option(name, options->limits_mm.at(trait), help)
        ->check(options::number({.minimum = 0.001, .maximum = 100}, "mm"))
        ->capture_default_str();
  command->callback([options, &context] {
    context.run = [options, &context] { return accept(*options, context.options); };
  });
}

}  // namespace biteline::app
