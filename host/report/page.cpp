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

constexpr const char* k_style =
    "body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#f6f6f4;margin:0}"
    "main{max-width:72rem;margin:0 auto;padding:1.5rem}"
    "h1{margin:0 0 .5rem;font-size:1.6rem}h2{margin:2rem 0 .5rem;font-size:1.2rem;border-bottom:1px solid "
    "#ccc}"
    ".verdict{padding:.8rem 1rem;border-radius:.4rem;font-size:1.15rem;background:#e4e4e0}"
    ".good{background:#d8efd8}.refused{background:#f6dcd6}"
    "table{border-collapse:collapse}th{text-align:left;padding:.15rem 1.2rem .15rem 0}td{padding:.15rem "
    "1.2rem .15rem 0;vertical-align:top}td:last-child{font-variant-numeric:tabular-nums}"
    ".bar{display:inline-block;height:.7em;background:#5b8db8;margin-right:.5em}"
    "figure{margin:1rem 0;background:#fff;padding:.6rem;border:1px solid #ddd}figure "
    "img{max-width:100%;display:block}"
    "figcaption{color:#555;font-size:.9rem;margin-top:.3rem}iframe{width:100%;border:1px solid "
    "#ddd;background:#fff}";

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
  const char* mood_class = mood == Mood::Good ? " good" : mood == Mood::Refused ? " refused" : "";
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
  body_ += "<table>\n";
  for (const auto& [name, value] : rows)
    body_ += "<tr><td>" + escaped(name) + "</td><td>" + escaped(value) + "</td></tr>\n";
  body_ += "</table>\n";
}

void Page::table(const std::vector<std::string>& headings,
                 const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n<tr>";
  for (const std::string& heading : headings) body_ += "<th>" + escaped(heading) + "</th>";
  body_ += "</tr>\n";
  for (const std::vector<std::string>& row : rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) body_ += "<td>" + escaped(cell) + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

void Page::durations(const std::vector<std::pair<std::string, double>>& stages_s) {
  double longest_s = 1e-9;
  for (const auto& [name, seconds] : stages_s) longest_s = std::max(longest_s, seconds);
  body_ += "<table>\n";
  for (const auto& [name, seconds] : stages_s) {
    char width[32];
    std::snprintf(width, sizeof width, "%.1f", 20 * seconds / longest_s);
    body_ += "<tr><td>" + escaped(name) + "</td><td><span class=\"bar\" style=\"width:" + width +
             "rem\"></span>" + seconds_text(seconds) + "</td></tr>\n";
  }
  body_ += "</table>\n";
}

void Page::picture(const std::string& file, const std::string& caption) {
  body_ += "<figure><a href=\"" + escaped(file) + "\"><img src=\"" + escaped(file) + "\" alt=\"" +
           escaped(caption) + "\"></a><figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

void Page::link(const std::string& file, const std::string& text) {
  body_ += "<p><a href=\"" + escaped(file) + "\">" + escaped(text) + "</a></p>\n";
}

void Page::frame(const std::string& file, int height_px) {
  body_ += "<iframe src=\"" + escaped(file) + "\" height=\"" + std::to_string(height_px) + "\"></iframe>\n";
}

Result<void> Page::write(const std::filesystem::path& file) const {
  return write_file_atomically(
      file,
      "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>" +
          escaped(title_) + "</title><style>" + k_style + "</style></head>\n<body><main>\n" + body_ +
          "</main></body>\n</html>\n");
}

}  // namespace biteline::report
