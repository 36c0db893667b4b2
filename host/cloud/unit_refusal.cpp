// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "common/core/plain_number.hpp"
#include "host/cloud/cloud_file.hpp"

namespace biteline::cloud {
namespace {

/// A shoe is 85 to 360 mm long; half of one may be in view, and a boot stands higher than it is long.
constexpr double k_least_shoe_mm = 45, k_most_shoe_mm = 450;
/// A shoe on a table.
constexpr double k_most_scene_mm = 2000;
constexpr double k_usual_shoe_mm = 280;

}  // namespace

std::span<const report::RefusalRow<UnitRefused>> refusal_table(UnitRefused) {
  using Row = report::RefusalRow<UnitRefused>;
  static constexpr std::array k_rows{
      Row{UnitRefused::OtherUnit, "other_unit", "say the cloud's unit: --unit mm, cm, m, um or in"}};
  return k_rows;
}

std::vector<Unit> units_of_a_shoe(double size_mm) {
  std::vector<std::pair<double, Unit>> fitting;
  for (const UnitRow& row : unit_rows()) {
    const double size = size_mm * row.mm;
    if (!(size >= 2 * k_least_shoe_mm && size <= k_most_scene_mm)) continue;
    const double far = std::abs(std::log(size / k_usual_shoe_mm));
    // A shoe alone before any scene.
    fitting.emplace_back(size <= k_most_shoe_mm ? far : far + 10, row.unit);
  }
  std::ranges::sort(fitting);
  std::vector<Unit> units;
  for (const auto& [far, unit] : fitting) units.push_back(unit);
  return units;
}

std::optional<report::Refusal<UnitRefused>> unit_refusal(const CloudFile& file) {
  const double size = file.size_mm;
  if (file.unit || (size >= k_least_shoe_mm && size <= k_most_scene_mm)) return std::nullopt;
  const std::vector<Unit> units = units_of_a_shoe(size);
  // What no unit makes a shoe is judged as it is.
  if (units.empty()) return std::nullopt;
  const UnitRow& row = unit_row(units.front());
  std::string reason(
      FixedText<200>::format("the cloud is %s mm long, %s; in %s it would be %.0f mm: give --unit %s",
                             plain_number(size).c_str(),
                             size < k_least_shoe_mm ? "too small for a shoe" : "no shoe's size", row.word,
                             size * row.mm, row.name)
          .view());
  for (std::size_t i = 1; i < units.size(); ++i) {
    const UnitRow& other = unit_row(units[i]);
    reason += FixedText<80>::format(" (or --unit %s: %.0f mm)", other.name, size * other.mm).view();
  }
  return report::Refusal<UnitRefused>{.code = UnitRefused::OtherUnit, .reason = std::move(reason)};
}

}  // namespace biteline::cloud
