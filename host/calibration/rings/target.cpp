// SPDX-License-Identifier: MIT
#include "host/calibration/rings/target.hpp"

#include <algorithm>
#include <cstdio>

#include "common/config/yaml_reader.hpp"

namespace biteline::calibration {

namespace {

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

}  // namespace

Result<RingTarget> read_target(const std::filesystem::path& file) {
  BITELINE_ASSIGN(auto reader, config::YamlReader::open(file));
  RingTarget target;
  target.rows = static_cast<int>(reader.integer("rows", {.minimum = 2, .maximum = 100}));
  target.cols = static_cast<int>(reader.integer("cols", {.minimum = 2, .maximum = 100}));
  // Wide on purpose: metres given for millimetres are found out by the motions, which can say so.
  target.pitch_mm = reader.number("pitch", {.minimum = 1e-4, .maximum = 1e5});
  target.outer_diameter_mm = reader.number("outer_diameter", {.minimum = 1e-4, .maximum = 1e5});
  target.inner_diameter_mm = reader.number("inner_diameter", {.minimum = 1e-4, .maximum = 1e5});
  target.planes = static_cast<int>(reader.integer_or("planes", 1, {.minimum = 1, .maximum = 2}));
  if (target.outer_diameter_mm >= target.pitch_mm) {
    reader.fault(Errc::BadValue, "outer_diameter", "less than the pitch: rings must not touch");
  }
  if (target.inner_diameter_mm >= target.outer_diameter_mm) {
    reader.fault(Errc::BadValue, "inner_diameter", "less than outer_diameter");
  }
  BITELINE_TRY(reader.finish());
  return target;
}

std::string target_svg(const RingTarget& target) {
  constexpr double k_ruler_mm = 50;
  const double margin_mm = std::max(target.pitch_mm, target.outer_diameter_mm);
  const double width_mm = std::max((target.cols - 1) * target.pitch_mm, k_ruler_mm) + 2 * margin_mm;
  const double ruler_y_mm = (target.rows - 1) * target.pitch_mm + 2 * margin_mm;
  const double height_mm = ruler_y_mm + 12;
  std::string svg;
  append(svg,
         "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.3fmm\" height=\"%.3fmm\" viewBox=\"0 0 %.3f "
         "%.3f\">\n",
         width_mm, height_mm, width_mm, height_mm);
  append(svg, "<title>Ring target %d x %d, pitch %g mm, diameters %g and %g mm</title>\n", target.rows,
         target.cols, target.pitch_mm, target.outer_diameter_mm, target.inner_diameter_mm);
  append(svg,
         "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n<g fill=\"none\" stroke=\"black\" "
         "stroke-width=\"%.4f\">\n",
         (target.outer_diameter_mm - target.inner_diameter_mm) / 2);
  const double radius_mm = (target.outer_diameter_mm + target.inner_diameter_mm) / 4;
  for (int row = 0; row < target.rows; ++row) {
    for (int col = 0; col < target.cols; ++col) {
      append(svg, "<circle cx=\"%.4f\" cy=\"%.4f\" r=\"%.4f\"/>\n", margin_mm + col * target.pitch_mm,
             margin_mm + row * target.pitch_mm, radius_mm);
    }
  }
  svg += "</g>\n";
  append(svg,
         "<path d=\"M%.3f %.3f h%g m0 -2 v4 m-%g 0 v-4\" fill=\"none\" stroke=\"black\" "
         "stroke-width=\"0.2\"/>\n",
         margin_mm, ruler_y_mm, k_ruler_mm, k_ruler_mm);
  append(svg, "<text x=\"%.3f\" y=\"%.3f\" font-family=\"sans-serif\" font-size=\"3\">", margin_mm,
         ruler_y_mm + 6);
  append(svg, "must measure 50 mm; rows: %d, cols: %d, pitch: %g, ", target.rows, target.cols,
         target.pitch_mm);
  append(svg, "outer_diameter: %g, inner_diameter: %g</text>\n</svg>\n", target.outer_diameter_mm,
         target.inner_diameter_mm);
  return svg;
}

}  // namespace biteline::calibration
