// SPDX-License-Identifier: MIT
#pragma once
/// \file All that runs in a soak: the simulated cell in this process, sensor and host service as programs.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/live/live_cell.hpp"
#include "host/intake/child_process.hpp"
#include "tests/soak/controller_between.hpp"
#include "tests/soak/page.hpp"

namespace biteline::soak {

struct StandSettings {
  std::filesystem::path out;
  std::uint64_t seed{1};  ///< of shoe and place
  bool verbose{false};    ///< shows the programs' words
};

/// Memory that a process has in RAM, in MB; 0: it is gone.
[[nodiscard]] double resident_mb(int pid);

/// What the host service said on one line of its stdout.
struct HostWord {
  enum class Kind { Other, Asks, TakesIn, Found, Sends } kind{Kind::Other};
  std::string line;
  std::string scan;  ///< TakesIn and Found: the folder's name
};

/// Thread: one owner.
class Stand {
 public:
  /// Makes the shoe, opens the cell, starts the three programs.
  [[nodiscard]] static Result<std::unique_ptr<Stand>> open(const StandSettings& settings);

  [[nodiscard]] sim::LiveCell& cell() { return *cell_; }
  [[nodiscard]] ControllerBetween& between() { return *between_; }
  [[nodiscard]] intake::ChildProcess& sensor() { return *sensor_; }
  [[nodiscard]] intake::ChildProcess& host() { return *host_; }
  [[nodiscard]] Page& page() { return *page_; }
  [[nodiscard]] std::filesystem::path results() const { return settings_.out / "results"; }

  [[nodiscard]] Result<void> start_sensor();
  [[nodiscard]] Result<void> start_host();
  /// Starts what has ended; how many of the three that was.
  [[nodiscard]] Result<int> revive();

  /// Waits a little for the service's next line.
  [[nodiscard]] std::optional<HostWord> hear_host(std::chrono::milliseconds patience);
  /// What the service said while it ended.
  [[nodiscard]] std::vector<HostWord> last_host_words();

 private:
  explicit Stand(StandSettings settings) : settings_(std::move(settings)) {}
  Result<void> write_files() const;

  StandSettings settings_;
  std::unique_ptr<sim::LiveCell> cell_;
  std::unique_ptr<ControllerBetween> between_;
  std::string endpoint_{"tcp://127.0.0.1:0"};  ///< the sensor's, once it had one
  std::optional<intake::ChildProcess> sensor_, host_;
  std::string control_;  ///< the service's control end
  std::unique_ptr<Page> page_;
};

}  // namespace biteline::soak
