// SPDX-License-Identifier: MIT
#pragma once
/// \file A program started by this one, which never outlives it.

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::intake {

/// The folder of the running program: its sisters are found there.
[[nodiscard]] std::filesystem::path program_folder();

/// Stopped (SIGTERM, then SIGKILL) when the object goes; killed by the kernel when the starting thread dies
/// first. Thread: one owner.
class ChildProcess {
 public:
  struct Config {
    std::filesystem::path program;
    std::vector<std::string> arguments;
    bool give_stdin{false};   ///< write_line() reaches it; else it has ours
    bool pass_stderr{false};  ///< also show the child's stderr on ours, line by line, behind its name
  };
  using Duration = std::chrono::milliseconds;

  /// Fails with the program and the reason when it cannot be started.
  [[nodiscard]] static Result<ChildProcess> start(const Config& config);

  ChildProcess(ChildProcess&&) noexcept;
  ChildProcess& operator=(ChildProcess&&) noexcept;
  ~ChildProcess();

  /// The next line of its stdout.  Errc::Timeout; Errc::ProcessDied with the last line of its stderr when
  /// stdout ended.
  [[nodiscard]] Result<std::string> next_line(Duration timeout);

  /// One line to its stdin.  Errc::ProcessDied when it no longer reads.  Pre: Config::give_stdin.
  [[nodiscard]] Result<void> write_line(const std::string& line);

  /// Waits for its end; the exit status, or 128 + the signal.  Errc::Timeout leaves it running.
  [[nodiscard]] Result<int> wait(Duration timeout);

  [[nodiscard]] bool running();

  /// SIGTERM, then SIGKILL after `grace`; the exit status as wait() gives it.  Harmless on an ended child.
  int stop(Duration grace = std::chrono::seconds{5});

  /// The last line it wrote to stderr, for a failure's one line.
  [[nodiscard]] std::string last_words() const;

  /// How many lines it wrote to stderr so far.
  [[nodiscard]] int stderr_lines() const;

  [[nodiscard]] int pid() const;

 private:
  struct State;
  explicit ChildProcess(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace biteline::intake
