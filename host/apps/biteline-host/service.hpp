// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's life: scan after scan from the sensor to the arm.

#include <atomic>
#include <memory>
#include <optional>

#include "common/core/result.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/apps/biteline-host/steps.hpp"
#include "host/ingest/scan_intake.hpp"
#include "host/kinematics/arm_model.hpp"
#include "host/trajectory/process.hpp"

namespace biteline::service {

/// Everything on one thread: while a result is worked out the sensor keeps what it has for us.
class Service {
 public:
  /// Reads keys, process, arm and sample first: a fault there is told before anything moves.
  [[nodiscard]] static Result<Service> create(const Options& options);

  /// Until `stop`; with `once` until the first scan's result.  A link or a robot that fails is one plain line and, without
  /// `once`, tried again: a scan that was cut off goes on where it stood.
  [[nodiscard]] Result<ExitStatus> run(const std::atomic<bool>& stop);

 private:
  struct Robot {
    kinematics::ArmModel arm;
    trajectory::Process process;
    RobotOptions options;
  };
  /// A scan and the folder it belongs to.
  struct Scan {
    std::filesystem::path folder;
    ingest::ScanIntake intake;
  };

  Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot, std::optional<Carrier> carrier);

  /// Connects (goes on with `scan_` if there is one) and returns once it is complete.
  [[nodiscard]] Result<void> take_in_scan(const std::atomic<bool>& stop);
  [[nodiscard]] Result<void> on_event(const ingest::LinkEvent& event);
  [[nodiscard]] Result<void> on_hello(const ingest::Hello& hello);
  /// The scan that a predecessor of this process did not finish.
  [[nodiscard]] Result<void> find_unfinished();
  [[nodiscard]] std::filesystem::path next_folder() const;

  [[nodiscard]] Result<ExitStatus> work_out(Scan scan);

  Options options_;
  std::optional<wire::HostKeys> keys_;
  std::optional<Robot> robot_;
  std::optional<Carrier> carrier_;
  std::unique_ptr<ingest::SensorLink> link_;
  std::optional<Scan> scan_;
};

}  // namespace biteline::service
