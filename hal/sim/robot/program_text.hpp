// SPDX-License-Identifier: MIT
#pragma once
/// \file What comes in at a script port: whole programs out of its bytes, plain ones or with control flow,
/// and the controller's own words.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/core/result.hpp"
#include "hal/sim/robot/script.hpp"

namespace biteline::sim {

/// The first whole program in `bytes`, which is taken from there: up to an `end` at the begin of a line. Bare
/// lines: one each.
[[nodiscard]] std::optional<std::string> take_program(std::vector<std::uint8_t>& bytes);

/// Plain steps, laid out in time as a whole; or code, whose rows are worked out as they are reached.
using ProgramText = std::variant<Script, ScriptCode>;

/// parse_script(), and programs whose main part has while, if, elif, else, halt, return, or expressions as
/// values.  Such a one has no threads here, and moves blend within a run of rows alone.
[[nodiscard]] Result<ProgramText> parse_program(std::string_view text);

/// As a real controller words it for its clients.
struct ProgramFault {
  int line{0}, column{1};
  std::string text;
};
/// `error`: of parse_program().
[[nodiscard]] ProgramFault fault_of(const Error& error, std::string_view program);

/// Words that are no program: "power on", "power off", "set robotmode run", "set unlock protective stop",
/// "stop program".
enum class PortOrder { None, PowerOn, PowerOff, ReleaseBrakes, Unlock, Stop };
[[nodiscard]] PortOrder port_order(std::string_view line);

}  // namespace biteline::sim
