// SPDX-License-Identifier: MIT
#pragma once
/// \file The messages of both directions, all but the data themselves (data.hpp).

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "common/rtde/package.hpp"

namespace biteline::rtde {

// Client to controller
// -------------------------------------------------------------------------------------------------
struct ProtocolVersionRequest {
  std::uint16_t version{2};  ///< what was asked for, known to us or not
};
struct ControllerVersionRequest {};
struct SetupOutputsRequest {
  double frequency_hz{0};  ///< version 2 only; 0: the controller's own rate
  std::vector<std::string> names;
};
struct SetupInputsRequest {
  std::vector<std::string> names;
};
struct StartRequest {};
struct PauseRequest {};

// Controller to client
// -------------------------------------------------------------------------------------------------
struct ProtocolVersionReply {
  bool accepted{false};
};
struct ControllerVersionReply {
  std::uint32_t major{0};
  std::uint32_t minor{0};
  std::uint32_t bugfix{0};
  std::uint32_t build{0};
};
/// One type name per variable asked for; "NOT_FOUND" and "IN_USE" stand for a variable that is not to be had.
struct SetupOutputsReply {
  std::uint8_t recipe_id{0};  ///< version 2 only
  std::vector<std::string> types;
};
struct SetupInputsReply {
  std::uint8_t recipe_id{0};  ///< 0: refused
  std::vector<std::string> types;
};
struct StartReply {
  bool accepted{false};
};
struct PauseReply {
  bool accepted{false};
};

// Both directions
// ------------------------------------------------------------------------------------------------------
enum class TextLevel : std::uint8_t { Exception = 0, Error = 1, Warning = 2, Info = 3 };
struct TextMessage {
  TextLevel level{TextLevel::Info};
  std::string text;
  std::string source;  ///< version 2 only
};

using ClientMessage = std::variant<ProtocolVersionRequest, ControllerVersionRequest, SetupOutputsRequest,
                                   SetupInputsRequest, StartRequest, PauseRequest, TextMessage>;
using ControllerMessage = std::variant<ProtocolVersionReply, ControllerVersionReply, SetupOutputsReply,
                                       SetupInputsReply, StartReply, PauseReply, TextMessage>;

/// Appends the message as one package.
void append(Bytes& out, const ClientMessage& message, ProtocolVersion version);
void append(Bytes& out, const ControllerMessage& message, ProtocolVersion version);

/// A package's body must be exactly as long as its kind demands.  Pre: not a data package.
[[nodiscard]] Result<ClientMessage> read_client_message(const Package& package, ProtocolVersion version);
[[nodiscard]] Result<ControllerMessage> read_controller_message(const Package& package,
                                                                ProtocolVersion version);

}  // namespace biteline::rtde
