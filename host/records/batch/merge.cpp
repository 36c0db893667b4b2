// SPDX-License-Identifier: MIT
#include "host/records/batch/merge.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/records/batch/line_drawing.hpp"
#include "host/report/page.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

Result<void> add_shard(const BatchRun& run, std::size_t shard, ResultWriter& writer) {
  const fs::path file = run.shard_file(shard);
  BITELINE_ASSIGN(const ordered_json json, read_json_object(file));
  BITELINE_ASSIGN(const ordered_json* const results, (JsonFields{json, file}.array("results")));
  const ResultStore store = run.store();
  for (std::size_t i = 0; i < results->size(); ++i) {
    const Recording& recording = run.plan.recordings[run.plan.shards[shard][i]];
    BITELINE_ASSIGN(Outcome outcome, outcome_of((*results)[i], file));
    const std::string key = run.key_of(recording);
    ResultRow row{.name = recording.name,
                  .kind = name_of(recording.kind),
                  .hash = recording.hash,
                  .outcome = std::move(outcome),
                  .cost = {}};
    if (const Result<Cost> cost = store.cost(key)) row.cost = *cost;
    std::vector<LinePlace> places;
    if (!row.outcome.line_hash.empty()) {
      BITELINE_ASSIGN(const cloud::ClosedLine line, cloud::read_line(store.line_file(key)));
      places = places_of(line);
    }
    BITELINE_TRY(writer.add(row, places));
  }
  return {};
}

/// Of what has the figure, in rising order.
std::vector<double> sorted_figures(const ResultSet& results,
                                   const std::function<std::optional<double>(const ResultRow&)>& figure) {
  std::vector<double> values;
  for (const ResultRow& row : results.rows()) {
    if (const std::optional<double> value = figure(row)) values.push_back(*value);
  }
  std::ranges::sort(values);
  return values;
}

double quantile(const std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(std::floor(share * static_cast<double>(sorted.size() - 1) + 0.5));
  return sorted[at];
}

void add_spread(report::Page& page, const ResultSet& results) {
  struct Row {
    const char* name;
    const char* pattern;
    std::function<std::optional<double>(const ResultRow&)> figure;
  };
  const auto of_cost = [](double Cost::*member) {
    return [member](const ResultRow& row) {
      return row.cost ? std::optional{(*row.cost).*member} : std::nullopt;
    };
  };
  const auto of_outcome = [](std::optional<double> Outcome::*member) {
    return [member](const ResultRow& row) { return row.outcome.*member; };
  };
  const std::vector<Row> rows{{"error, mean [mm]", "%.3f", of_outcome(&Outcome::error_mean_mm)},
                              {"error, 95 % of a line [mm]", "%.3f", of_outcome(&Outcome::error_p95_mm)},
                              {"error, largest of a line [mm]", "%.3f", of_outcome(&Outcome::error_max_mm)},
                              {"truth within U95 (share)", "%.3f", of_outcome(&Outcome::u95_inside)},
                              {"U95 of a line [mm]", "%.3f", of_outcome(&Outcome::u95_mm)},
                              {"confidence", "%.3f", of_outcome(&Outcome::confidence)},
                              {"time [s]", "%.2f", of_cost(&Cost::wall_s)},
                              {"processor time [s]", "%.2f", of_cost(&Cost::cpu_s)},
                              {"largest memory [MB]", "%.0f", of_cost(&Cost::peak_memory_mb)}};
  std::vector<std::vector<std::string>> cells;
  for (const Row& row : rows) {
    const std::vector<double> values = sorted_figures(results, row.figure);
    if (values.empty()) continue;
    std::vector<std::string> line{row.name, std::to_string(values.size())};
    for (const double share : {0.0, 0.5, 0.95, 1.0}) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
      line.emplace_back(FixedText<40>::format(row.pattern, quantile(values, share)).c_str());
#pragma GCC diagnostic pop
    }
    cells.push_back(std::move(line));
  }
  page.table({"figure", "of", "least", "median", "95 %", "most"}, cells);
}

void add_reasons(report::Page& page, const ResultSet& results) {
  std::map<std::string, std::size_t> counts;
  for (const ResultRow& row : results.rows()) {
    if (row.outcome.verdict == "ok") continue;
    ++counts[row.outcome.verdict + (row.outcome.reason_code.empty() ? "" : ": " + row.outcome.reason_code)];
  }
  std::vector<std::pair<std::string, std::size_t>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(sorted, std::greater{}, &std::pair<std::string, std::size_t>::second);
  std::vector<std::vector<std::string>> cells;
  for (const auto& [reason, count] : sorted) cells.push_back({reason, std::to_string(count)});
  if (cells.empty()) return;
  page.heading("Reasons");
  page.table({"reason", "recordings"}, cells);
}

void add_named(report::Page& page, const ResultSet& results, const char* heading,
               const std::function<bool(const ResultRow&)>& wanted) {
  constexpr std::size_t k_most_rows = 200;
  std::vector<std::vector<std::string>> cells;
  std::size_t count = 0;
  for (const ResultRow& row : results.rows()) {
    if (!wanted(row)) continue;
    if (++count <= k_most_rows) cells.push_back({row.name, row.outcome.verdict, row.outcome.reason});
  }
  if (count == 0) return;
  page.heading(heading);
  page.table({"recording", "verdict", "reason"}, cells);
  if (count > k_most_rows) page.paragraph("and " + std::to_string(count - k_most_rows) + " more");
}

/// The larger, the worse: what is off by the truth, before what is unsure without one.
double badness(const ResultRow& row) {
  if (row.outcome.error_max_mm) return 1e6 + *row.outcome.error_max_mm;
  return row.outcome.u95_max_mm.value_or(0);
}

std::vector<LinePlace> truth_places(const BatchPlan& plan, const std::string& name) {
  const auto at = std::ranges::lower_bound(plan.recordings, name, {}, &Recording::name);
  if (at == plan.recordings.end() || at->name != name || is_made(at->kind)) return {};
  const fs::path file = truth_of(at->kind, at->path);
  if (file.empty()) return {};
  const Result<cloud::ClosedLine> truth = cloud::read_positions(file);
  return truth ? places_of(*truth) : std::vector<LinePlace>{};
}

Result<void> add_worst(report::Page& page, const ResultSet& results, const BatchPlan& plan,
                       const fs::path& out, int pictures) {
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < results.rows().size(); ++i) {
    if (results.rows()[i].outcome.verdict == "ok") lines.push_back(i);
  }
  std::ranges::stable_sort(lines, std::greater{}, [&](std::size_t i) { return badness(results.rows()[i]); });
  lines.resize(std::min(lines.size(), static_cast<std::size_t>(std::max(pictures, 0))));
  if (lines.empty()) return {};
  page.heading("The worst lines");
  page.paragraph(
      "By their largest error where the truth is known, else by their largest U95. Red: U95 above 1 mm. "
      "Thin and blue: the truth.");
  for (std::size_t rank = 0; rank < lines.size(); ++rank) {
    const ResultRow& row = results.rows()[lines[rank]];
    BITELINE_ASSIGN(const std::vector<LinePlace> line, results.line(lines[rank]));
    const std::vector<LinePlace> truth = truth_places(plan, row.name);
    std::vector<bool> unsure;
    for (const LinePlace& place : line) unsure.push_back(place.u95_mm > 1);
    DrawnPanel panel{.title = row.name, .lines = {{.places = line, .marked = unsure}}};
    if (!truth.empty()) panel.lines.push_back({.places = truth, .marked = {}, .thin = true});
    const std::string name = "worst_" + std::to_string(rank + 1) + ".svg";
    BITELINE_TRY(report::write_file_atomically(out / name, draw_lines({panel})));
    std::string caption = row.name;
    if (row.outcome.error_max_mm)
      caption += FixedText<80>::format(": off by %.3f mm at most, %.3f mm on average",
                                       *row.outcome.error_max_mm, row.outcome.error_mean_mm.value_or(0))
                     .c_str();
    if (row.outcome.u95_max_mm)
      caption += FixedText<40>::format("; U95 up to %.3f mm", *row.outcome.u95_max_mm).c_str();
    page.picture(name, caption);
  }
  return {};
}

}  // namespace

Result<ResultSet> merge_run(const BatchRun& run, const fs::path& out) {
  if (const std::vector<std::size_t> missing = missing_shards(run); !missing.empty()) {
    return fail(Errc::FileNotFound, "%.150s: %zu of %zu shards are not done; run: biteline batch run",
                run.run_folder().c_str(), missing.size(), run.plan.shards.size());
  }
  BITELINE_TRY(report::prepare_folder(out));
  BITELINE_ASSIGN(ResultWriter writer,
                  ResultWriter::create(out / k_result_file, {.build = run.build.identity,
                                                             .settings = settings_text(run.plan.settings)}));
  for (std::size_t shard = 0; shard < run.plan.shards.size(); ++shard)
    BITELINE_TRY(add_shard(run, shard, writer));
  BITELINE_TRY(writer.finish());
  return ResultSet::open(out);
}

Result<void> write_results_page(const ResultSet& results, const BatchPlan& plan, const fs::path& out,
                                int pictures) {
  std::map<std::string, std::size_t> verdicts;
  std::size_t wrong = 0, judged = 0;
  bool failures = false;
  for (const ResultRow& row : results.rows()) {
    ++verdicts[row.outcome.verdict];
    if (row.outcome.wrong_mm) ++judged;
    if (is_wrong(row.outcome)) ++wrong;
    failures = failures || !is_answer(row.outcome.verdict);
  }
  std::string verdict = std::to_string(results.rows().size()) + " recordings";
  for (const auto& [name, count] : verdicts) verdict += ", " + std::to_string(count) + " " + name;
  if (judged > 0)
    verdict += "; " + std::to_string(wrong) + " of " + std::to_string(judged) + " judged lines wrong";
  using enum report::Page::Mood;
  report::Page page{"Batch", verdict, wrong > 0 ? Refused : failures ? Look : Good};
  page.figures({{"build", results.run().build}, {"settings", results.run().settings}});
  page.paragraph(
      "A line is wrong when more than 5 mm of it lie off the truth by more than 1 mm outside flagged "
      "points.");
  page.heading("Figures");
  add_spread(page, results);
  add_reasons(page, results);
  add_named(page, results, "Without an answer",
            [](const ResultRow& row) { return !is_answer(row.outcome.verdict); });
  add_named(page, results, "Wrong", [](const ResultRow& row) { return is_wrong(row.outcome); });
  add_named(page, results, "Unreadable",
            [](const ResultRow& row) { return row.outcome.verdict == "unreadable"; });
  BITELINE_TRY(add_worst(page, results, plan, out, pictures));
  page.link(k_result_file, "all results (SQLite)");
  return page.write(out / "index.html");
}

}  // namespace biteline::batch
