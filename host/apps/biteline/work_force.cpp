// SPDX-License-Identifier: MIT
// biteline work-force: what a cell's shoes taught of the force, and the tool's wear by it.
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "common/system/user_name.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/force_book/force_book.hpp"
#include "host/report/file_lock.hpp"
#include "host/study/wear.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct ForceOptions {
  fs::path results;
  std::string forget, who;
  double reach_mm{3};
};

/// At a set force a worn tool goes farther in: by how much with each shoe.
struct Wear {
  study::Trend trend;
  std::optional<study::Crossing> crossing;
};
Result<std::optional<Wear>> wear_of(const force_book::Entry& entry, double reach_mm) {
  std::vector<study::TrendPoint> points;
  double shoe = entry.learned.shoes - static_cast<double>(entry.shoes.size());
  for (const force_book::ShoeForce& one : entry.shoes) points.push_back({.x = ++shoe, .value = one.along_mm});
  if (points.size() < 3) return std::optional<Wear>{};
  BITELINE_ASSIGN(const study::Trend trend, study::trend_of(points));
  return std::optional{
      Wear{.trend = trend, .crossing = study::crossing_of(trend, {.low = -reach_mm, .high = reach_mm})}};
}

std::string words_of(const Wear& wear) {
  using Text = FixedText<200>;
  if (!wear.trend.sure()) return "the tool shows no wear";
  std::string words = Text::format("the tip goes in by %.4f mm (U95 %.4f mm) more with each shoe",
                                   wear.trend.slope, wear.trend.slope_u95)
                          .c_str();
  if (wear.crossing)
    words += Text::format("; the reach of %.1f mm is used up at shoe %.0f (%.0f to %.0f)",
                          std::abs(wear.crossing->limit), wear.crossing->likely, wear.crossing->earliest,
                          wear.crossing->latest)
                 .c_str();
  return words;
}

nlohmann::ordered_json json_of(const Wear& wear) {
  nlohmann::ordered_json json{{"mm_per_shoe", wear.trend.slope},
                              {"u95_mm_per_shoe", wear.trend.slope_u95},
                              {"sure", wear.trend.sure()}};
  if (wear.crossing)
    json["reaches"] = {{"limit_mm", wear.crossing->limit},
                       {"shoe", wear.crossing->likely},
                       {"earliest_shoe", wear.crossing->earliest},
                       {"latest_shoe", wear.crossing->latest}};
  return json;
}

std::string head_of(const force_book::Entry& entry) {
  std::string words = entry.of.model;
  if (!entry.of.foot.empty()) words += ", " + entry.of.foot;
  return words + ", " + entry.of.process +
         FixedText<60>::format(", %.1f N: ", entry.learned.set_newton).c_str() +
         force_book::words_of(entry.learned);
}

Result<ExitStatus> show(const ForceOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_ASSIGN(const memory::Memory memory,
                  memory::Memory::open_to_read(options.results / memory::k_memory_file));
  BITELINE_ASSIGN(const std::vector<force_book::Entry> entries, force_book::read_all(memory));
  report.fields["learned"] = nlohmann::ordered_json::array();
  std::string words;
  for (const force_book::Entry& entry : entries) {
    words += (words.empty() ? "" : "\n") + head_of(entry);
    nlohmann::ordered_json json = force_book::to_json(entry);
    if (!entry.shoes.empty()) {
      const force_book::ShoeForce& last = entry.shoes.back();
      words +=
          FixedText<200>::format("\n  the last shoe: %.1f %% within 15 %%, %.1f N on average, %.1f N at most",
                                 100 * last.within, last.mean_newton, last.largest_newton)
              .c_str();
      json["last"] = {{"scan", last.scan},
                      {"within", last.within},
                      {"mean_n", last.mean_newton},
                      {"largest_n", last.largest_newton}};
    }
    BITELINE_ASSIGN(const std::optional<Wear> wear, wear_of(entry, options.reach_mm));
    if (wear) {
      words += "\n  " + words_of(*wear);
      json["wear"] = json_of(*wear);
    }
    report.fields["learned"].push_back(std::move(json));
  }
  if (entries.empty()) words = "no shoe has taught a force yet";
  return tell(report, {.quiet = false, .json = global.json}, words);
}

Result<ExitStatus> forget(const ForceOptions& options, const GlobalOptions& global) {
  report::Report report;
  Result<report::FileLock> lock =
      report::FileLock::take(options.results / "biteline-host.lock", "biteline work-force");
  if (!lock) return fail(lock.error().code, "%.200s; end the service first", to_line(lock.error()).c_str());
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(options.results / memory::k_memory_file));
  BITELINE_ASSIGN(const int gone, force_book::forget(memory, options.forget,
                                                     options.who.empty() ? user_name() : options.who));
  if (gone == 0)
    return fail(Errc::BadValue, "%.100s: no shoe of this model has taught a force; see biteline work-force",
                options.forget.c_str());
  report.fields["forgotten"] = gone;
  return tell(report, global,
              options.forget + ": what was learned of the force is forgotten; its next shoe is the first");
}

}  // namespace

void add_work_force(options::Command& app, Context& context) {
  auto options = std::make_shared<ForceOptions>();
  options::Command* command = app.add_subcommand(
      "work-force", "What a cell's shoes taught of the force, model by model, and the tool's wear by it");
  command->add_option("results", options->results, "The service's --out folder")->required();
  command->add_option("--forget", options->forget,
                      "Forget what this model's shoes taught: its tool was changed");
  command
      ->add_option("--reach-mm", options->reach_mm,
                   "How far the tip may leave its path along the force (force.reach_mm)")
      ->check(options::number({.minimum = 0.2, .maximum = 10}, "mm"));
  command->add_option("--who", options->who, "Whose hand it is; default: this user");
  command->callback([options, &context] {
    context.run = [options, &context] {
      return options->forget.empty() ? show(*options, context.options) : forget(*options, context.options);
    };
  });
}

}  // namespace biteline::app
