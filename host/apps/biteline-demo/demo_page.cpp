// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/demo_page.hpp"

#include <cmath>

#include "host/apps/biteline-demo/json_file.hpp"
#include "host/records/results/pictures/stages.hpp"
#include "host/records/results/pictures/transfer_stages.hpp"
#include "host/report/page.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using report::Page;

/// What the host wrote about one shoe.
struct Reports {
  Json line, plan, followed;
};

/// A number at /group/name, or a dash.
std::string number(const Json& value, const char* pointer, const char* unit) {
  const Json::json_pointer at{pointer};
  return value.contains(at) && value[at].is_number() ? report::value_text(value[at].get<double>(), unit)
                                                     : "-";
}

std::string seconds(const Json& value, const char* pointer) {
  const Json::json_pointer at{pointer};
  return value.contains(at) ? report::seconds_text(value[at].get<double>()) : "-";
}

/// All shoes in one table: a row for each measure.
void compare(Page& page, const std::vector<ShoeResult>& results, const std::vector<Reports>& reports) {
  std::vector<std::string> headings{""};
  for (const ShoeResult& result : results) headings.push_back(result.shoe.name);
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* name, const auto& value) {
    rows.push_back({name});
    for (std::size_t i = 0; i < results.size(); ++i) rows.back().push_back(value(results[i], reports[i]));
  };
  const auto of_error = [&](double evaluation::LineError::*member) {
    return [member](const ShoeResult& result, const Reports&) {
      return result.error ? report::value_text((*result.error).*member, "mm") : std::string{"-"};
    };
  };
  add("its line comes from", [](const ShoeResult& result, const Reports&) {
    return result.shoe.sample ? "the sample" : "its own groove";
  });
  add("length of the line",
      [](const ShoeResult&, const Reports& r) { return number(r.line, "/length_mm", "mm"); });
  add("line from the cell's own, mean", of_error(&evaluation::LineError::mean_mm));
  add("95 % of it within", of_error(&evaluation::LineError::p95_mm));
  add("largest", of_error(&evaluation::LineError::max_mm));
  add("the host's own bound for 95 %",
      [](const ShoeResult&, const Reports& r) { return number(r.line, "/bound_mm", "mm"); });
  add("the host's own confidence",
      [](const ShoeResult&, const Reports& r) { return number(r.line, "/confidence", ""); });
  add("difference of the two shapes, RMS",
      [](const ShoeResult&, const Reports& r) { return number(r.line, "/alignment/shape_rms_mm", "mm"); });
  add("arm's recorded track from the planned path, mean",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/from_path_mm/mean", "mm"); });
  add("95 % of it within",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/from_path_mm/p95", "mm"); });
  add("largest",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/from_path_mm/max", "mm"); });
  add("arm's recorded track from the line (process offset taken off), mean",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/from_line_mm/mean", "mm"); });
  add("largest",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/from_line_mm/max", "mm"); });
  add("share of the line that the arm passed",
      [](const ShoeResult&, const Reports& r) { return number(r.followed, "/covered", ""); });
  const auto of_made = [&](const char* name, double MadeTimes::*member) {
    add(name, [member](const ShoeResult& result, const Reports&) {
      return result.made ? report::seconds_text((*result.made).*member) : std::string{"-"};
    });
  };
  of_made("the scan, once round, in the arm's time", &MadeTimes::scan_s);
  of_made("until the arm stands", &MadeTimes::rest_s);
  of_made("until it sets out, line and path meanwhile", &MadeTimes::sets_out_s);
  of_made("way to the path's beginning", &MadeTimes::way_there_s);
  of_made("approach", &MadeTimes::approach_s);
  of_made("along the line", &MadeTimes::work_s);
  of_made("retreat", &MadeTimes::retreat_s);
  add("the whole shoe in the arm's time", [](const ShoeResult& result, const Reports&) {
    return result.made ? report::seconds_text(result.made->whole_s()) : std::string{"-"};
  });
  add("from the last profile to the line", [](const ShoeResult& result, const Reports& r) {
    return seconds(r.line, result.shoe.sample ? "/stages/transfer" : "/stages/last profile to line");
  });
  add("line to checked path",
      [](const ShoeResult&, const Reports& r) { return seconds(r.plan, "/stages/plan"); });
  add("the whole shoe, starting the programs included",
      [](const ShoeResult& result, const Reports&) { return report::seconds_text(result.wall_s); });
  page.table(headings, rows);
}

void show(Page& page, const ShoeResult& result, const Reports& reports) {
  const std::string folder = result.shoe.name + "/" + result.scan.filename().string();
  page.heading(result.shoe.name);
  page.paragraph(result.verdict);
  if (fs::exists(result.scan / "path/tracking.html")) page.frame(folder + "/path/tracking.html", 1280);
  std::vector<std::pair<std::string, double>> stages;
  for (const char* parts : {"extraction_s", "transfer_s"}) {
    if (!reports.line.contains(parts)) continue;
    for (const auto& [name, value] : reports.line[parts].items())
      stages.emplace_back(name, value.get<double>());
  }
  if (reports.plan.contains("/stages/plan"_json_pointer))
    stages.emplace_back("plan the path", reports.plan["stages"]["plan"].get<double>());
  page.durations(stages);
  const auto pictures = result.shoe.sample ? results::transfer_pictures(result.scan / "stages")
                                           : results::pictures(result.scan / "stages");
  for (const auto& [file, caption] : pictures) page.picture(folder + "/stages/" + file, caption);
  page.link(folder + "/index.html", "this scan's own page");
}

}  // namespace

Result<void> write_demo_page(const CellOptions& options, const std::vector<ShoeResult>& results,
                             const std::string& verdict, bool good) {
  std::vector<Reports> reports;
  for (const ShoeResult& result : results) {
    reports.push_back({.line = read_json(result.scan / "report.json"),
                       .plan = read_json(result.scan / "path/report.json"),
                       .followed = read_json(result.scan / "followed.json")});
  }
  Page page{"Biteline demo", verdict, good ? Page::Mood::Good : Page::Mood::Refused};
  page.paragraph("Simulated: the shoes (class " + options.shoe + ", seed " + std::to_string(options.seed) +
                 ", " +
                 (options.size > 0 ? "size " + std::to_string(std::lround(options.size)) : "as drawn") +
                 "), the pictures, the arm and its controller. Real: the sensor program, the host service, "
                 "and the protocols between all of them.");
  page.paragraph(
      "A sample with its sole is scanned once; its line is the groove. The uppers that follow have no sole, "
      "stand in other places and "
      "differ from the sample as one last differs from the next: each is aligned with the sample, takes its "
      "line over, and is followed by the arm.");
  page.heading("How good, how long");
  compare(page, results, reports);
  for (std::size_t i = 0; i < results.size(); ++i) show(page, results[i], reports[i]);
  return page.write(options.out / "index.html");
}

}  // namespace biteline::demo
