// SPDX-License-Identifier: MIT
#pragma once
/// \file What a UR controller says about itself on its dashboard.

#include <optional>
#include <string>

#include "host/robot/link/ur/dashboard.hpp"

namespace biteline::robot::ur {

/// Universal Robots, "Dashboard Server e-Series" and "CB3".  What a controller's version does not know is
/// nothing, and so is an answer of another form.
struct ControllerWords {
  std::optional<std::string> version;  ///< "URSoftware 5.12.0.0 ..."
  std::optional<std::string> model;    ///< "UR5", also of a UR5e
  std::optional<std::string> serial;
  std::optional<bool> remote;
  std::optional<std::string> robot_mode;     ///< "RUNNING"
  std::optional<std::string> program_state;  ///< "STOPPED <unnamed>"
};

/// One connection, six questions.  An Error when nobody answers.
[[nodiscard]] Result<ControllerWords> ask_controller(const Endpoint& dashboard, Nanoseconds patience);

/// Why paths cannot be sent to a controller of this software; nothing when they can.
[[nodiscard]] std::optional<std::string> unsupported(const ControllerWords& words);

/// One line for the operator.
[[nodiscard]] std::string summary(const ControllerWords& words);

}  // namespace biteline::robot::ur
