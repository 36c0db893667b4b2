// SPDX-License-Identifier: MIT
#include "host/records/batch/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/records/batch/line_drawing.hpp"
#include "host/report/page.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

/// How far `points` lie from `line`, and which of them beyond what they state.
struct Move {
  double largest_mm{0};
  std::size_t beyond{0};
  std::vector<bool> marks;
};

Move move_of(const std::vector<LinePlace>& points, const std::vector<LinePlace>& line) {
  Move move;
  for (const LinePlace& point : points) {
    const double off_mm = distance_mm(point, line);
    const double allowed_mm = std::max(
        k_no_move_mm, point.u95_mm >= 0 ? static_cast<double>(point.u95_mm) : k_allowed_without_u95_mm);
    move.largest_mm = std::max(move.largest_mm, off_mm);
    move.marks.push_back(off_mm > allowed_mm);
    if (move.marks.back()) ++move.beyond;
  }
  return move;
}

/// By the truth, where both were judged by it.
std::optional<bool> truth_says_better(const Outcome& before, const Outcome& after) {
  if (!after.error_p95_mm || is_wrong(after)) return after.error_p95_mm ? std::optional{false} : std::nullopt;
  if (!before.error_p95_mm) return true;  // a line where there was none, and it is right
  return *after.error_p95_mm <= *before.error_p95_mm;
}

Judgement judged(const std::optional<bool>& better) {
  return better.value_or(false) ? Judgement::Better : Judgement::Worse;
}

/// ok above review above refused and unreadable, and those above any end without an answer.
Judgement judge_verdicts(const Outcome& before, const Outcome& after) {
  if (!is_answer(after.verdict)) return is_answer(before.verdict) ? Judgement::Worse : Judgement::Same;
  if (!is_answer(before.verdict)) return is_wrong(after) ? Judgement::Worse : Judgement::Better;
  if (after.verdict == "ok") return judged(truth_says_better(before, after));
  if (after.verdict == "review" && before.verdict != "ok")
    return is_wrong(after) ? Judgement::Worse : Judgement::Better;
  // A wrong line that is refused or a person's now is what these are for.
  if (has_line(before.verdict)) return is_wrong(before) ? Judgement::Better : Judgement::Worse;
  return Judgement::Worse;  // refused became unreadable, or the other way: nobody meant that
}

std::string told(const Outcome& outcome) {
  return outcome.verdict + (outcome.reason_code.empty() ? "" : " (" + outcome.reason_code + ")");
}

Result<std::optional<Difference>> compare_lines(const ResultSet& before, std::size_t old_row,
                                                const ResultSet& after, std::size_t new_row) {
  BITELINE_ASSIGN(const std::vector<LinePlace> old_line, before.line(old_row));
  BITELINE_ASSIGN(const std::vector<LinePlace> new_line, after.line(new_row));
  // From the points of a baseline onto the whole line: between its points a baseline says nothing.
  Move back = move_of(old_line, new_line);
  Move there;
  if (before.has_whole_lines()) there = move_of(new_line, old_line);
  if (there.beyond + back.beyond == 0) return std::optional<Difference>{};
  const Outcome &was = before.rows()[old_row].outcome, &is = after.rows()[new_row].outcome;
  Difference difference{.name = after.rows()[new_row].name,
                        .judgement = judged(truth_says_better(was, is)),
                        .what = {},
                        .old_row = old_row,
                        .new_row = new_row,
                        .moved_mm = std::max(there.largest_mm, back.largest_mm),
                        .moved = std::move(there.marks)};
  difference.what = FixedText<160>::format("line moved by up to %.3f mm, %zu points beyond their U95",
                                           difference.moved_mm, std::max(there.beyond, back.beyond))
                        .c_str();
  if (was.error_p95_mm && is.error_p95_mm) {
    difference.what +=
        FixedText<96>::format("; error (95 %%) %.3f to %.3f mm", *was.error_p95_mm, *is.error_p95_mm).c_str();
  }
  return std::optional{std::move(difference)};
}

Result<std::optional<Difference>> compare_rows(const ResultSet& before, std::size_t old_row,
                                               const ResultSet& after, std::size_t new_row) {
  const ResultRow &was = before.rows()[old_row], &is = after.rows()[new_row];
  const auto difference = [&](Judgement judgement, std::string what) {
    return std::optional{Difference{.name = is.name,
                                    .judgement = judgement,
                                    .what = std::move(what),
                                    .old_row = old_row,
                                    .new_row = new_row,
                                    .moved_mm = 0,
                                    .moved = {}}};
  };
  if (was.hash != is.hash) return difference(Judgement::Worse, "another recording under the same name");
  if (was.outcome.verdict != is.outcome.verdict)
    return difference(judge_verdicts(was.outcome, is.outcome),
                      told(was.outcome) + " became " + told(is.outcome));
  if (has_line(is.outcome.verdict)) {
    if (!was.outcome.line_hash.empty() && was.outcome.line_hash == is.outcome.line_hash)
      return std::optional<Difference>{};
    return compare_lines(before, old_row, after, new_row);
  }
  if (was.outcome.reason_code != is.outcome.reason_code)
    return difference(Judgement::Same, told(was.outcome) + " became " + told(is.outcome));
  return std::optional<Difference>{};
}

void add_costs(Comparison& comparison, const ResultRow& was, const ResultRow& is) {
  if (!was.cost || !is.cost) return;
  comparison.old_cpu_s = comparison.old_cpu_s.value_or(0) + was.cost->cpu_s;
  comparison.new_cpu_s = comparison.new_cpu_s.value_or(0) + is.cost->cpu_s;
  comparison.old_memory_mb = std::max(comparison.old_memory_mb.value_or(0), was.cost->peak_memory_mb);
  comparison.new_memory_mb = std::max(comparison.new_memory_mb.value_or(0), is.cost->peak_memory_mb);
}

const char* word_of(Judgement judgement) {
  return judgement == Judgement::Better ? "better" : judgement == Judgement::Worse ? "worse" : "same";
}

constexpr std::array k_refusals{report::RefusalRow<CompareRefused>{
    CompareRefused::Worse, "batch_worse",
    "Open index.html and look at the recordings that it names; pin a new baseline only if they are right."}};

}  // namespace

std::span<const report::RefusalRow<CompareRefused>> refusal_table(CompareRefused) {
  return k_refusals;
}

std::size_t Comparison::count(Judgement judgement) const {
  return static_cast<std::size_t>(std::ranges::count(differences, judgement, &Difference::judgement));
}

Result<Comparison> compare_runs(const ResultSet& before, const ResultSet& after) {
  Comparison comparison;
  const auto& old_rows = before.rows();
  const auto& new_rows = after.rows();
  std::size_t o = 0, n = 0;
  while (o < old_rows.size() || n < new_rows.size()) {
    if (o == old_rows.size() || (n < new_rows.size() && new_rows[n].name < old_rows[o].name)) {
      ++comparison.added;
      ++n;
    } else if (n == new_rows.size() || old_rows[o].name < new_rows[n].name) {
      comparison.differences.push_back({.name = old_rows[o].name,
                                        .judgement = Judgement::Worse,
                                        .what = "not in the new run",
                                        .old_row = o,
                                        .new_row = {},
                                        .moved_mm = 0,
                                        .moved = {}});
      ++o;
    } else {
      BITELINE_ASSIGN(std::optional<Difference> difference, compare_rows(before, o, after, n));
      if (difference) comparison.differences.push_back(std::move(*difference));
      add_costs(comparison, old_rows[o], new_rows[n]);
      ++comparison.compared;
      ++o;
      ++n;
    }
  }
  return comparison;
}

std::optional<report::Refusal<CompareRefused>> refusal_of(const Comparison& comparison) {
  constexpr std::size_t k_most = 5;
  const std::size_t worse = comparison.count(Judgement::Worse);
  if (worse == 0) return std::nullopt;
  std::string names;
  std::size_t named = 0;
  for (const Difference& difference : comparison.differences) {
    if (difference.judgement != Judgement::Worse || ++named > k_most) continue;
    names += (names.empty() ? "" : "; ") + difference.name + ": " + difference.what;
  }
  if (worse > k_most) names += "; and " + std::to_string(worse - k_most) + " more";
  return report::Refusal<CompareRefused>{
      .code = CompareRefused::Worse,
      .reason =
          std::to_string(worse) + (worse == 1 ? " recording is worse: " : " recordings are worse: ") + names};
}

Result<void> write_comparison_page(const Comparison& comparison, const ResultSet& before,
                                   const ResultSet& after, const std::filesystem::path& out, int pictures) {
  BITELINE_TRY(report::prepare_folder(out));
  const std::size_t worse = comparison.count(Judgement::Worse), better = comparison.count(Judgement::Better);
  using enum report::Page::Mood;
  report::Page page{"Two builds compared",
                    std::to_string(comparison.compared) + " recordings: " + std::to_string(worse) +
                        " worse, " + std::to_string(better) + " better",
                    worse > 0 ? Refused : Good};
  std::vector<std::pair<std::string, std::string>> figures{{"old build", before.run().build},
                                                           {"new build", after.run().build},
                                                           {"old settings", before.run().settings},
                                                           {"new settings", after.run().settings}};
  if (comparison.added > 0)
    figures.emplace_back("only in the new run, not judged", std::to_string(comparison.added));
  const auto pair_text = [](const char* pattern, double was, double is) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    return std::string{FixedText<80>::format(pattern, was, is).view()};
#pragma GCC diagnostic pop
  };
  if (comparison.old_cpu_s && comparison.new_cpu_s)
    figures.emplace_back("processor time, old and new",
                         pair_text("%.1f s, %.1f s", *comparison.old_cpu_s, *comparison.new_cpu_s));
  if (comparison.old_memory_mb && comparison.new_memory_mb)
    figures.emplace_back("largest memory, old and new",
                         pair_text("%.0f MB, %.0f MB", *comparison.old_memory_mb, *comparison.new_memory_mb));
  page.figures(figures);
  page.heading("Changes");
  if (comparison.differences.empty()) page.paragraph("None: every answer is the same.");
  std::vector<std::vector<std::string>> cells;
  for (const Difference& difference : comparison.differences)
    cells.push_back({difference.name, word_of(difference.judgement), difference.what});
  if (!cells.empty()) page.table({"recording", "judged", "what changed"}, cells);

  std::vector<const Difference*> drawn;
  for (const Difference& difference : comparison.differences) {
    if (difference.old_row && difference.new_row) drawn.push_back(&difference);
  }
  std::ranges::stable_sort(drawn, [](const Difference* a, const Difference* b) {
    return std::pair{a->judgement == Judgement::Worse, a->moved_mm} >
           std::pair{b->judgement == Judgement::Worse, b->moved_mm};
  });
  int count = 0;
  for (const Difference* difference : drawn) {
    BITELINE_ASSIGN(const std::vector<LinePlace> old_line, before.line(*difference->old_row));
    BITELINE_ASSIGN(const std::vector<LinePlace> new_line, after.line(*difference->new_row));
    if ((old_line.empty() && new_line.empty()) || count >= pictures) continue;
    if (count == 0) {
      page.heading("Both lines");
      page.paragraph("Left the old line, right the new one. Red: moved by more than its U95.");
    }
    const std::string name = "difference_" + std::to_string(++count) + ".svg";
    BITELINE_TRY(report::write_file_atomically(
        out / name, draw_lines({{.title = "old: " + told(before.rows()[*difference->old_row].outcome),
                                 .lines = {{.places = old_line, .marked = {}}}},
                                {.title = "new: " + told(after.rows()[*difference->new_row].outcome),
                                 .lines = {{.places = new_line, .marked = difference->moved}}}})));
    page.picture(name, difference->name + ": " + difference->what);
  }
  return page.write(out / "index.html");
}

}  // namespace biteline::batch
