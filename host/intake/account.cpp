// SPDX-License-Identifier: MIT
#include "host/intake/account.hpp"

namespace biteline::intake {

nlohmann::ordered_json account_of(const IngestCounts& counts, const wire::Counters& sensor,
                                  const std::vector<wire::StageTime>& sensor_stages) {
  nlohmann::ordered_json account{{"frames", sensor.frames},
                                 {"frames_lost", sensor.frames_lost},
                                 {"frames_damaged", sensor.frames_damaged},
                                 {"poses", sensor.poses},
                                 {"poses_lost", sensor.poses_lost},
                                 {"poses_rejected", sensor.poses_rejected},
                                 {"profiles_made", sensor.profiles},
                                 {"profiles_dropped_in_sensor", sensor.profiles_dropped},
                                 {"profiles", counts.profiles},
                                 {"profiles_used", counts.profiles_used},
                                 {"profiles_lost", counts.profiles_lost},
                                 {"overruns", sensor.overruns},
                                 {"points_received", counts.points},
                                 {"points_used", counts.points_used},
                                 {"points_not_surface", counts.points_not_surface},
                                 {"points_of_unusable_profiles", counts.points_of_unusable_profiles}};
  for (const auto& [name, count] : profile_flag_counts(counts)) account["profile_flags"][name] = count;
  for (const auto& [name, count] : point_flag_counts(counts)) account["point_flags"][name] = count;
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
  nlohmann::ordered_json account{{"realtime", devices.realtime},
                                 {"camera_underruns", devices.camera_underruns},
                                 {"packets_resent", devices.packets_resent},
                                 {"pose_reconnects", devices.pose_reconnects},
                                 {"poses_unlatched", devices.poses_unlatched},
                                 {"bus_errors", devices.bus_errors},
                                 {"bus_restarts", devices.bus_restarts},
                                 {"watchdog_feeds_failed", devices.watchdog_feeds_failed}};
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
    account["trigger"] = {{"timed_by", devices.trigger_by_software ? "software" : "hardware"},
                          {"edges", trigger->edges},
                          {"edges_missed", trigger->edges_missed},
                          {"edges_doubled", trigger->edges_doubled},
                          {"edges_late", trigger->edges_late},
                          {"edges_lost", trigger->edges_lost},
                          {"frames_paired", trigger->frames_paired},
                          {"frames_without_edge", trigger->frames_without_edge},
                          {"frames_with_two_edges", trigger->frames_with_two_edges},
                          {"edges_without_frame", trigger->edges_without_frame}};
  }
  return account;
}

}  // namespace biteline::intake
