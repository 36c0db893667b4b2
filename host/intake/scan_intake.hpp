// SPDX-License-Identifier: MIT
#pragma once
/// \file One scan coming in: every message on disk before it is acknowledged, the cloud growing beside it.

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "common/core/result.hpp"
#include "host/cloud/uncertainty/scan_spread.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/completeness.hpp"
#include "host/intake/scan_gaps.hpp"
#include "host/intake/scan_journal.hpp"
#include "host/intake/sensor_link.hpp"

namespace biteline::intake {

/// Where the arm was when a profile was taken.
struct TakenFrom {
  std::uint32_t profile{0};  ///< its sequence number
  uncertainty::ProfilePose pose{};
};

/// What a scan has come to.
struct ScanOutcome {
  cloud::PointCloud cloud;
  std::vector<TakenFrom> poses;  ///< of the cloud's profiles, in the order of their numbers
  IngestCounts counts;
  wire::SensorHello sensor;
  wire::Counters sensor_counters;
  std::vector<wire::StageTime> sensor_stages;
  wire::Devices sensor_devices;
  std::uint64_t messages_lost{0};  ///< that the sensor could not keep for us
  LongestGap lost;                 ///< at the scan's worst place
  std::optional<Error> failure;  ///< why the scan did not end by itself, that its end never came, or that its
                                 ///< end says "complete" and the accounts contradict it
  std::string stopped_by{};      ///< who ended it on its way; empty: nobody
};

/// A scan's messages, in the scan's folder.
inline constexpr const char* k_messages_name = "scan.btln";

/// Lives in a folder, in a file of its own (scan.btln), from the sensor's hello to the scan's end.  Not
/// thread-safe.
class ScanIntake {
 public:
  /// `hello_packet`: the hello as it came, kept so that a successor of this process knows the head.
  [[nodiscard]] static Result<ScanIntake> begin(const std::filesystem::path& folder, const Hello& hello,
                                                std::span<const std::uint8_t> hello_packet);
  /// Of a process that died: as far as it came.
  [[nodiscard]] static Result<ScanIntake> recover(const std::filesystem::path& folder);

  /// True when `folder` holds a scan in the making.
  [[nodiscard]] static bool is_in(const std::filesystem::path& folder);

  /// On disk when this returns; acknowledge it then.
  [[nodiscard]] Result<void> take(const LinkEvent& event, std::span<const std::uint8_t> packet);

  [[nodiscard]] ScanPosition position() const { return position_; }
  [[nodiscard]] const wire::SensorHello& sensor() const { return sensor_; }
  [[nodiscard]] std::uint64_t scan_id() const { return position_.scan_id; }
  [[nodiscard]] bool ended() const { return ended_; }
  /// The sensor has said once more how its light is: a light that failed just before the end is known now.
  [[nodiscard]] bool light_told() const { return light_told_; }
  [[nodiscard]] const cloud::PointCloud& cloud() const { return builder_.cloud(); }  ///< as far as it came
  [[nodiscard]] std::span<const TakenFrom> poses() const { return poses_; }
  [[nodiscard]] std::uint64_t profiles() const { return builder_.counts().profiles; }
  [[nodiscard]] std::uint64_t profiles_expected() const { return sensor_.frames_expected; }

  /// The cloud so far; without the scan's end that is a failure.
  [[nodiscard]] ScanOutcome finish();
  /// Removes the file: the result is safe.
  void forget();

 private:
  ScanIntake(ScanJournal journal, wire::SensorHello sensor, ScanPosition position)
      : journal_{std::move(journal)},
        sensor_{std::move(sensor)},
        position_{position},
        builder_{sensor_.model},
        gaps_{sensor_.model.rate_hz.value_or(0)} {}
  void account(const wire::EndOfScan& end);

  ScanJournal journal_;
  wire::SensorHello sensor_;
  ScanPosition position_;
  CloudBuilder builder_;
  std::vector<TakenFrom> poses_;
  ScanGaps gaps_;
  LightAccount light_;
  bool light_told_{false};
  std::uint64_t messages_lost_{0};
  bool ended_{false};
  wire::EndOfScan end_;
};

}  // namespace biteline::intake
