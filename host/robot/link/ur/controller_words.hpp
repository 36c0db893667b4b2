// SPDX-License-Identifier: MIT
#pragma once
/// \file What a UR controller says about itself.

#include <optional>
#include <string>

namespace biteline::robot::ur {

/// Of a CB3, an e-Series and a PolyScope X.  What a controller's version does not know is nothing, and so is
/// an answer of another form.
struct ControllerWords {
  std::optional<std::string> version;  ///< "URSoftware 5.12.0.0 ...", "PolyScope X 10.12.1"
  std::optional<std::string> model;    ///< "UR5", also of a UR5e
  std::optional<std::string> serial;
  std::optional<bool> remote;
  std::optional<std::string> robot_mode;     ///< "RUNNING"
  std::optional<std::string> program_state;  ///< "STOPPED <unnamed>"; without a name on PolyScope X
  std::string odd;                           ///< the first answer that was none; empty: each was one
};

/// Letters and figures alone, as models and serial numbers have them.
[[nodiscard]] bool is_code(const std::string& text);

/// An answer that begins with a program's state.
[[nodiscard]] std::optional<std::string> program_state_of(const std::string& answer);

/// Why paths cannot be sent to a controller of this software; nothing when they can.
[[nodiscard]] std::optional<std::string> unsupported(const ControllerWords& words);

/// One line for the operator.
[[nodiscard]] std::string summary(const ControllerWords& words);

}  // namespace biteline::robot::ur
