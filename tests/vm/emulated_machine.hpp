// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/intake/child_process.hpp"

namespace biteline::test {

/// What ctest names for a test of the virtual machine; empty: not started by it.
[[nodiscard]] std::string environment(const char* name);

/// True, and said why, where this test cannot run: not started by ctest, or nothing was built for Arm.
[[nodiscard]] bool nothing_to_boot();

/// What one test needs of the machine beyond kernel, board and sensor program.
struct MachineNeeds {
  std::string modules{};                       ///< of the kernel, loaded at boot
  std::string devices{};                       ///< words for QEMU
  std::string guest{};                         ///< the command that runs inside, as boot.sh takes it
  std::string program{};                       ///< the guest's half of the test, in the Arm build
  std::vector<std::filesystem::path> files{};  ///< further ones for /test
};

/// The virtual machine of boot.sh, its sensor's port forwarded to one of this machine.  It boots in software
/// emulation, so each wait has patience.
class EmulatedMachine {
 public:
  static constexpr std::chrono::seconds k_boot_patience{180};

  /// Which of this machine's ports leads to the sensor.
  [[nodiscard]] int port() const { return port_; }

  void boot(const MachineNeeds& needs);
  /// Prints what the machine says, until a line holds `word`; false: it never said that, or it ended.
  [[nodiscard]] bool says(std::string_view word);
  /// After says() failed: boot.sh ended, and told what it lacks here.
  [[nodiscard]] bool cannot_run_here();
  [[nodiscard]] bool runs() { return process_->running(); }
  void tell_the_rest(std::chrono::milliseconds patience);
  /// Fails the test unless the machine ends by itself, and with 0.
  void ends_well(std::chrono::seconds patience);

 private:
  static int free_port();

  int port_{free_port()};
  std::optional<intake::ChildProcess> process_{};
};

}  // namespace biteline::test
