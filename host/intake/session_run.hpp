// SPDX-License-Identifier: MIT
#pragma once
/// \file A recorded session through the sensor program: what runs on the arm, run on a folder.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/intake/cloud_builder.hpp"
#include "host/intake/host_protocol.hpp"

namespace biteline::intake {

struct SessionRunOptions {
  std::filesystem::path session;
  std::optional<std::filesystem::path>
      sensor_file;                          ///< replaces the head's calibration (biteline-sensor --sensor)
  std::vector<std::string> sensor_options;  ///< more of biteline-sensor's own, as {"--peak-mode", "fir"}
  std::optional<std::filesystem::path> program;  ///< biteline-sensor; default: beside the running program
  /// Told after every profile: how many came, how many are expected.
  std::function<void(std::size_t done, std::size_t total)> progress;
  OnProfile on_profile;
};

struct SessionRun {
  cloud::PointCloud cloud;  ///< base, scan order
  IngestCounts counts;
  LinkCounters link;
  wire::SensorHello sensor;        ///< model as used
  wire::Counters sensor_counters;  ///< the sensor's own account
  std::vector<wire::StageTime> sensor_stages;
  double start_s{0};   ///< until the sensor program answered
  double stream_s{0};  ///< from there to the scan's end
};

/// Starts biteline-sensor on the session, takes in its stream to the end, and stops it.  Nothing is dropped:
/// the sensor waits for this host.  Errors: the session's own (as session::read_session tells them), a
/// picture that cannot be read, the sensor program died (with its last words), or the two sides' counts do
/// not agree (ProtocolError): a cloud that silently lacks something is never returned. Call from a thread
/// that lives until it returns.
[[nodiscard]] Result<SessionRun> run_sensor_on_session(const SessionRunOptions& options);

}  // namespace biteline::intake
