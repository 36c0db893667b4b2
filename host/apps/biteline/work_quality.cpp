// SPDX-License-Identifier: MIT
// biteline work-quality: width and place of the work over many shoes, by their second looks.
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/work_quality_files.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct QualityOptions {
  std::vector<fs::path> looks;
  fs::path out;
  std::optional<double> width_tolerance_mm, place_tolerance_mm;
};

/// The plan that all looks share; an option replaces its tolerance.
Result<void> check_one_plan(const std::vector<ShoeWork>& looks, const QualityOptions& options) {
  for (const ShoeWork& look : looks) {
    if (look.planned_width_mm != looks.front().planned_width_mm)
      return fail(Errc::BadValue, "%.80s: a band of %.3f mm, where %.80s has %.3f mm; study each plan alone",
                  look.name.c_str(), look.planned_width_mm, looks.front().name.c_str(),
                  looks.front().planned_width_mm);
    if (look.tolerance_mm != looks.front().tolerance_mm &&
        (!options.width_tolerance_mm || !options.place_tolerance_mm))
      return fail(Errc::BadValue,
                  "%.80s: a tolerance of %.3f mm, where %.80s has %.3f mm; give --width-tolerance-mm and "
                  "--place-tolerance-mm",
                  look.name.c_str(), look.tolerance_mm, looks.front().name.c_str(),
                  looks.front().tolerance_mm);
  }
  return {};
}

Result<QualityStudy> study_of(const std::string& title, const study::Limits& limits,
                              std::vector<study::TrendPoint> points) {
  QualityStudy of{.title = title, .limits = limits, .points = std::move(points)};
  std::vector<double> values;
  for (const study::TrendPoint& point : of.points) values.push_back(point.value);
  BITELINE_ASSIGN(of.performance, study::performance(values, limits));
  if (of.points.size() < 3) return of;
  BITELINE_ASSIGN(of.trend, study::trend_of(of.points));
  of.crossing = study::crossing_of(*of.trend, limits);
  return of;
}

nlohmann::ordered_json json_of(const QualityStudy& of) {
  nlohmann::ordered_json json{{"limits_mm", {of.limits.low, of.limits.high}},
                              {"shoes", of.performance.count},
                              {"mean_mm", of.performance.mean},
                              {"standard_deviation_mm", of.performance.deviation},
                              {"outside", of.performance.outside},
                              {"pp", of.performance.pp},
                              {"ppk", of.performance.ppk},
                              {"ppk_not_below", of.performance.ppk_low}};
  if (of.trend)
    json["trend"] = {{"mm_per_shoe", of.trend->slope},
                     {"u95_mm_per_shoe", of.trend->slope_u95},
                     {"residual_mm", of.trend->residual},
                     {"sure", of.trend->sure()}};
  if (of.crossing)
    json["trend"]["reaches"] = {{"limit_mm", of.crossing->limit},
                                {"shoe", of.crossing->likely},
                                {"earliest_shoe", of.crossing->earliest},
                                {"latest_shoe", of.crossing->latest}};
  return json;
}

std::string table_of(const std::vector<ShoeWork>& looks) {
  std::string table = "#shoe,look,places,width [mm],least width [mm],largest width [mm],off [mm]\n";
  int shoe = 0;
  for (const ShoeWork& look : looks) {
    ++shoe;
    table += FixedText<200>::format("%d,%.80s,%d,", shoe, look.name.c_str(), look.places).c_str();
    if (look.width_mm)
      table += FixedText<120>::format("%.4f,%.3f,%.3f,%.4f", *look.width_mm, look.least_width_mm,
                                      look.largest_width_mm, *look.off_mm)
                   .c_str();
    else
      table += ",,,";
    table += "\n";
  }
  return table;
}

Result<std::vector<QualityStudy>> studies_of(const std::vector<ShoeWork>& looks,
                                             const QualityOptions& options) {
  std::vector<study::TrendPoint> widths, places;
  double shoe = 0;
  for (const ShoeWork& look : looks) {
    ++shoe;
    if (!look.width_mm) continue;
    widths.push_back({.x = shoe, .value = *look.width_mm});
    places.push_back({.x = shoe, .value = *look.off_mm});
  }
  // Both edges may be off by the look's tolerance: to opposite sides the width, to the same side the place.
  const ShoeWork& first = looks.front();
  const double width_mm = options.width_tolerance_mm.value_or(2 * first.tolerance_mm),
               place_mm = options.place_tolerance_mm.value_or(first.tolerance_mm);
  std::vector<QualityStudy> studies;
  BITELINE_ASSIGN(
      QualityStudy width,
      study_of("Width", {.low = first.planned_width_mm - width_mm, .high = first.planned_width_mm + width_mm},
               std::move(widths)));
  BITELINE_ASSIGN(QualityStudy place, study_of("Place: the middle above its plan",
                                               {.low = -place_mm, .high = place_mm}, std::move(places)));
  studies.push_back(std::move(width));
  studies.push_back(std::move(place));
  return studies;
}

Result<ExitStatus> run_quality(const QualityOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(report::prepare_folder(options.out));
  std::vector<ShoeWork> looks;
  int left_out = 0;
  for (const fs::path& folder : options.looks) {
    BITELINE_ASSIGN(ShoeWork look, read_shoe_work(folder));
    if (!look.width_mm) ++left_out;
    looks.push_back(std::move(look));
  }
  BITELINE_TRY(check_one_plan(looks, options));
  BITELINE_ASSIGN(const std::vector<QualityStudy> studies, studies_of(looks, options));
  const QualityStudy &width = studies[0], &place = studies[1];
  report.fields["looks"] = looks.size();
  report.fields["left_out"] = left_out;
  report.fields["width"] = json_of(width);
  report.fields["place"] = json_of(place);
  BITELINE_TRY(report::write_file_atomically(options.out / "shoes.csv", table_of(looks)));
  BITELINE_TRY(report::write_file_atomically(options.out / "width.svg", trend_picture(width)));
  BITELINE_TRY(report::write_file_atomically(options.out / "place.svg", trend_picture(place)));
  BITELINE_TRY(write_quality_page(studies, left_out, options.out));
  BITELINE_TRY(report.write(options.out));
  std::string words;
  for (const QualityStudy& of : studies)
    words += std::string{words.empty() ? "" : "\n"} +
             FixedText<240>::format("%s: %d shoes, mean %.3f mm, Pp %.2f, Ppk %.2f (not below %.2f). ",
                                    of.title.c_str(), of.performance.count, of.performance.mean,
                                    of.performance.pp, of.performance.ppk, of.performance.ppk_low)
                 .c_str() +
             trend_words(of);
  return tell(report, global, words);
}

}  // namespace

void add_work_quality(options::Command& app, Context& context) {
  auto options = std::make_shared<QualityOptions>();
  options::Command* command = app.add_subcommand(
      "work-quality",
      "Pp and Ppk of the work's width and place over many shoes, and the tool's wear, by their second looks");
  command
      ->add_option(
          "LOOK", options->looks,
          "Folders that biteline inspect wrote, in the order of the work, since the tool was changed")
      ->required();
  command->add_option("--out", options->out, "Folder for index.html, report.json, shoes.csv and pictures")
      ->required();
  command
      ->add_option("--width-tolerance-mm", options->width_tolerance_mm,
                   "Of the width, to both sides; else twice the looks' tolerance of an edge")
      ->check(options::number({.minimum = 0.01, .maximum = 50}, "mm"));
  command
      ->add_option("--place-tolerance-mm", options->place_tolerance_mm,
                   "Of the middle, to both sides; else the looks' tolerance of an edge")
      ->check(options::number({.minimum = 0.01, .maximum = 50}, "mm"));
  command->callback([options, &context] {
    context.run = [options, &context] { return run_quality(*options, context.options); };
  });
}

}  // namespace biteline::app
