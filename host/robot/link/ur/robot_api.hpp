// SPDX-License-Identifier: MIT
#pragma once
/// \file The Robot API of a PolyScope X controller: questions and orders by HTTP.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "host/robot/link/ur/controller_door.hpp"
#include "host/robot/link/ur/http_question.hpp"

namespace biteline::robot::ur {

/// Universal Robots, "Robot API": program state from PolyScope X 10.11 on, robot mode and control mode from
/// 10.12, model and serial number from 10.14.  The version is told by the script's port.  What an older
/// software has not (404), what is refused (401, 403) and what is of another form is not known.
class RobotApi final : public ControllerDoor {
 public:
  explicit RobotApi(const DoorPlaces& places) : at_{places.robot_api}, script_{places.script} {}
  /// It is one when it tells its program's state.
  [[nodiscard]] static Result<std::unique_ptr<ControllerDoor>> open(const DoorPlaces& places,
                                                                    Nanoseconds patience);

  [[nodiscard]] Result<ControllerWords> words(Nanoseconds patience) override;
  [[nodiscard]] Result<void> ask_remote() override;
  [[nodiscard]] Result<std::string> hear_remote(Nanoseconds patience) override;
  /// By a fresh connection each time: a question that is not answered keeps no stop waiting.
  [[nodiscard]] Delivery stop_word() override;

 private:
  Endpoint at_;  ///< once it was found: by number
  Endpoint script_;
  std::optional<HttpQuestion> remote_;  ///< asked, and not answered yet
  std::chrono::steady_clock::time_point asked_{};
  TcpStream stop_;
};

/// The text that stands under `key` in an answer.  Errc::NotSupported: this software has not what was asked
/// for; Errc::PeerRefused: it does not say; Errc::BadFormat: an answer of another form.
[[nodiscard]] Result<std::string> text_in(const HttpAnswer& answer, const char* key);

}  // namespace biteline::robot::ur
