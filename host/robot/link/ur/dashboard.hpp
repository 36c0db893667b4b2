// SPDX-License-Identifier: MIT
#pragma once
/// \file The dashboard server of a UR controller: a line asked, a line answered.

#include <string>

#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

/// Universal Robots, "Dashboard Server e-Series": commands and answers are single lines; the server greets
/// with "Connected: ...".  Not thread-safe.
class Dashboard {
 public:
  Dashboard() = default;
  [[nodiscard]] static Result<Dashboard> connect(const Endpoint& endpoint, Nanoseconds patience);

  [[nodiscard]] bool is_open() const { return stream_.is_open(); }
  /// For a word that must not wait.
  [[nodiscard]] TcpStream& stream() { return stream_; }
  /// On its way when this returns; the answer is not waited for.
  [[nodiscard]] Result<void> say(const std::string& command);
  /// The next line that is no greeting, of printable characters, at most 200; Errc::Timeout.  Without
  /// patience: what has arrived already.
  [[nodiscard]] Result<std::string> hear(Nanoseconds patience);
  [[nodiscard]] Result<std::string> ask(const std::string& command, Nanoseconds patience);

 private:
  TcpStream stream_;
  std::string heard_;
};

}  // namespace biteline::robot::ur
