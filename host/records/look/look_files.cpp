// SPDX-License-Identifier: MIT
#include "host/records/look/look_files.hpp"

#include <algorithm>

#include "common/core/fixed_text.hpp"

namespace biteline::look {
namespace {

using second_look::Arc;
using second_look::BandEdge;
using second_look::BandPlace;
using second_look::Findings;

nlohmann::ordered_json point_json(const Vec3& point) {
  return {point.x(), point.y(), point.z()};
}

const char* state_of(const BandPlace& place) {
  if (!place.planned) return "left_out";
  if (place.unclear) return "unclear";
  return place.worked ? "worked" : "missing";
}

std::string edge_fields(const std::optional<BandEdge>& edge) {
  if (!edge) return ",,,,";
  return FixedText<120>::format("%.3f,%.3f,%.3f,%.3f,%.3f", edge->across_mm, edge->u95_mm, edge->base.x(),
                                edge->base.y(), edge->base.z())
      .c_str();
}

/// Along to the right, upwards up, in a scale of its own each.
class Drawing {
 public:
  Drawing(const Findings& findings, const second_look::PlannedBand& plan)
      : line_mm_{findings.line_mm},
        low_mm_{plan.low_mm - k_beside_mm},
        high_mm_{plan.high_mm + k_beside_mm} {}

  [[nodiscard]] std::string head() const {
    return FixedText<240>::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
               "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
               "fill=\"#fff\"/>\n",
               x_px(line_mm_) + k_margin_px, y_px(low_mm_) + k_margin_px)
        .c_str();
  }
  struct Across {
    double low_mm, high_mm;
  };
  /// Over the line's first point in two parts.
  [[nodiscard]] std::string box(const Arc& along, const Across& across, const char* style) const {
    if (along.to_mm < along.from_mm)
      return box({.from_mm = along.from_mm, .to_mm = line_mm_}, across, style) +
             box({.from_mm = 0, .to_mm = along.to_mm}, across, style);
    return FixedText<240>::format("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" %s/>\n",
                                  x_px(along.from_mm), y_px(across.high_mm),
                                  x_px(along.to_mm) - x_px(along.from_mm),
                                  y_px(across.low_mm) - y_px(across.high_mm), style)
        .c_str();
  }
  [[nodiscard]] std::string text(double along_mm, double across_mm, const char* words) const {
    return FixedText<240>::format("<text x=\"%.1f\" y=\"%.1f\">%s</text>\n", x_px(along_mm), y_px(across_mm),
                                  words)
        .c_str();
  }

  static constexpr double k_beside_mm = 6;

 private:
  static constexpr double k_margin_px = 20, k_along_px_per_mm = 2, k_across_px_per_mm = 8;
  [[nodiscard]] double x_px(double along_mm) const { return k_margin_px + k_along_px_per_mm * along_mm; }
  [[nodiscard]] double y_px(double across_mm) const {
    return k_margin_px + k_across_px_per_mm * (high_mm_ - across_mm);
  }
  double line_mm_, low_mm_, high_mm_;
};

}  // namespace

nlohmann::ordered_json as_json(const Findings& findings, const second_look::PlannedBand& plan) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::array(), unclear = nlohmann::ordered_json::array();
  for (const second_look::Fault& fault : findings.faults)
    faults.push_back({{"kind", second_look::name_of(fault.kind)},
                      {"from_mm", fault.along.from_mm},
                      {"to_mm", fault.along.to_mm},
                      {"within_from_mm", fault.within.from_mm},
                      {"within_to_mm", fault.within.to_mm},
                      {"low_mm", fault.low_mm},
                      {"high_mm", fault.high_mm},
                      {"middle_mm", point_json(fault.middle_base)}});
  for (const second_look::CannotTell& stretch : findings.cannot_tell)
    unclear.push_back({{"from_mm", stretch.along.from_mm},
                       {"to_mm", stretch.along.to_mm},
                       {"why", second_look::words_of(stretch.why)}});
  return {{"planned_low_mm", plan.low_mm},
          {"planned_high_mm", plan.high_mm},
          {"tolerance_mm", plan.tolerance_mm},
          {"line_mm", findings.line_mm},
          {"planned_mm", findings.planned_mm},
          {"worked_mm", findings.worked_mm},
          {"unclear_mm", findings.unclear_mm},
          {"contrast_ratio", findings.contrast_ratio},
          {"light_ratio", findings.light_ratio},
          {"moved", findings.moved.words},
          {"faults", faults},
          {"cannot_tell", unclear}};
}

std::string band_table(const Findings& findings) {
  std::string table =
      "#along [mm],state,low [mm],low_u95 [mm],low_x [mm],low_y [mm],low_z [mm],high [mm],high_u95 [mm],"
      "high_x [mm],high_y [mm],high_z [mm]\n";
  for (const BandPlace& place : findings.places)
    table += std::string{FixedText<60>::format("%.2f,%s,", place.along_mm, state_of(place)).view()} +
             edge_fields(place.low) + "," + edge_fields(place.high) + "\n";
  return table;
}

std::string band_picture(const Findings& findings, const second_look::PlannedBand& plan) {
  const Drawing drawing{findings, plan};
  std::string svg = drawing.head();
  svg += drawing.box({.from_mm = 0, .to_mm = findings.line_mm},
                     {.low_mm = plan.low_mm, .high_mm = plan.high_mm}, "fill=\"#eee\"");
  for (std::size_t i = 0; i < findings.places.size(); ++i) {
    const BandPlace& place = findings.places[i];
    if (!place.low || !place.high) continue;
    const double next_mm =
        i + 1 < findings.places.size() ? findings.places[i + 1].along_mm : findings.line_mm;
    svg += drawing.box({.from_mm = place.along_mm, .to_mm = next_mm},
                       {.low_mm = place.low->across_mm, .high_mm = place.high->across_mm}, "fill=\"#7b7\"");
  }
  for (const second_look::CannotTell& stretch : findings.cannot_tell)
    svg += drawing.box(stretch.along, {.low_mm = plan.low_mm, .high_mm = plan.high_mm}, "fill=\"#cc6\"");
  for (const second_look::Fault& fault : findings.faults) {
    svg += drawing.box(fault.along, {.low_mm = fault.low_mm, .high_mm = fault.high_mm},
                       "fill=\"none\" stroke=\"#c00\" stroke-width=\"2\"");
    svg += drawing.text(fault.along.from_mm, plan.high_mm + Drawing::k_beside_mm,
                        second_look::name_of(fault.kind));
  }
  return svg + "</svg>\n";
}

}  // namespace biteline::look
