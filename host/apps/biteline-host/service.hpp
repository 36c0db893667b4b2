// SPDX-License-Identifier: MIT
#pragma once
/// \file The service's life: scan after scan from the sensor to the arm.

#include <atomic>
#include <deque>
#include <future>
#include <memory>
#include <optional>

#include "common/core/result.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/apps/biteline-host/steps.hpp"
#include "host/intake/live_line.hpp"
#include "host/intake/scan_intake.hpp"
#include "host/report/file_lock.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::service {

/// Threads: the caller's owns the link and hears the sensor at least every 100 ms whatever else goes on; each
/// scan has one that works on its line (host/intake); a result is written, planned and followed on one more,
/// one scan at a time.  A scan whose working-out fails, by an exception or by the end of the process, is set
/// aside by name and the next one goes on.
class Service {
 public:
  /// Reads keys, process, arm and sample first: a fault there is told before anything moves.  Holds the
  /// folder of the results, and the arm when paths are to be sent, for as long as it lives: Errc::PeerRefused
  /// names who holds them.
  [[nodiscard]] static Result<Service> create(const Options& options);

  /// Until `stop`; with `once` until the first scan's result.  A link or a robot that fails is one plain line
  /// and, without `once`, tried again: a scan that was cut off goes on where it stood.
  [[nodiscard]] Result<ExitStatus> run(const std::atomic<bool>& stop);

 private:
  struct Robot {
    kinematics::ArmModel arm;
    path::Process process;
    RobotOptions options;
  };
  /// A scan and the folder it belongs to.
  struct Scan {
    std::filesystem::path folder;
    intake::ScanIntake intake;
    std::unique_ptr<intake::LiveLine> line;  ///< none where a sample's line is carried over
    bool recovered{false};                   ///< of a process that ended: nobody knows how old it is
    int connection{0};                       ///< that it began on
    bool one_connection{false};              ///< it ended on the same
    std::optional<HostClock::time_point> ended{};
  };
  /// What the service alone may use while it lives.
  struct Locks {
    report::FileLock results;
    std::optional<report::FileLock> arm;
  };

  Service(Options options, std::optional<wire::HostKeys> keys, std::optional<Robot> robot,
          std::optional<Carrier> carrier, Locks locks);

  /// What the sensor has to say; connects (and goes on with `scan_`, if there is one) where there is no link.
  [[nodiscard]] Result<void> hear_sensor();
  [[nodiscard]] Result<void> on_event(const intake::LinkEvent& event);
  [[nodiscard]] Result<void> on_hello(const intake::Hello& hello);
  /// Goes on with a scan as far as it has come.
  void hold_scan(const std::filesystem::path& folder, intake::ScanIntake intake);
  /// The scans that predecessors of this process did not finish.
  void find_unfinished();
  /// Takes up the next of them, or sets it aside when a predecessor died of it.
  [[nodiscard]] Result<void> take_up(const std::filesystem::path& folder);
  [[nodiscard]] std::filesystem::path next_folder() const;

  /// Begins to work out a scan that is complete, once the result before it is done.
  void start_result();
  /// The status of a result that has just been done.
  [[nodiscard]] std::optional<Result<ExitStatus>> result_done();
  /// Whatever the scan does to it: a result, or a report that says why there is none.
  [[nodiscard]] Result<ExitStatus> work_out(Scan scan) const;
  [[nodiscard]] Result<ExitStatus> work_out_line(Scan& scan, intake::ScanOutcome& outcome,
                                                 std::optional<cloud::ClosedLine>& line) const;
  [[nodiscard]] Result<ExitStatus> work_out_path(Scan& scan, const intake::ScanOutcome& outcome,
                                                 const cloud::ClosedLine& line) const;
  [[nodiscard]] robot::ScanFacts facts_of(const Scan& scan, const intake::ScanOutcome& outcome) const;
  /// Counts every connection to the sensor, also those that came back by themselves.
  [[nodiscard]] int connection() const;
  /// Its end is in, and the sensor has said how its light ended.
  [[nodiscard]] static bool ready(const Scan& scan);
  [[nodiscard]] bool confirmed(const std::filesystem::path& folder) const;

  Options options_;
  const std::atomic<bool>* stop_{nullptr};  ///< of run(): an arm that follows is stopped by it, too
  std::optional<wire::HostKeys> keys_;
  std::optional<Robot> robot_;
  std::optional<Carrier> carrier_;
  Locks locks_;
  std::deque<std::filesystem::path> unfinished_;  ///< folders, still to be taken up
  std::unique_ptr<intake::SensorLink> link_;
  std::optional<Scan> scan_;                ///< coming in
  int links_{0};                            ///< opened to the sensor so far
  bool sensor_idle_{false};                 ///< it waits to be asked for a scan
  std::future<Result<ExitStatus>> result_;  ///< being worked out; last: its thread uses the rest
};

}  // namespace biteline::service
