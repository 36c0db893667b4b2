// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor program before a cell that can be made to fail, and a host that keeps account.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/intake/sensor_link.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/support/picture_cell/picture_cell.hpp"
#include "tests/support/picture_cell/scan_account.hpp"
#include "tests/support/stalled_thread.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::test {

/// Real-time rights are used where there are any, as on a unit: the laser's guard means its 50 ms.  This
/// thread has them, too, as long as a stand lives: it stands for a host of its own.
class FaultStand {
 public:
  ~FaultStand();
  FaultStand(const FaultStand&) = delete;
  FaultStand& operator=(const FaultStand&) = delete;

  /// Nothing, noted as skipped: the camera's port is taken.
  /// `more`: of the sensor's command line.
  [[nodiscard]] static std::unique_ptr<FaultStand> set_up(const PictureCellConfig& config = {},
                                                          std::vector<std::string> more = {});

  PictureCell& cell() { return *cell_; }
  /// The sensor has real-time rights.
  [[nodiscard]] bool urgent() const { return urgent_; }
  intake::SensorProcess& sensor() { return *sensor_; }
  [[nodiscard]] const ScanAccount& account() const { return *account_; }

  /// As a host asks for one; until the laser shines and `profiles` have come.  The refusal, if it comes to
  /// that.
  [[nodiscard]] std::optional<std::string> start_scan(std::uint64_t profiles = 20);
  void command(wire::Command command);
  /// What the sensor says to a command; errc 403: nothing.
  [[nodiscard]] wire::ControlReply ask(wire::Command command);
  /// What the sensor says to a settings file; empty: it took it.
  [[nodiscard]] std::string send_settings(const std::string& text);
  /// Of the newest health and hello.
  [[nodiscard]] const wire::SettingsState& settings() const { return settings_; }
  [[nodiscard]] const wire::SensorHello& hello() const { return hello_; }
  [[nodiscard]] const std::optional<wire::UpkeepState>& upkeep() const { return upkeep_; }

  /// Takes in what comes until `done` says so; false: it never did, or not until the scan ended.
  bool take_until(const std::function<bool()>& done);
  bool take_profiles(std::uint64_t more);
  bool take_end() {
    return take_until([this] { return account_->end.has_value(); });
  }
  /// The next health message that was made after this call.
  bool take_health();

  /// Kills the sensor program and starts another one at once.  The host is a new one, too.
  void replace_sensor();

  void leave();      ///< the host is gone
  void come_back();  ///< knowing nothing

  /// Milliseconds from `begin` until the laser's line fell, less those in which the machine itself stood
  /// still; nothing: it shines.
  [[nodiscard]] std::optional<double> dark_after_ms(SensorClock::time_point begin);

 private:
  FaultStand() = default;
  void take(const intake::LinkEvent& event);
  void start_sensor();

  TemporaryFolder folder_;
  std::string board_file_, sensor_file_;
  std::unique_ptr<PictureCell> cell_;
  std::optional<intake::SensorProcess> sensor_;
  std::unique_ptr<intake::SensorLink> link_;
  std::optional<ScanAccount> account_;
  std::optional<wire::ControlReply> reply_;
  wire::SettingsState settings_;
  wire::SensorHello hello_;
  std::optional<wire::UpkeepState> upkeep_;
  std::vector<std::string> more_;
  bool urgent_{false};
  bool known_{false};  ///< the sensor has answered this host
  std::uint32_t command_id_{0};
};

}  // namespace biteline::test
