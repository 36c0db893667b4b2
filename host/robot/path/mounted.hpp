// SPDX-License-Identifier: MIT
#pragma once
/// \file What is mounted at a cell as it was taught, and whether a process is made for it.

#include <optional>
#include <string>
#include <vector>

#include "host/robot/path/checks/line_check.hpp"
#include "host/robot/path/process.hpp"

namespace biteline::path {

/// A place of a tool changer that the controller commands: one output asks for it, one input tells that it
/// stands.  Standard digital ones, 0 to 7.
struct ChangerLines {
  int ask_output{0};
  int there_input{0};
};
/// How a tool is wired to the controller.
struct ToolLines {
  std::optional<int> on_output{};         ///< switches it on; a process's `digital_output` is to be this one
  std::optional<ChangerLines> changer{};  ///< nothing: a person mounts it
};
/// A changer that can bring the tool that a process names, or tells that it stands.
struct Changer {
  ChangerLines wanted{};
  std::vector<ChangerLines> others{};  ///< its other places
  double reach_mm{0};                  ///< of the longest of its tools, from the flange to the tip
};

/// What was not taught is not checked.
struct Mounted {
  std::optional<std::string> tool{};  ///< its name, as a person said it; nothing: nobody has
  std::optional<Vec3> tip_flange{};   ///< mm
  double tip_u95_mm{0};               ///< of a tip that was touched
  std::optional<Payload> payload{};
  std::optional<ToolLines> lines{};
  /// Present where no person has to mount the named tool: both it and the mounted one are in the changer.
  std::optional<Changer> changer{};
  std::optional<double> table_z_mm{};  ///< in the robot's base
};

/// A taught tip is known to 0.5 mm and better, and files have whole millimetres: more is another tool, or a
/// bent one.
inline constexpr double k_taught_tip_mm = 1;
/// As good as a controller's own estimate of what it carries.
inline constexpr double k_taught_payload_kg = 0.1, k_taught_centre_mm = 20;

/// Of the process's tip from the taught one, mm; nothing: none was taught.
[[nodiscard]] std::optional<double> tip_off_mm(const Process& process, const Mounted& mounted);
/// The process carries what was taught; nothing: none was taught, or the process tells none.
[[nodiscard]] std::optional<bool> carries_as_taught(const Process& process, const Mounted& mounted);

/// The tool that the process names is mounted; nothing: it names none.
[[nodiscard]] std::optional<bool> has_its_tool(const Process& process, const Mounted& mounted);

/// The same, and no changer brings it: a person has to.
[[nodiscard]] bool waits_for_its_tool(const Process& process, const Mounted& mounted);

/// The process switches an output that would make the changer turn while the tool works.
[[nodiscard]] bool asks_a_changer(const Process& process, const Mounted& mounted);
/// The process switches the output that its tool was taught with, and none of a changer; nothing: neither was
/// taught.
[[nodiscard]] std::optional<bool> switches_as_taught(const Process& process, const Mounted& mounted);

/// What the arm carries along a path: what the process tells, else what was taught; nothing: the controller's
/// own setting counts.
[[nodiscard]] std::optional<Payload> carried(const Process& process, const Mounted& mounted);

/// A row for each part that was taught; empty: nothing was.
[[nodiscard]] std::vector<Check> check_mounted(const Process& process, const Mounted& mounted);

}  // namespace biteline::path
