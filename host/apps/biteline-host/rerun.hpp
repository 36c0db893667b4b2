// SPDX-License-Identifier: MIT
#pragma once
/// \file Works kept scans out again with other settings, on a thread of its own that gives way to the cell.

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/apps/biteline-host/catalogue.hpp"
#include "host/interfaces/api/rerun.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/plan.hpp"

namespace biteline::service {

/// What a path is planned with.
struct RerunArm {
  kinematics::ArmModel model;
  path::Process process;  ///< where neither order nor model names one
  double table_z_mm{0};
  std::optional<path::Fixture> fixture{};
};

struct RerunRoom {
  std::filesystem::path results;
  CatalogueFolders catalogue;
  std::optional<RerunArm> arm;  ///< without: lines alone
  /// What was taught of the tool of that name; none: nothing is.
  std::function<Result<path::Mounted>(const std::string& tool)> mounted{};
};

/// The outcome in the order's folder of the scan: line.csv, report.json, view, path/.  Never gate.json, and
/// nothing is sent.  A refusal is an outcome; Errc tells of files that cannot be read or written.
[[nodiscard]] Result<void> work_again(const RerunRoom& room, const api::RerunOrder& order, int number);

/// A path with this process along the line of a kept scan, on one core; nothing is written.  Pre: an arm.
[[nodiscard]] Result<path::PlanOutcome> try_path(const RerunRoom& room, const std::string& scan,
                                                 const path::Process& process);

/// One order after the other, on one core and with the least priority.  Thread: each method from any.
class RerunWorker {
 public:
  /// `done` is called on the worker's thread with the scan's name.
  RerunWorker(RerunRoom room, std::function<void(const std::string&)> done);
  ~RerunWorker() { end(); }
  RerunWorker(const RerunWorker&) = delete;
  RerunWorker& operator=(const RerunWorker&) = delete;

  /// The number of the scan's folder that it will stand in.
  [[nodiscard]] Result<int> add(const api::RerunOrder& order);
  [[nodiscard]] const RerunRoom& room() const { return room_; }
  /// It waits or is worked on.
  [[nodiscard]] bool open(const std::string& scan, int number) const;
  /// Finishes what is worked on and leaves the rest.
  void end();

 private:
  struct Job {
    api::RerunOrder order;
    int number{0};
  };
  void run();

  RerunRoom room_;
  std::function<void(const std::string&)> done_;
  mutable std::mutex mutex_;
  std::condition_variable more_;
  std::deque<Job> jobs_;  ///< the first is worked on
  bool ended_{false};
  std::thread thread_;  ///< last: it uses the rest
};

}  // namespace biteline::service
