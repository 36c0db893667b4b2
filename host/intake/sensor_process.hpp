// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor program as a child: started, asked where it listens, watched.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "host/intake/child_process.hpp"

namespace biteline::intake {

/// biteline-sensor beside the running program, or in bin/ beside its folder (tests).  Errc::FileNotFound.
[[nodiscard]] Result<std::filesystem::path> find_sensor_program();

/// Thread: start it from a thread that outlives it (host/intake).
class SensorProcess {
 public:
  /// Starts `program` and waits for the line that says where it listens.  A program that ends instead is an
  /// Error with its last words.
  [[nodiscard]] static Result<SensorProcess> start(const std::filesystem::path& program,
                                                   const std::vector<std::string>& arguments,
                                                   intake::ChildProcess::Duration timeout);

  [[nodiscard]] const wire::Endpoint& endpoint() const { return endpoint_; }
  [[nodiscard]] intake::ChildProcess& child() { return child_; }

  /// How it ended: the kind of failure that its exit status tells, with its last words.  Pre: it has ended.
  [[nodiscard]] Error death();

 private:
  explicit SensorProcess(intake::ChildProcess child) : child_{std::move(child)} {}

  intake::ChildProcess child_;
  wire::Endpoint endpoint_;
};

}  // namespace biteline::intake
