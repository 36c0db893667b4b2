// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/arm_memory.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/core/fixed_text.hpp"

namespace biteline::service {
namespace {

constexpr const char* k_arm_setting = "arm_give";
constexpr std::size_t k_least_scans = 3;
constexpr std::size_t k_most_scans = 20;
constexpr double k_share_below = 0.9;

/// Oldest first.  A text that is none is nothing: the next scans write it anew.
Result<std::vector<double>> remembered_gives(const memory::Memory& memory) {
  BITELINE_ASSIGN(const std::optional<std::string> kept, memory.setting(k_arm_setting));
  std::vector<double> gives;
  if (!kept) return gives;
  const nlohmann::json json = nlohmann::json::parse(*kept, nullptr, false);
  if (!json.is_array()) return gives;
  for (const nlohmann::json& give : json) {
    if (give.is_number()) gives.push_back(give.get<double>());
  }
  return gives;
}

}  // namespace

Result<std::optional<uncertainty::ArmGive>> remembered_arm(const memory::Memory& memory) {
  BITELINE_ASSIGN(std::vector<double> gives, remembered_gives(memory));
  if (gives.size() < k_least_scans) return std::optional<uncertainty::ArmGive>{};
  std::ranges::sort(gives);
  const auto at = std::lround(std::ceil(k_share_below * static_cast<double>(gives.size() - 1)));
  return std::optional{uncertainty::ArmGive{.mm_per_m_s2 = gives.at(static_cast<std::size_t>(at)),
                                            .source = uncertainty::ArmSource::EarlierScans}};
}

Result<void> remember_arm(const std::string& name, const std::optional<uncertainty::ArmMotion>& arm,
                          memory::Memory& memory) {
  if (!arm || arm->source != uncertainty::ArmSource::Table || !(arm->give_mm_per_m_s2 > 0)) return {};
  BITELINE_ASSIGN(std::vector<double> gives, remembered_gives(memory));
  gives.push_back(arm->give_mm_per_m_s2);
  if (gives.size() > k_most_scans) gives.erase(gives.begin());
  return memory.put_setting(
      k_arm_setting, nlohmann::json(gives).dump(),
      {.id = 0,
       .time = memory::now_ms(),
       .who = "service",
       .door = {},
       .action = "arm's give",
       .subject = name,
       .before = {},
       .after = std::string{FixedText<48>::format("%.4f mm per m/s^2", arm->give_mm_per_m_s2).view()}});
}

}  // namespace biteline::service
