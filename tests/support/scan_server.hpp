// SPDX-License-Identifier: MIT
#pragma once
/// \file A sensor without devices: it speaks the protocol, and each StartScan brings a scan that was made.

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/stream/stream_socket.hpp"

namespace biteline::test {

struct ScanServer {
  wire::SensorHello identity;
  /// The profiles of scan 1, 2 and so on; stamped with now_of_sensor() and later.
  std::function<std::vector<profile::Profile>(std::uint64_t scan)> make;
  std::chrono::milliseconds between_profiles{10};
  std::string refuses{};              ///< why no scan begins; empty: each does
  std::uint64_t profiles_dropped{0};  ///< that each scan's end tells
};

[[nodiscard]] SensorClock::time_point now_of_sensor();

/// Prints its address, then "start N MS" for each scan that is asked for: its number, and when, in ms of
/// a steady clock.  Comes back only where it cannot open
/// its socket.
[[nodiscard]] Result<void> serve_scans(const ScanServer& server);

/// For main(): serves until its parent ends; the exit code where it cannot.
[[nodiscard]] int run_scan_server(const char* program, const std::function<Result<ScanServer>()>& make);

}  // namespace biteline::test
