// SPDX-License-Identifier: MIT
// biteline study: how much of what is measured is the measuring.
#include <memory>
#include <optional>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/csv/table.hpp"
#include "common/options/command.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/work_quality_files.hpp"
#include "host/study/gage_study.hpp"

namespace biteline::app {
namespace {

struct StudyOptions {
  std::filesystem::path table, out;
  std::string of;  ///< width or place: the table names looks; empty: it has values
};

/// A table `#part,person,look`: of each look's folder its width or place.
Result<std::vector<study::Reading>> readings_of_looks(const StudyOptions& options) {
  std::vector<study::Reading> readings;
  BITELINE_TRY(csv::read_table(options.table, 3, 3, [&](const csv::Row& row) -> Result<void> {
    const std::filesystem::path folder = options.table.parent_path() / std::string{row.text(2)};
    BITELINE_ASSIGN(const ShoeWork work, read_shoe_work(folder));
    const std::optional<double>& value = options.of == "width" ? work.width_mm : work.off_mm;
    if (!value)
      return fail(Errc::BadValue, "%.200s: this look tells no band; scan the shoe again", folder.c_str());
    readings.push_back(
        {.part = std::string{row.text(0)}, .person = std::string{row.text(1)}, .value = *value});
    return {};
  }));
  return readings;
}

nlohmann::ordered_json json_of(const study::Source& source) {
  return {{"sum_of_squares", source.squares},
          {"degrees_of_freedom", source.freedom},
          {"mean_square", source.mean_square()}};
}

nlohmann::ordered_json json_of(const study::GageStudy& study) {
  return {{"parts", study.parts},
          {"persons", study.persons},
          {"trials", study.trials},
          {"of_parts", json_of(study.of_parts)},
          {"of_persons", json_of(study.of_persons)},
          {"of_both", json_of(study.of_both)},
          {"of_repeats", json_of(study.of_repeats)},
          {"interaction_probability", study.interaction_probability},
          {"interaction_kept", study.interaction_kept},
          {"ev", study.ev},
          {"av", study.av},
          {"interaction", study.interaction},
          {"grr", study.grr},
          {"pv", study.pv},
          {"tv", study.tv},
          {"grr_percent", study.grr_percent()},
          {"ndc", study.ndc}};
}

Result<ExitStatus> run_study(const StudyOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(report::prepare_folder(options.out));
  BITELINE_ASSIGN(const std::vector<study::Reading> readings,
                  options.of.empty() ? study::read_readings(options.table) : readings_of_looks(options));
  BITELINE_ASSIGN(const study::GageStudy study, study::gage_study(readings));
  report.fields["input"] = options.table.filename().string();
  if (!options.of.empty()) report.fields["of"] = options.of;
  report.fields["study"] = json_of(study);
  BITELINE_TRY(write_gage_page(study, options.table.filename().string(), options.out));
  BITELINE_TRY(report.write(options.out));
  const auto words = FixedText<300>::format(
      "%d parts, %d persons, %d trials: EV %.4g, AV %.4g, GRR %.4g, PV %.4g, TV %.4g; GRR is %.1f %% of TV, "
      "%d categories can be told apart",
      study.parts, study.persons, study.trials, study.ev, study.av, study.grr, study.pv, study.tv,
      study.grr_percent(), study.ndc);
  return tell(report, global, words.c_str());
}

}  // namespace

void add_study(options::Command& app, Context& context) {
  auto options = std::make_shared<StudyOptions>();
  options::Command* command = app.add_subcommand(
      "study", "A gage study of readings: what of their spread is repeats, persons and parts");
  command->add_option("TABLE", options->table, "Readings: part,person,value; each person each part as often")
      ->required();
  command->add_option("--out", options->out, "Folder for report.json and index.html")->required();
  command
      ->add_option("--of", options->of,
                   "The table's third column names folders of biteline inspect: study their width or place")
      ->check(options::one_of({"width", "place"}));
  command->callback([options, &context] {
    context.run = [options, &context] { return run_study(*options, context.options); };
  });
}

}  // namespace biteline::app
