// SPDX-License-Identifier: MIT
#include "host/records/force_book/tool_wear.hpp"

#include <algorithm>
#include <map>

#include "common/core/fixed_text.hpp"

namespace biteline::force_book {

ToolWear wear_of_tool(std::span<const Entry> entries, const std::string& tool, memory::UnixMs since) {
  struct Pressed {
    std::size_t series{0};
    double along_mm{0};
  };
  std::multimap<memory::UnixMs, Pressed> in_order;
  for (std::size_t i = 0; i < entries.size(); ++i)
    for (const ShoeForce& shoe : entries[i].shoes)
      if (shoe.tool == tool && shoe.time > since)
        in_order.emplace(shoe.time, Pressed{.series = i, .along_mm = shoe.along_mm});
  std::vector<std::vector<study::TrendPoint>> groups(entries.size());
  double number = 0;
  for (const auto& [time, pressed] : in_order)
    groups[pressed.series].push_back({.x = ++number, .value = pressed.along_mm});
  ToolWear wear{.shoes = static_cast<int>(in_order.size()), .trend = {}};
  if (Result<study::Trend> trend = study::trend_within(groups); trend) wear.trend = *trend;
  return wear;
}

nlohmann::ordered_json to_json(const ToolWear& wear) {
  nlohmann::ordered_json json{
      {"shoes", wear.shoes}, {"mm_per_shoe", nullptr}, {"u95_mm_per_shoe", nullptr}, {"sure", nullptr}};
  if (!wear.trend) return json;
  json["mm_per_shoe"] = wear.trend->slope;
  json["u95_mm_per_shoe"] = wear.trend->slope_u95;
  json["sure"] = wear.trend->sure();
  return json;
}

std::string words_of(const ToolWear& wear) {
  using Text = FixedText<200>;
  const std::string shoes = std::to_string(wear.shoes) + " shoes";
  if (!wear.trend) return shoes + ", too few to tell its wear";
  if (!wear.trend->sure()) return shoes + ", no wear to be seen";
  return shoes + Text::format(", the tip goes in by %.4f mm (U95 %.4f mm) more with each", wear.trend->slope,
                              wear.trend->slope_u95)
                     .c_str();
}

}  // namespace biteline::force_book
