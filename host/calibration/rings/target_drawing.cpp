// SPDX-License-Identifier: MIT
#include "host/calibration/rings/target_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace biteline::calibration {
namespace {

constexpr double k_ruler_mm = 50, k_tick_mm = 4, k_line_mm = 0.2;
constexpr double k_letter_mm = 3, k_row_mm = 4.5;
/// A row of the caption; Helvetica's letters are half as wide as high, and some more.
constexpr double k_caption_mm = 110;

template <class... Arguments>
void append(std::string& text, const char* pattern, Arguments... arguments) {
  char line[512];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
  std::snprintf(line, sizeof line, pattern, arguments...);
#pragma GCC diagnostic pop
  text += line;
}

void add_ruler(TargetSheet& sheet, double x_mm, double y_mm) {
  sheet.strokes.push_back({.x0_mm = x_mm, .y0_mm = y_mm, .x1_mm = x_mm + k_ruler_mm, .y1_mm = y_mm});
  for (const double end_mm : {x_mm, x_mm + k_ruler_mm}) {
    sheet.strokes.push_back(
        {.x0_mm = end_mm, .y0_mm = y_mm - k_tick_mm / 2, .x1_mm = end_mm, .y1_mm = y_mm + k_tick_mm / 2});
  }
}

/// Neighbouring squares touch at their corners only: no seam lies between two black ones.
void add_squares(TargetSheet& sheet, const RingTarget& target, const Vec2& corner_mm) {
  for (int row = 0; row <= target.rows; ++row) {
    for (int col = 0; col <= target.cols; ++col) {
      if (((row + col) % 2 != 0) != target.first_is_white) continue;
      sheet.squares.push_back(
          {.x_mm = corner_mm.x() + col * target.pitch_mm, .y_mm = corner_mm.y() + row * target.pitch_mm});
    }
  }
}

std::vector<std::string> caption(const RingTarget& target) {
  std::vector<std::string> rows;
  rows.emplace_back("Print at 100 %, no fitting to the page. The ruler must measure 50 mm.");
  std::string numbers;
  if (target.chessboard()) {
    append(numbers,
           "kind: chessboard, square_rows: %d, square_cols: %d, pitch: %g, first_square: %s, planes: %d",
           target.rows + 1, target.cols + 1, target.pitch_mm, target.first_is_white ? "white" : "black",
           target.planes);
    numbers += " [mm]";
  } else {
    append(numbers, "rows: %d, cols: %d, pitch: %g, outer_diameter: %g, inner_diameter: %g, planes: %d [mm]",
           target.rows, target.cols, target.pitch_mm, target.outer_diameter_mm, target.inner_diameter_mm,
           target.planes);
  }
  rows.push_back(std::move(numbers));
  rows.emplace_back(target.planes == 1
                        ? "Glue it flat, matt side up. These numbers are target.yaml's."
                        : "Cut at the dashed line; glue each half flat to one of two plates at 90 degrees.");
  return rows;
}

/// One number of PDF's: points, from the lower left corner.
constexpr double k_points_per_mm = 72 / 25.4;

void add_circle(std::string& content, double x_pt, double y_pt, double radius_pt) {
  constexpr int k_arcs = 8;
  const double arc_rad = 2 * std::numbers::pi / k_arcs;
  const double reach = 4.0 / 3.0 * std::tan(arc_rad / 4) * radius_pt;
  const auto at = [&](double angle_rad, double along) {
    return std::pair{x_pt + radius_pt * std::cos(angle_rad) - along * std::sin(angle_rad),
                     y_pt + radius_pt * std::sin(angle_rad) + along * std::cos(angle_rad)};
  };
  const auto start = at(0, 0);
  append(content, "%.6f %.6f m\n", start.first, start.second);
  for (int i = 0; i < k_arcs; ++i) {
    const auto out = at(i * arc_rad, reach), in = at((i + 1) * arc_rad, -reach),
               end = at((i + 1) * arc_rad, 0);
    append(content, "%.6f %.6f %.6f %.6f %.6f %.6f c\n", out.first, out.second, in.first, in.second,
           end.first, end.second);
  }
  content += "s\n";
}

std::string page_content(const TargetSheet& sheet) {
  const auto x = [](double mm) { return mm * k_points_per_mm; };
  const auto y = [&](double mm) { return (sheet.height_mm - mm) * k_points_per_mm; };
  std::string content;
  append(content, "0 G 0 g\n%.6f w\n", x(sheet.ring_stroke_mm));
  for (const TargetSheet::Ring& ring : sheet.rings)
    add_circle(content, x(ring.x_mm), y(ring.y_mm), x(sheet.ring_radius_mm));
  const double side_pt = x(sheet.square_mm);
  for (const TargetSheet::Square& square : sheet.squares)
    append(content, "%.6f %.6f %.6f %.6f re f\n", x(square.x_mm), y(square.y_mm) - side_pt, side_pt, side_pt);
  append(content, "%.6f w\n", x(k_line_mm));
  for (const TargetSheet::Stroke& stroke : sheet.strokes) {
    append(content, "%s 0 d\n%.6f %.6f m %.6f %.6f l S\n", stroke.dashed ? "[6 6]" : "[]", x(stroke.x0_mm),
           y(stroke.y0_mm), x(stroke.x1_mm), y(stroke.y1_mm));
  }
  for (const TargetSheet::Words& words : sheet.words) {
    append(content, "BT /F1 %.3f Tf %.3f %.3f Td (%s) Tj ET\n", x(k_letter_mm), x(words.x_mm), y(words.y_mm),
           words.text.c_str());
  }
  return content;
}

}  // namespace

TargetSheet target_sheet(const RingTarget& target) {
  // From the sheet's edge to the first mark: of a board a square, and half of one left white.
  const double margin_mm =
      target.chessboard() ? 1.5 * target.pitch_mm : std::max(target.pitch_mm, target.outer_diameter_mm);
  const double grid_mm = (target.cols - 1) * target.pitch_mm;
  const double apart_mm = grid_mm + 2 * margin_mm;  // a margin on either side of the cut
  TargetSheet sheet;
  sheet.ring_radius_mm = (target.outer_diameter_mm + target.inner_diameter_mm) / 4;
  sheet.ring_stroke_mm = (target.outer_diameter_mm - target.inner_diameter_mm) / 2;
  sheet.width_mm = std::max((target.planes - 1) * apart_mm + grid_mm, k_caption_mm) + 2 * margin_mm;
  sheet.square_mm = target.chessboard() ? target.pitch_mm : 0;
  for (int plane = 0; plane < target.planes; ++plane) {
    const double first_mm = margin_mm + plane * apart_mm;
    if (target.chessboard()) {
      add_squares(sheet, target, {first_mm - target.pitch_mm, margin_mm - target.pitch_mm});
      continue;
    }
    for (int row = 0; row < target.rows; ++row) {
      for (int col = 0; col < target.cols; ++col) {
        sheet.rings.push_back(
            {.x_mm = first_mm + col * target.pitch_mm, .y_mm = margin_mm + row * target.pitch_mm});
      }
    }
  }
  double y_mm = (target.rows - 1) * target.pitch_mm + 2 * margin_mm;
  if (target.planes == 2) {
    const double cut_mm = margin_mm + grid_mm + margin_mm;
    sheet.strokes.push_back(
        {.x0_mm = cut_mm, .y0_mm = 0, .x1_mm = cut_mm, .y1_mm = y_mm - margin_mm / 2, .dashed = true});
  }
  add_ruler(sheet, margin_mm, y_mm);
  y_mm += 2;
  for (std::string& row : caption(target))
    sheet.words.push_back({.x_mm = margin_mm, .y_mm = y_mm += k_row_mm, .text = std::move(row)});
  sheet.height_mm = y_mm + k_row_mm;
  return sheet;
}

std::string target_svg(const RingTarget& target) {
  const TargetSheet sheet = target_sheet(target);
  std::string svg;
  append(svg,
         "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.3fmm\" height=\"%.3fmm\" viewBox=\"0 0 %.3f "
         "%.3f\">\n",
         sheet.width_mm, sheet.height_mm, sheet.width_mm, sheet.height_mm);
  if (target.chessboard()) {
    append(svg, "<title>Chessboard of %d x %d squares of %g mm</title>\n", target.rows + 1, target.cols + 1,
           target.pitch_mm);
  } else {
    append(svg, "<title>Ring target %d x %d, pitch %g mm, diameters %g and %g mm</title>\n", target.rows,
           target.cols, target.pitch_mm, target.outer_diameter_mm, target.inner_diameter_mm);
  }
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<g fill=\"black\">\n";
  for (const TargetSheet::Square& square : sheet.squares)
    append(svg, "<rect x=\"%.4f\" y=\"%.4f\" width=\"%.4f\" height=\"%.4f\"/>\n", square.x_mm, square.y_mm,
           sheet.square_mm, sheet.square_mm);
  append(svg,
         "</g>\n<g fill=\"none\" stroke=\"black\" "
         "stroke-width=\"%.4f\">\n",
         sheet.ring_stroke_mm);
  for (const TargetSheet::Ring& ring : sheet.rings)
    append(svg, "<circle cx=\"%.4f\" cy=\"%.4f\" r=\"%.4f\"/>\n", ring.x_mm, ring.y_mm, sheet.ring_radius_mm);
  append(svg, "</g>\n<g stroke=\"black\" stroke-width=\"%g\">\n", k_line_mm);
  for (const TargetSheet::Stroke& stroke : sheet.strokes) {
    append(svg, "<line x1=\"%.3f\" y1=\"%.3f\" x2=\"%.3f\" y2=\"%.3f\"%s/>\n", stroke.x0_mm, stroke.y0_mm,
           stroke.x1_mm, stroke.y1_mm, stroke.dashed ? " stroke-dasharray=\"2 2\"" : "");
  }
  append(svg, "</g>\n<g font-family=\"Helvetica, Arial, sans-serif\" font-size=\"%g\">\n", k_letter_mm);
  for (const TargetSheet::Words& words : sheet.words)
    append(svg, "<text x=\"%.3f\" y=\"%.3f\">%s</text>\n", words.x_mm, words.y_mm, words.text.c_str());
  return svg + "</g>\n</svg>\n";
}

std::string target_pdf(const RingTarget& target) {
  const TargetSheet sheet = target_sheet(target);
  const std::string content = page_content(sheet);
  std::string page;
  append(page,
         "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 %.6f %.6f] /Contents 4 0 R "
         "/Resources << /Font << /F1 5 0 R >> >> >>",
         sheet.width_mm * k_points_per_mm, sheet.height_mm * k_points_per_mm);
  const std::vector<std::string> objects{
      // No reader shall fit it to the paper by itself.
      "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>", page,
      "<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content + "endstream",
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"};
  std::string pdf = "%PDF-1.4\n";
  std::string places;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    append(places, "%010zu 00000 n \n", pdf.size());
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::size_t table = pdf.size();
  const std::string count = std::to_string(objects.size() + 1);
  pdf += "xref\n0 " + count + "\n0000000000 65535 f \n" + places;
  pdf += "trailer\n<< /Size " + count + " /Root 1 0 R >>\nstartxref\n" + std::to_string(table) + "\n%%EOF\n";
  return pdf;
}

std::string target_text(const RingTarget& target) {
  char text[400];
  if (target.chessboard()) {
    std::snprintf(
        text, sizeof text,
        "# Squares are counted. Lengths in mm, as printed: measure the ruler, and correct pitch when it is "
        "not 50 mm.\n"
        "kind: chessboard\nsquare_rows: %d\nsquare_cols: %d\npitch: %.9g\nfirst_square: %s\nplanes: %d\n",
        target.rows + 1, target.cols + 1, target.pitch_mm, target.first_is_white ? "white" : "black",
        target.planes);
    return text;
  }
  std::snprintf(
      text, sizeof text,
      "# Lengths in mm, as printed: measure the ruler, and correct all three when it is not 50 mm.\n"
      "rows: %d\ncols: %d\npitch: %.9g\nouter_diameter: %.9g\ninner_diameter: %.9g\nplanes: %d\n",
      target.rows, target.cols, target.pitch_mm, target.outer_diameter_mm, target.inner_diameter_mm,
      target.planes);
  return text;
}

}  // namespace biteline::calibration
