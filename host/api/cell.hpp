// SPDX-License-Identifier: MIT
#pragma once
/// \file What the API asks of the running service.

#include <string>

#include "host/control/messages.hpp"

namespace biteline::api {

using control::Json;

/// A person's word on one scan.
struct Decision {
  enum class Kind { Accept, Reject, Hold, Send };
  Kind kind{Kind::Hold};
  std::string scan;
  std::string who;
  std::string why;
};

/// What the next scan is worked with, until another is chosen.  Empty: as recognised.
struct Job {
  std::string model;
  std::string process;  ///< name of a process; empty: the model's own
};

/// Thread: each method from any thread; none waits for scan or arm.
class Cell {
 public:
  Cell() = default;
  Cell(const Cell&) = delete;
  Cell& operator=(const Cell&) = delete;
  virtual ~Cell() = default;

  /// `State` of the API without `control` and `seq`.
  [[nodiscard]] virtual Json state() = 0;
  /// Lists of `Robot` and `Sensor`.
  [[nodiscard]] virtual Json robots() = 0;
  [[nodiscard]] virtual Json sensors() = 0;

  /// Arm and scan end, no new scan begins until somebody starts.
  virtual void stop(const std::string& who) = 0;
  /// As stop(), and the sensor turns its light off.
  virtual void laser_off(const std::string& who) = 0;

  /// Errc::WrongState says why not now.
  [[nodiscard]] virtual Result<void> start(const Job& job, const std::string& who) = 0;
  [[nodiscard]] virtual Result<void> rescan(const std::string& who, const std::string& why) = 0;
  [[nodiscard]] virtual Result<void> decide(const Decision& decision) = 0;
};

}  // namespace biteline::api
