// SPDX-License-Identifier: MIT
#include "host/records/batch/line_drawing.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/core/fixed_text.hpp"

namespace biteline::batch {
namespace {

constexpr double k_panel_px = 480, k_margin_px = 24, k_title_px = 28;

struct Extent {
  double least{std::numeric_limits<double>::max()}, most{std::numeric_limits<double>::lowest()};
  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  [[nodiscard]] double size() const { return most > least ? most - least : 1; }
};

struct Frame {
  Extent x, y, z;
  double px_per_mm{1};
};

Frame frame_of(const std::vector<DrawnPanel>& panels) {
  Frame frame;
  for (const DrawnPanel& panel : panels) {
    for (const DrawnLine& line : panel.lines) {
      for (const LinePlace& place : line.places) {
        frame.x.add(place.x_mm);
        frame.y.add(place.y_mm);
        frame.z.add(place.z_mm);
      }
    }
  }
  frame.px_per_mm = (k_panel_px - 2 * k_margin_px) / std::max(frame.x.size(), frame.y.size());
  return frame;
}

/// A stretch of equally marked points as one polyline.
void draw(std::string& svg, const DrawnLine& line, auto&& px_of) {
  const std::size_t count = line.places.size();
  const auto marked = [&](std::size_t i) { return !line.marked.empty() && line.marked[i % count]; };
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && marked(end) == marked(begin)) ++end;
    svg += std::string{"<polyline fill=\"none\" stroke=\""} +
           (marked(begin) ? "#c62828"
            : line.thin   ? "#1565c0"
                          : "#37474f") +
           "\" stroke-width=\"" +
           (marked(begin) ? "3"
            : line.thin   ? "1"
                          : "2") +
           "\" points=\"";
    // To the next stretch's first point, and from the last point to the first.
    for (std::size_t i = begin; i <= end; ++i) {
      const auto [x, y] = px_of(line.places[i % count]);
      svg += FixedText<48>::format("%.1f,%.1f ", x, y).view();
    }
    svg += "\"/>\n";
    begin = end;
  }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string{c};
  return out;
}

}  // namespace

std::string draw_lines(const std::vector<DrawnPanel>& panels) {
  const Frame frame = frame_of(panels);
  const double above_px = frame.y.size() * frame.px_per_mm + 2 * k_margin_px;
  const double side_px = frame.z.size() * frame.px_per_mm + 2 * k_margin_px;
  const double width_px = k_panel_px * static_cast<double>(panels.size());
  std::string svg = FixedText<240>::format(
                        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" "
                        "height=\"%.0f\" font-family=\"sans-serif\" font-size=\"15\">\n",
                        width_px, k_title_px + above_px + side_px)
                        .c_str();
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double left_px = k_panel_px * static_cast<double>(i);
    svg += FixedText<80>::format("<text x=\"%.0f\" y=\"20\">", left_px + k_margin_px).view();
    svg += escaped(panels[i].title) + "</text>\n";
    for (const DrawnLine& line : panels[i].lines) {
      const auto x_px = [&](const LinePlace& p) {
        return left_px + k_margin_px + (p.x_mm - frame.x.least) * frame.px_per_mm;
      };
      draw(svg, line, [&](const LinePlace& p) {
        return std::pair{x_px(p), k_title_px + k_margin_px + (frame.y.most - p.y_mm) * frame.px_per_mm};
      });
      draw(svg, line, [&](const LinePlace& p) {
        return std::pair{x_px(p),
                         k_title_px + above_px + k_margin_px + (frame.z.most - p.z_mm) * frame.px_per_mm};
      });
    }
  }
  return svg + "</svg>\n";
}

}  // namespace biteline::batch
