// SPDX-License-Identifier: MIT
#pragma once
/// \file A sensor on the network, as one client sees it.

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "biteline/export.hpp"
#include "biteline/recording.hpp"

namespace biteline::sdk {

struct SensorOptions {
  std::string endpoint;              ///< "tcp://HOST:PORT"
  std::filesystem::path keys;        ///< folder of this host's keys; compulsory beyond this machine
  std::string name{"biteline-sdk"};  ///< told to the sensor
};

/// One owner thread.  The sensor keeps what was sent until it is acknowledged, which this class does.
class BITELINE_API SensorClient {
 public:
  /// Throws Error for an endpoint or keys that cannot be used; it connects in scan().
  explicit SensorClient(const SensorOptions& options);
  SensorClient(SensorClient&&) noexcept;
  SensorClient& operator=(SensorClient&&) noexcept;
  ~SensorClient();

  /// Asks for a scan, keeps its messages in `file` as they come, and returns at its end.  A scan that runs,
  /// or waits to be fetched, is taken in its place.  Throws Error where the sensor is not heard, ends the
  /// scan early, or `timeout` is over: then the sensor is told to stop, which turns its laser off.  `file`
  /// must not exist; after a failure it holds what came.
  [[nodiscard]] Recording scan(const std::filesystem::path& file, std::chrono::milliseconds timeout);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace biteline::sdk
