// SPDX-License-Identifier: MIT
#pragma once
/// \file The dashboard server of a CB3 or an e-Series controller: a line asked, a line answered.

#include <memory>
#include <string>
#include <utility>

#include "host/robot/link/ur/controller_door.hpp"

namespace biteline::robot::ur {

/// Universal Robots, "Dashboard Server e-Series" and "CB3": commands and answers are single lines; the server
/// greets with "Connected: ...".
class Dashboard final : public ControllerDoor {
 public:
  explicit Dashboard(Endpoint at) : at_{std::move(at)} {}
  [[nodiscard]] static Result<std::unique_ptr<ControllerDoor>> connect(const Endpoint& endpoint,
                                                                       Nanoseconds patience);

  [[nodiscard]] Result<ControllerWords> words(Nanoseconds patience) override;
  [[nodiscard]] Result<void> ask_remote() override;
  [[nodiscard]] Result<std::string> hear_remote(Nanoseconds patience) override { return hear(patience); }
  [[nodiscard]] Delivery stop_word() override { return {stream_, at_, "stop\n"}; }

 private:
  /// On its way when this returns; the answer is not waited for.
  [[nodiscard]] Result<void> say(const std::string& command);
  /// The next line that is no greeting, of printable characters, at most 200; Errc::Timeout.  Without
  /// patience: what has arrived already.
  [[nodiscard]] Result<std::string> hear(Nanoseconds patience);
  [[nodiscard]] Result<std::string> ask(const std::string& command, Nanoseconds patience);

  Endpoint at_;       ///< once it was found: by number
  TcpStream stream_;  ///< kept open for the word that stops the arm
  std::string heard_;
};

}  // namespace biteline::robot::ur
