// SPDX-License-Identifier: MIT
#pragma once
/// \file What a sensor counts.  A count has one row here: backends fill it, the wire carries it, and reports
/// show it, all by the row.

#include <array>
#include <cstdint>

namespace biteline::profile {

template <class Counts>
struct CountRow {
  const char* name;  ///< in the table of common/wire/protocol.fbs
  std::uint64_t Counts::*value;
  std::uint16_t slot;       ///< the field's place in that table; fields are only ever added at its end
  const char* report_name;  ///< in report.json
};

struct ScanCounts {
  std::uint64_t frames{0};
  std::uint64_t frames_lost{0};
  std::uint64_t frames_damaged{0};
  std::uint64_t poses{0};
  std::uint64_t poses_lost{0};
  std::uint64_t poses_rejected{0};
  std::uint64_t profiles{0};
  std::uint64_t profiles_dropped{0};  ///< between pipeline and store
  std::uint64_t messages_lost{0};     ///< evicted from the store before any host had them
  std::uint64_t packets_rejected{0};
  std::uint64_t peers_refused{0};
  std::uint64_t overruns{0};
};
inline constexpr std::array<CountRow<ScanCounts>, 12> k_scan_counts{{
    {"frames", &ScanCounts::frames, 0, "frames"},
    {"frames_lost", &ScanCounts::frames_lost, 1, "frames_lost"},
    {"frames_damaged", &ScanCounts::frames_damaged, 2, "frames_damaged"},
    {"poses", &ScanCounts::poses, 3, "poses"},
    {"poses_lost", &ScanCounts::poses_lost, 4, "poses_lost"},
    {"poses_rejected", &ScanCounts::poses_rejected, 5, "poses_rejected"},
    {"profiles", &ScanCounts::profiles, 6, "profiles_made"},
    {"profiles_dropped", &ScanCounts::profiles_dropped, 7, "profiles_dropped_in_sensor"},
    {"messages_lost", &ScanCounts::messages_lost, 8, "messages_lost"},
    {"packets_rejected", &ScanCounts::packets_rejected, 9, "packets_rejected"},
    {"peers_refused", &ScanCounts::peers_refused, 10, "peers_refused"},
    {"overruns", &ScanCounts::overruns, 11, "overruns"},
}};

/// Frames against the edges of the camera's strobe echo.
struct TriggerCounts {
  std::uint64_t edges{0};          ///< slots of the train with an edge
  std::uint64_t edges_missed{0};   ///< slots without
  std::uint64_t edges_doubled{0};  ///< second edges in a slot
  std::uint64_t edges_late{0};     ///< off the train's grid
  std::uint64_t edges_lost{0};     ///< by the kernel or the wire, known by their number
  std::uint64_t frames_paired{0};
  std::uint64_t frames_without_edge{0};
  std::uint64_t frames_with_two_edges{0};
  std::uint64_t edges_without_frame{0};
};
inline constexpr std::array<CountRow<TriggerCounts>, 9> k_trigger_counts{{
    {"edges", &TriggerCounts::edges, 0, "edges"},
    {"edges_missed", &TriggerCounts::edges_missed, 1, "edges_missed"},
    {"edges_doubled", &TriggerCounts::edges_doubled, 2, "edges_doubled"},
    {"edges_late", &TriggerCounts::edges_late, 3, "edges_late"},
    {"edges_lost", &TriggerCounts::edges_lost, 4, "edges_lost"},
    {"frames_paired", &TriggerCounts::frames_paired, 5, "frames_paired"},
    {"frames_without_edge", &TriggerCounts::frames_without_edge, 6, "frames_without_edge"},
    {"frames_with_two_edges", &TriggerCounts::frames_with_two_edges, 7, "frames_with_two_edges"},
    {"edges_without_frame", &TriggerCounts::edges_without_frame, 8, "edges_without_frame"},
}};

/// Of camera, pose source and watchdogs, beyond the above.
struct DeviceCounts {
  std::uint64_t camera_underruns{0};  ///< no free buffer when a frame came
  std::uint64_t packets_resent{0};    ///< GigE Vision
  std::uint64_t pose_reconnects{0};
  std::uint64_t poses_unlatched{0};  ///< no SYNC seen: placed by their own stamps
  std::uint64_t bus_errors{0};
  std::uint64_t bus_restarts{0};
  std::uint64_t watchdog_feeds_failed{0};
};
inline constexpr std::array<CountRow<DeviceCounts>, 7> k_device_counts{{
    {"camera_underruns", &DeviceCounts::camera_underruns, 4, "camera_underruns"},
    {"packets_resent", &DeviceCounts::packets_resent, 5, "packets_resent"},
    {"pose_reconnects", &DeviceCounts::pose_reconnects, 9, "pose_reconnects"},
    {"poses_unlatched", &DeviceCounts::poses_unlatched, 10, "poses_unlatched"},
    {"bus_errors", &DeviceCounts::bus_errors, 11, "bus_errors"},
    {"bus_restarts", &DeviceCounts::bus_restarts, 12, "bus_restarts"},
    {"watchdog_feeds_failed", &DeviceCounts::watchdog_feeds_failed, 13, "watchdog_feeds_failed"},
}};

// A count without its row does not compile.
static_assert(sizeof(ScanCounts) == k_scan_counts.size() * sizeof(std::uint64_t));
static_assert(sizeof(TriggerCounts) == k_trigger_counts.size() * sizeof(std::uint64_t));
static_assert(sizeof(DeviceCounts) == k_device_counts.size() * sizeof(std::uint64_t));

}  // namespace biteline::profile
