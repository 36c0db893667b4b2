// SPDX-License-Identifier: MIT
// biteline history: what the service remembers of its shoes.
#include "host/records/memory/history.hpp"

#include <cstdio>

#include "common/core/fixed_text.hpp"
#include "common/core/text.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/history_log.hpp"

namespace biteline::app {
namespace {

struct HistoryOptions {
  std::filesystem::path results, kept_links;
  std::string from, to, model, verdict, reason, part, zone, day_begin;
  std::string separator{"comma"}, decimal{"point"};
  int limit{20};
  bool csv{false}, trends{false}, why{false}, byte_mark{false}, verify_log{false};
};

Result<memory::ScanFilter> filter_of(const HistoryOptions& options, const memory::FactoryDay& day) {
  memory::ScanFilter filter;
  for (const auto& [text, time, name] :
       {std::tuple{&options.from, &filter.from, "--from"}, std::tuple{&options.to, &filter.to, "--to"}}) {
    if (text->empty()) continue;
    *time = day.time_of(*text);
    if (!*time) {
      return fail(
          Errc::InvalidArgument,
          "%s '%.40s': a day or time such as 2026-11-20, 2026-11-20T21:04 or 2026-11-20T13:04:05Z expected",
          name, text->c_str());
    }
  }
  filter.model = options.model;
  filter.verdict = options.verdict;
  filter.reason_code = options.reason;
  filter.part = options.part;
  filter.limit = options.limit;
  return filter;
}

std::string figure(const char* pattern, const std::optional<double>& number) {
  return number ? std::string{FixedText<40>::format(pattern, *number).view()} : std::string{"-"};
}

std::string words_of(const memory::Scan& scan) {
  using Text = FixedText<400>;
  return Text::format("%-19s %-12s %-8s %-9s %10s %6s %8s  %s", memory::local_time(scan.time).c_str(),
                      scan.name.c_str(), scan.verdict.c_str(), scan.decision.c_str(),
                      figure("%.1f mm", scan.length_mm).c_str(), figure("%.2f", scan.confidence).c_str(),
                      figure("%.1f s", scan.cycle_s).c_str(),
                      (scan.reason_code.empty() ? scan.model : scan.reason_code).c_str())
      .c_str();
}

/// Lines of their own below a row; none where nothing ended it.
std::string why_of(const memory::Scan& scan) {
  std::string words;
  if (!scan.reason.empty()) words += "\n    " + clean_text(scan.reason, 1000);
  if (!scan.next_step.empty()) words += "\n    next: " + clean_text(scan.next_step, 500);
  return words;
}

nlohmann::ordered_json json_of(const memory::Scan& scan) {
  const auto or_null = [](const std::optional<double>& number) {
    return number ? nlohmann::ordered_json(*number) : nlohmann::ordered_json{};
  };
  return {{"scan", scan.name},
          {"time", memory::to_iso(scan.time)},
          {"verdict", scan.verdict},
          {"reason_code", scan.reason_code},
          {"reason", scan.reason},
          {"next_step", scan.next_step},
          {"ended_by", report::name_of(memory::ended_by(scan))},
          {"model", scan.model},
          {"process", scan.process},
          {"part", scan.part},
          {"foot", scan.foot},
          {"size", scan.size},
          {"length_mm", or_null(scan.length_mm)},
          {"confidence", or_null(scan.confidence)},
          {"u95_mm", or_null(scan.u95_mm)},
          {"tip_bound_mm", or_null(scan.tip_bound_mm)},
          {"weak_stretches", scan.weak_stretches},
          {"line_s", or_null(scan.line_s)},
          {"cycle_s", or_null(scan.cycle_s)},
          {"decision", scan.decision},
          {"decided_by", scan.decided_by},
          {"sent", scan.sent},
          {"work", scan.work.verdict},
          {"work_reworked", scan.work.reworked},
          {"work_missing_mm", or_null(scan.work.missing_mm)},
          {"work_narrow", scan.work.narrow},
          {"work_wide", scan.work.wide},
          {"work_beside", scan.work.beside},
          {"work_doubled", scan.work.doubled},
          {"follows", scan.follows},
          {"operator", scan.operator_name}};
}

Result<ExitStatus> run_list(const memory::Memory& memory, const memory::ScanFilter& filter, bool why,
                            const GlobalOptions& global) {
  BITELINE_ASSIGN(const memory::ScanPage page, memory.scans(filter));
  report::Report report;
  report.fields["scans"] = nlohmann::ordered_json::array();
  std::string words;
  for (const memory::Scan& scan : page.scans) {
    report.fields["scans"].push_back(json_of(scan));
    words += (words.empty() ? "" : "\n") + words_of(scan);
    if (why) words += why_of(scan);
  }
  report.fields["more"] = page.next_id > 0;
  if (words.empty()) words = "no scan of this kind";
  if (page.next_id > 0) words += "\n(more: --limit, or --csv for all)";
  // The list is the result: --quiet leaves it.
  return tell(report, {.quiet = false, .json = global.json}, words);
}

Result<ExitStatus> run_trends(const memory::Memory& memory, const memory::ScanFilter& filter,
                              const memory::FactoryDay& factory, const GlobalOptions& global) {
  BITELINE_ASSIGN(const memory::Trends trends, memory.trends(filter, factory, memory::Span::Day));
  report::Report report;
  report.fields = memory::to_json(trends);
  using Text = FixedText<300>;
  std::string words = "day         scans     ok  amber refused failed  cycle";
  for (const memory::Trend& day : trends.buckets) {
    words += Text::format("\n%.10s %6lld %6lld %6lld %7lld %6lld %6s", factory.name_of(day.begin).c_str(),
                          static_cast<long long>(day.scans), static_cast<long long>(day.ok),
                          static_cast<long long>(day.amber), static_cast<long long>(day.refused),
                          static_cast<long long>(day.failed), figure("%.1f s", day.median_cycle_s).c_str())
                 .c_str();
  }
  for (const memory::ReasonCount& reason : trends.reasons)
    words += Text::format("\n%6lld  %-8s %s", static_cast<long long>(reason.scans),
                          report::name_of(report::ended_by(reason.reason_code)), reason.reason_code.c_str())
                 .c_str();
  words += Text::format("\nended by a person %lld, by the machine %lld, by the shoe %lld",
                        report.fields["ended_by"].value("person", 0LL),
                        report.fields["ended_by"].value("machine", 0LL),
                        report.fields["ended_by"].value("shoe", 0LL))
               .c_str();
  return tell(report, {.quiet = false, .json = global.json}, words);
}

/// The service's own, unless it is told here.
Result<memory::FactoryDay> day_of(const HistoryOptions& options, const memory::Memory& memory) {
  memory::FactoryDay day = memory::FactoryDay::of(memory);
  BITELINE_TRY(memory::use_time_zone(options.zone));
  if (options.day_begin.empty()) return day;
  const std::optional<memory::FactoryDay> told = memory::FactoryDay::from(options.day_begin);
  if (!told)
    return fail(Errc::InvalidArgument, "--day-begin '%.20s': a time of day such as 06:00 expected",
                options.day_begin.c_str());
  return *told;
}

Result<ExitStatus> run_history(const HistoryOptions& options, const GlobalOptions& global) {
  const auto style = memory::csv_style(options.separator, options.decimal, options.byte_mark);
  if (!style)
    return fail(Errc::InvalidArgument, "--csv-separator and --csv-decimal: two different signs expected");
  BITELINE_ASSIGN(const memory::Memory memory,
                  memory::Memory::open_to_read(options.results / memory::k_memory_file));
  if (options.verify_log) return verify_log(memory, options.kept_links, global);
  BITELINE_ASSIGN(const memory::FactoryDay day, day_of(options, memory));
  BITELINE_ASSIGN(const memory::ScanFilter filter, filter_of(options, day));
  if (options.trends) return run_trends(memory, filter, day, global);
  if (!options.csv) return run_list(memory, filter, options.why, global);
  BITELINE_ASSIGN(const std::string csv, memory::history_csv(memory, filter, *style, day));
  if (std::fwrite(csv.data(), 1, csv.size(), stdout) != csv.size() || std::fflush(stdout) != 0)
    return fail(Errc::WriteFailed, "stdout");
  return ExitStatus::Done;
}

}  // namespace

void add_history(options::Command& app, Context& context) {
  auto options = std::make_shared<HistoryOptions>();
  options::Command* command =
      app.add_subcommand("history", "What a service remembers of its shoes; also while it runs");
  command->add_option("results", options->results, "The service's --out folder")->required();
  command->add_option("--from", options->from,
                      "At or after this day or time of the factory; with Z at its end UTC");
  command->add_option("--to", options->to, "Before this day or time, likewise");
  command->add_option("--model", options->model, "Of this model");
  command->add_option("--part", options->part, "Of this part number; with * at its end all that begin so");
  command->add_option("--verdict", options->verdict, "Of this verdict")
      ->check(options::one_of({"working", "ok", "amber", "review", "refused", "failed"}));
  command->add_option("--reason", options->reason, "Of this reason code, such as no_crease");
  command->add_flag("--why", options->why, "Below each shoe: why it ended so, and what was the next step");
  command->add_option("--limit", options->limit, "Newest so many")
      ->check(options::whole_number(1, memory::k_most_scans))
      ->capture_default_str();
  auto* csv = command->add_flag("--csv", options->csv, "All of them as CSV, whatever the limit");
  command
      ->add_option("--csv-separator", options->separator, "Between its cells: what the spreadsheet expects")
      ->check(options::one_of({"comma", "semicolon", "tab"}))
      ->capture_default_str();
  command->add_option("--csv-decimal", options->decimal, "In its numbers")
      ->check(options::one_of({"point", "comma"}))
      ->capture_default_str();
  command->add_flag("--csv-byte-mark", options->byte_mark, "A byte mark first, by which Excel knows UTF-8");
  command->add_option("--time-zone", options->zone, "Such as Asia/Shanghai; else the service's own");
  command->add_option("--day-begin", options->day_begin,
                      "When the day begins, hh:mm; else the service's own");
  options::Option* trends =
      command->add_flag("--trends", options->trends, "Counts by day, and reasons by count")->excludes(csv);
  options::Option* verify =
      command
          ->add_flag("--verify-log", options->verify_log,
                     "Say instead whether the log is as it was written; exit status 3 where it is not")
          ->excludes(csv)
          ->excludes(trends);
  command
      ->add_option("--kept-links", options->kept_links,
                   "A file of links, best on another machine: compared, then the newest link is added")
      ->needs(verify);
  command->callback([options, &context] {
    context.run = [options, &context] { return run_history(*options, context.options); };
  });
}

}  // namespace biteline::app
