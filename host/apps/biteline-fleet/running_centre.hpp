// SPDX-License-Identifier: MIT
#pragma once
/// \file The centre at work: from the broker into the database, until it is told to stop.

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/biteline-fleet/metrics_door.hpp"
#include "host/apps/biteline-fleet/options.hpp"
#include "host/apps/biteline-fleet/page_door.hpp"
#include "host/apps/biteline-fleet/recording_talk.hpp"
#include "host/apps/biteline-fleet/release_talk.hpp"
#include "host/fleet/broker.hpp"
#include "host/fleet/centre.hpp"
#include "host/fleet/intake.hpp"

namespace biteline::fleet {

/// Thread: the caller's; metrics and page have their own.
class RunningCentre {
 public:
  /// `options` outlive it.
  explicit RunningCentre(const FleetOptions& options)
      : options_{options}, recordings_{options.recordings, options.limits} {}

  [[nodiscard]] Result<void> open();
  void run();

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool open_centre();
  void wait();
  void forget();
  void say(const std::string& line);
  void hear(std::string_view topic, std::string_view text);
  /// Into the database, and only then the cells are told.
  [[nodiscard]] Result<void> keep();
  void tell(const std::string& cell, CommittedMessage committed);
  /// What is told of a database that went away stays as it was, but for `database_up`.
  void show_metrics();

  const FleetOptions& options_;
  std::unique_ptr<Broker> broker_;
  std::optional<Centre> centre_;
  Intake shoes_;
  std::map<std::string, HealthMessage> health_;  ///< each cell's last word
  ReleaseTalk releases_;
  RecordingTalk recordings_;
  std::unique_ptr<MetricsDoor> metrics_;
  std::unique_ptr<PageDoor> page_;
  FleetNews news_;
  Clock::time_point count_at_{}, judge_at_{};
  std::string last_;
};

}  // namespace biteline::fleet
