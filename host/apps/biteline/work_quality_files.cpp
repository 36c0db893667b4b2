// SPDX-License-Identifier: MIT
#include "host/apps/biteline/work_quality_files.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "common/csv/table.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/report/page.hpp"
#include "host/report/report.hpp"

namespace biteline::app {
namespace {

/// Columns of the band.csv of `biteline inspect`.
constexpr std::size_t k_band_columns = 12, k_state = 1, k_low = 2, k_high = 7;

std::string number(const char* form, double value) {
  return std::string{FixedText<48>::format(form, value).view()};
}

/// AIAG, Production Part Approval Process, 4th edition, 2.2.11.3.
struct Judged {
  const char* words;
  report::Page::Mood mood;
};
Judged judged(double ppk) {
  using Mood = report::Page::Mood;
  if (ppk > 1.67) return {"meets what AIAG asks of a new process (above 1.67)", Mood::Good};
  if (ppk >= 1.33) return {"may do: AIAG asks for above 1.67, and lets 1.33 pass after a talk", Mood::Look};
  return {"does not do: AIAG asks for 1.33 at least", Mood::Refused};
}

/// Along the shoes to the right, values up.
class Plot {
 public:
  explicit Plot(const QualityStudy& of)
      : last_{of.points.back().x}, low_{of.limits.low}, high_{of.limits.high} {
    for (const study::TrendPoint& point : of.points) {
      low_ = std::min(low_, point.value);
      high_ = std::max(high_, point.value);
    }
    const double room = 0.08 * (high_ - low_);
    low_ -= room;
    high_ += room;
  }
  [[nodiscard]] std::string line(const study::TrendPoint& from, const study::TrendPoint& to,
                                 const char* style) const {
    return FixedText<240>::format("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>\n",
                                  x_px(from.x), y_px(from.value), x_px(to.x), y_px(to.value), style)
        .c_str();
  }
  [[nodiscard]] std::string dot(const study::TrendPoint& at) const {
    return FixedText<160>::format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"#268\"/>\n", x_px(at.x),
                                  y_px(at.value))
        .c_str();
  }
  [[nodiscard]] std::string text(const study::TrendPoint& at, const std::string& words) const {
    return FixedText<240>::format("<text x=\"%.1f\" y=\"%.1f\">%s</text>\n", x_px(at.x) + 4,
                                  y_px(at.value) - 4, words.c_str())
        .c_str();
  }
  static constexpr double k_width_px = 720, k_height_px = 260, k_margin_px = 30;

 private:
  [[nodiscard]] double x_px(double x) const {
    return k_margin_px + (k_width_px - 2 * k_margin_px) * (x - 1) / std::max(1.0, last_ - 1);
  }
  [[nodiscard]] double y_px(double value) const {
    return k_margin_px + (k_height_px - 2 * k_margin_px) * (high_ - value) / (high_ - low_);
  }
  double last_, low_, high_;
};

}  // namespace

Result<ShoeWork> read_shoe_work(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "report.json";
  BITELINE_ASSIGN(const nlohmann::ordered_json report, batch::read_json_object(file));
  ShoeWork look{.name = std::filesystem::absolute(folder / "report.json").parent_path().filename().string()};
  const batch::JsonFields fields{report, file};
  BITELINE_ASSIGN(const nlohmann::ordered_json* work, fields.object("work"));
  const batch::JsonFields plan{*work, file};
  BITELINE_ASSIGN(const double low_mm, plan.number("planned_low_mm"));
  BITELINE_ASSIGN(const double high_mm, plan.number("planned_high_mm"));
  BITELINE_ASSIGN(look.tolerance_mm, plan.number("tolerance_mm"));
  look.planned_width_mm = high_mm - low_mm;
  if (!(look.planned_width_mm > 0) || !(look.tolerance_mm > 0))
    return fail(Errc::BadValue, "%.200s: a band and a tolerance above 0 expected", file.c_str());
  std::error_code error;
  if (!std::filesystem::exists(folder / "band.csv", error)) return look;
  double width_mm = 0, off_mm = 0;
  BITELINE_TRY(csv::read_table(
      folder / "band.csv", k_band_columns, k_band_columns, [&](const csv::Row& row) -> Result<void> {
        if (row.text(k_state) != "worked" || row.text(k_low).empty() || row.text(k_high).empty()) return {};
        BITELINE_ASSIGN(const double low, row.number(k_low));
        BITELINE_ASSIGN(const double high, row.number(k_high));
        const double width = high - low;
        look.least_width_mm = look.places == 0 ? width : std::min(look.least_width_mm, width);
        look.largest_width_mm = std::max(look.largest_width_mm, width);
        width_mm += width;
        off_mm += 0.5 * (low + high) - 0.5 * (low_mm + high_mm);
        ++look.places;
        return {};
      }));
  if (look.places > 0) {
    look.width_mm = width_mm / look.places;
    look.off_mm = off_mm / look.places;
  }
  return look;
}

std::string trend_words(const QualityStudy& of) {
  if (!of.trend) return "A trend needs three shoes.";
  const double per_hundred = 100 * of.trend->slope, u95 = 100 * of.trend->slope_u95;
  if (!of.crossing)
    return FixedText<200>::format("No trend that is more than chance: %+.3f +- %.3f mm in 100 shoes (95 %%).",
                                  per_hundred, u95)
        .c_str();
  const double last = of.points.back().x;
  const auto left = [last](double x) { return std::max(0.0, std::floor(x - last)); };
  return FixedText<300>::format(
             "It goes by %+.3f +- %.3f mm in 100 shoes (95 %%). The mean reaches %.3f mm in about %.0f more "
             "shoes, "
             "not before %.0f and not after %.0f (95 %%).",
             per_hundred, u95, of.crossing->limit, left(of.crossing->likely), left(of.crossing->earliest),
             left(of.crossing->latest))
      .c_str();
}

std::string trend_picture(const QualityStudy& of) {
  const Plot plot{of};
  const double last = of.points.back().x;
  std::string svg =
      FixedText<240>::format(
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
          "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
          "fill=\"#fff\"/>\n",
          Plot::k_width_px, Plot::k_height_px)
          .c_str();
  for (const double limit : {of.limits.low, of.limits.high}) {
    svg += plot.line({.x = 1, .value = limit}, {.x = last, .value = limit}, "stroke=\"#c00\"");
    svg += plot.text({.x = 1, .value = limit}, number("%.2f mm", limit));
  }
  if (of.trend)
    svg += plot.line(
        {.x = 1, .value = of.trend->at(1)}, {.x = last, .value = of.trend->at(last)},
        of.trend->sure() ? "stroke=\"#268\" stroke-width=\"2\"" : "stroke=\"#268\" stroke-dasharray=\"4 4\"");
  for (const study::TrendPoint& point : of.points) svg += plot.dot(point);
  return svg + "</svg>\n";
}

Result<void> write_quality_page(const std::vector<QualityStudy>& studies, int left_out,
                                const std::filesystem::path& folder) {
  double least = studies.front().performance.ppk;
  for (const QualityStudy& of : studies) least = std::min(least, of.performance.ppk);
  report::Page page{"Quality of the work", number("Ppk %.2f", least), judged(least).mood};
  page.paragraph(std::string("The smaller Ppk ") + judged(least).words + ".");
  if (left_out > 0) page.paragraph(std::to_string(left_out) + " looks tell no band, and are left out.");
  for (const QualityStudy& of : studies) {
    page.heading(of.title);
    page.figures({{"shoes", std::to_string(of.performance.count)},
                  {"limits", number("%.2f", of.limits.low) + " to " + number("%.2f mm", of.limits.high)},
                  {"mean", report::value_text(of.performance.mean, "mm")},
                  {"standard deviation", report::value_text(of.performance.deviation, "mm")},
                  {"beyond a limit", std::to_string(of.performance.outside)},
                  {"Pp", number("%.2f", of.performance.pp)},
                  {"Ppk", number("%.2f", of.performance.ppk)},
                  {"Ppk, with 95 % not below", number("%.2f", of.performance.ppk_low)}});
    page.paragraph(trend_words(of));
  }
  page.picture("width.svg", "Width, shoe after shoe, with its limits and its trend");
  page.picture("place.svg", "Middle of the band above its plan, likewise");
  page.paragraph(
      "Pp and Ppk tell shares of bad shoes only where the values are near to normal. Each value is a mean "
      "along the "
      "line: a narrow stretch is a fault of its look.");
  page.link("shoes.csv", "The shoes");
  page.link("report.json", "All numbers");
  return page.write(folder / "index.html");
}

Result<void> write_gage_page(const study::GageStudy& study, const std::string& input,
                             const std::filesystem::path& folder) {
  using Mood = report::Page::Mood;
  // AIAG, Measurement Systems Analysis, 4th edition, chapter II D.
  const double percent = study.grr_percent();
  const Mood mood = percent < 10 ? Mood::Good : percent <= 30 ? Mood::Look : Mood::Refused;
  const char* const words = percent < 10    ? "The measurement is fit for it (below 10 %)."
                            : percent <= 30 ? "The measurement may do for some uses (10 to 30 %)."
                                            : "The measurement does not do (above 30 %).";
  report::Page page{"Gage study of " + input, number("GRR %.1f %%", percent), mood};
  page.paragraph(words);
  page.paragraph(std::to_string(study.parts) + " parts, " + std::to_string(study.persons) + " persons, " +
                 std::to_string(study.trials) + " trials each, by analysis of variance.");
  page.heading("What the spread is made of");
  const auto row = [&](const char* what, double deviation) -> std::vector<std::string> {
    return {what, number("%.4g", deviation), number("%.1f", study.tv > 0 ? 100 * deviation / study.tv : 0)};
  };
  page.table({"from", "standard deviation", "% of all"},
             {row("repeats (EV)", study.ev), row("persons (AV)", study.av),
              row("persons and parts together", study.interaction), row("the measurement (GRR)", study.grr),
              row("parts (PV)", study.pv), row("all (TV)", study.tv)});
  page.heading("Analysis of variance");
  const auto source = [](const char* what, const study::Source& of) -> std::vector<std::string> {
    return {what, std::to_string(of.freedom), number("%.5g", of.squares), number("%.5g", of.mean_square())};
  };
  page.table({"source", "degrees of freedom", "sum of squares", "mean square"},
             {source("parts", study.of_parts), source("persons", study.of_persons),
              source("both together", study.of_both), source("repeats", study.of_repeats)});
  page.figures({{"chance of as much of both together", number("%.3f", study.interaction_probability)},
                {"kept", study.interaction_kept ? "yes" : "no: taken as repeats"},
                {"categories that can be told apart", std::to_string(study.ndc)}});
  page.link("report.json", "All numbers");
  return page.write(folder / "index.html");
}

}  // namespace biteline::app
