// SPDX-License-Identifier: MIT
#include "host/intake/account.hpp"

#include <algorithm>

namespace biteline::intake {
namespace {

template <class Counts, std::size_t N>
void add_counts(const Counts& counts, const std::array<profile::CountRow<Counts>, N>& rows,
                nlohmann::ordered_json& account) {
  for (const profile::CountRow<Counts>& row : rows) account[row.report_name] = counts.*row.value;
}

/// Half of the values are below the first, 95 % below the second.
nlohmann::ordered_json spread_of(std::vector<float> values) {
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {{"median", at(0.5)}, {"p95", at(0.95)}};
}

}  // namespace

nlohmann::ordered_json account_of(const IngestCounts& counts, const wire::Counters& sensor,
                                  const std::vector<wire::StageTime>& sensor_stages) {
  nlohmann::ordered_json account;
  add_counts(sensor, profile::k_scan_counts, account);
  account["duration_s"] = counts.duration_s;
  account["profiles"] = counts.profiles;
  account["profiles_used"] = counts.profiles_used;
  account["profiles_lost"] = counts.profiles_lost;
  account["points_received"] = counts.points;
  account["points_used"] = counts.points_used;
  account["points_not_surface"] = counts.points_not_surface;
  account["points_of_unusable_profiles"] = counts.points_of_unusable_profiles;
  for (const auto& [name, count] : profile_flag_counts(counts)) account["profile_flags"][name] = count;
  for (const auto& [name, count] : point_flag_counts(counts)) account["point_flags"][name] = count;
  if (!counts.speckle_contrasts.empty()) account["speckle_contrast"] = spread_of(counts.speckle_contrasts);
  for (const wire::StageTime& stage : sensor_stages) {
    constexpr double k_ms_per_ns = 1e-6;
    account["sensor_stages_ms"][stage.name] = {
        {"min", k_ms_per_ns * static_cast<double>(stage.min.count())},
        {"mean", k_ms_per_ns * static_cast<double>(stage.mean.count())},
        {"max", k_ms_per_ns * static_cast<double>(stage.max.count())}};
  }
  return account;
}

nlohmann::ordered_json account_of(const wire::Devices& devices) {
  nlohmann::ordered_json account{{"realtime", devices.realtime}};
  add_counts<profile::DeviceCounts>(devices, profile::k_device_counts, account);
  if (devices.capture) {
    constexpr double k_us_per_ns = 1e-3;
    account["capture"] = {
        {"exposure_us", k_us_per_ns * static_cast<double>(devices.capture->exposure.count())},
        {"exposure_changes", devices.capture->exposure_changes},
        {"first_row_px", devices.capture->first_row_px},
        {"rows_px", devices.capture->rows_px},
        {"row_changes", devices.capture->row_changes},
        {"rate_max_hz", devices.capture->rate_max_hz},
        {"searching", devices.capture->searching}};
  }
  if (devices.temperature_degc) account["temperature_degc"] = *devices.temperature_degc;
  for (const wire::ClockState& clock : devices.clocks) {
    if (!clock.known) {
      account["clocks"][clock.name] = nullptr;
      continue;
    }
    constexpr double k_us_per_ns = 1e-3;
    account["clocks"][clock.name] = {
        {"offset_ns", clock.offset.count()},
        {"uncertainty_us", k_us_per_ns * static_cast<double>(clock.uncertainty.count())},
        {"drift_ppm", clock.drift_ppm},
        {"steps", clock.steps}};
  }
  if (const std::optional<wire::TriggerState>& trigger = devices.trigger) {
    account["trigger"]["timed_by"] = devices.trigger_by_software ? "software" : "hardware";
    add_counts(*trigger, profile::k_trigger_counts, account["trigger"]);
  }
  return account;
}

}  // namespace biteline::intake
