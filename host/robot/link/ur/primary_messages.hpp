// SPDX-License-Identifier: MIT
#pragma once
/// \file What a controller sends to who connects to its primary or secondary interface.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::robot::ur {

/// A message, or a part of a robot state message: a length, a type, a body (Universal Robots, "Client
/// interfaces").
struct Part {
  std::uint8_t type;
  std::span<const std::uint8_t> body;
};

/// The first message or part of `bytes`, which is cut off there; nothing: it has not arrived whole.
/// Errc::BadFormat: these bytes are none of that interface.
[[nodiscard]] Result<std::optional<Part>> take_part(std::span<const std::uint8_t>& bytes);

/// What a robot message (type 20) says about programs.  Only the primary interface sends more of them than
/// the version.
struct ControllerSaid {
  enum class About : std::uint8_t {
    Started,       ///< key message: a program runs
    Ended,         ///< key message: it runs no more
    ProgramError,  ///< runtime exception: a program that does not compile, or that failed
    Fault,         ///< error code with the level of a violation or a fault
  };
  About about;
  std::string text;  ///< for a person; of a program's start and end its name
};

/// Of whole messages at the front of `heard`, which are taken from there; a piece of one stays.
/// Errc::BadFormat: these bytes are none of that interface.
[[nodiscard]] Result<std::vector<ControllerSaid>> take_said(std::vector<std::uint8_t>& heard);

}  // namespace biteline::robot::ur
