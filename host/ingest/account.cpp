// SPDX-License-Identifier: MIT
#include "host/ingest/account.hpp"

namespace biteline::ingest {

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
    account["sensor_stages_ms"][stage.name] = {{"min", k_ms_per_ns * static_cast<double>(stage.min.count())},
                                               {"mean", k_ms_per_ns * static_cast<double>(stage.mean.count())},
                                               {"max", k_ms_per_ns * static_cast<double>(stage.max.count())}};
  }
  return account;
}

}  // namespace biteline::ingest
