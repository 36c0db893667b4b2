// SPDX-License-Identifier: MIT
#include "host/report/page.hpp"

#include <algorithm>
#include <cstdio>

#include "host/report/report.hpp"

namespace biteline::report {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

constexpr const char* k_style = R"(
:root{color-scheme:light dark;--text:#1d2126;--back:#f6f6f4;--card:#fff;--edge:#c4c8ce;--quiet:#4f5863;--link:#0b57a4;
--good:#d8efd8;--look:#ffe3a6;--refused:#f6d5ce;--plain:#e4e4e0;--bar:#5b8db8}
@media(prefers-color-scheme:dark){:root{--text:#e8eaed;--back:#14171a;--card:#1e2226;--edge:#454c54;--quiet:#b0b8c1;
--link:#8ec2ff;
--good:#1d4023;--look:#5a4300;--refused:#5c241b;--plain:#2a2f35;--bar:#6fa5d4}}
body{font:16px/1.5 system-ui,sans-serif;color:var(--text);background:var(--back);margin:0}
main{max-width:80rem;margin:0 auto;padding:1rem;overflow-wrap:anywhere}
a{color:var(--link)}h1{margin:0 0 .5rem;font-size:1.6rem}
h2{margin:2rem 0 .5rem;font-size:1.2rem;border-bottom:1px solid var(--edge)}
.verdict{padding:.8rem 1rem;border-radius:.4rem;font-size:1.15rem;background:var(--plain)}
.good{background:var(--good)}.look{background:var(--look)}.refused{background:var(--refused)}
.scroll{overflow-x:auto}table{border-collapse:collapse}
th,td{text-align:left;padding:.15rem 1.2rem .15rem 0;vertical-align:top}
td:last-child{font-variant-numeric:tabular-nums}
.bar{display:inline-block;max-width:50vw;height:.7em;background:var(--bar);margin-right:.5em}
figure{margin:1rem 0;background:var(--card);padding:.6rem;border:1px solid var(--edge)}
figure img{max-width:100%;display:block;background:#fff}figcaption{color:var(--quiet);font-size:.9rem;margin-top:.3rem}
iframe{width:100%;border:1px solid var(--edge);background:#fff}
)";

}  // namespace

std::string seconds_text(double seconds) {
  char text[32];
  if (seconds < 1) {
    std::snprintf(text, sizeof text, "%.1f ms", 1e3 * seconds);
  } else {
    std::snprintf(text, sizeof text, "%.2f s", seconds);
  }
  return text;
}

std::string value_text(double value, const std::string& unit) {
  char text[48];
  std::snprintf(text, sizeof text, "%.3f", value);
  return unit.empty() ? text : std::string(text) + " " + unit;
}

Page::Page(const std::string& title, const std::string& verdict, Mood mood) : title_{title} {
  const char* mood_class = mood == Mood::Good      ? " good"
                           : mood == Mood::Look    ? " look"
                           : mood == Mood::Refused ? " refused"
                                                   : "";
  body_ = "<h1>" + escaped(title) + "</h1>\n<p class=\"verdict" + mood_class + "\">" + escaped(verdict) +
          "</p>\n";
}

void Page::heading(const std::string& text) {
  body_ += "<h2>" + escaped(text) + "</h2>\n";
}

void Page::paragraph(const std::string& text) {
  body_ += "<p>" + escaped(text) + "</p>\n";
}

void Page::figures(const std::vector<std::pair<std::string, std::string>>& rows) {
  body_ += "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"figures\"><table>\n";
  for (const auto& [name, value] : rows)
    body_ += "<tr><th scope=\"row\">" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
  body_ += "</table></div>\n";
}

void Page::table(const std::vector<std::string>& headings,
                 const std::vector<std::vector<std::string>>& rows) {
  body_ += "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"table\"><table>\n<tr>";
  for (const std::string& heading : headings) {
    // An empty heading is no heading for a screen reader.
    body_ += heading.empty() ? "<td></td>" : "<th scope=\"col\">" + escaped(heading) + "</th>";
  }
  body_ += "</tr>\n";
  for (const std::vector<std::string>& row : rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) body_ += "<td>" + escaped(cell) + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void Page::durations(const std::vector<std::pair<std::string, double>>& stages_s) {
  double longest_s = 1e-9;
  for (const auto& [name, seconds] : stages_s) longest_s = std::max(longest_s, seconds);
  body_ += "<table>\n";
  for (const auto& [name, seconds] : stages_s) {
    char width[32];
    std::snprintf(width, sizeof width, "%.1f", 20 * seconds / longest_s);
    body_ += "<tr><th scope=\"row\">" + escaped(name) +
             "</th><td><span class=\"bar\" style=\"width:" + width + "rem\"></span>" + seconds_text(seconds) +
             "</td></tr>\n";
  }
  body_ += "</table>\n";
}

void Page::picture(const std::string& file, const std::string& caption) {
  body_ += "<figure><a href=\"" + escaped(file) + "\"><img src=\"" + escaped(file) +
           "\" alt=\"picture: " + escaped(caption) + "\"></a><figcaption>" + escaped(caption) +
           "</figcaption></figure>\n";
}

void Page::link(const std::string& file, const std::string& text) {
  body_ += "<p><a href=\"" + escaped(file) + "\">" + escaped(text) + "</a></p>\n";
}

void Page::frame(const std::string& file, int height_px) {
  body_ += "<iframe title=\"" + escaped(file) + "\" src=\"" + escaped(file) + "\" height=\"" +
           std::to_string(height_px) + "\"></iframe>\n";
}

void Page::place(const std::string& id, const std::string& otherwise) {
  body_ += "<div id=\"" + escaped(id) + "\">" +
           (otherwise.empty() ? "" : "<p>" + escaped(otherwise) + "</p>") + "</div>\n";
}

void Page::script(const std::string& file) {
  body_ += "<script defer src=\"" + escaped(file) + "\"></script>\n";
}

Result<void> Page::write(const std::filesystem::path& file) const {
  return write_file_atomically(
      file,
      "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><link rel=\"icon\" href=\"data:,\"><title>" +
          escaped(title_) + "</title><style>" + k_style + "</style></head>\n<body><main>\n" + body_ +
          "</main></body>\n</html>\n");
}

}  // namespace biteline::report
