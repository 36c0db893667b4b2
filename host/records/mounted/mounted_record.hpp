// SPDX-License-Identifier: MIT
#pragma once
/// \file What is mounted at a cell as it was taught, in the memory: the newest version; the log has them all.

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "host/records/memory/memory.hpp"
#include "host/robot/kinematics/touch_lesson.hpp"
#include "host/robot/path/mounted.hpp"

namespace biteline::mounted {

/// Who taught a part, when, and how well it is known.
struct Taught {
  int version{0};
  std::string who;
  memory::UnixMs time{0};
  int touches{0};  ///< 0: told as numbers
  double residual_mm{0}, u95_mm{0};
};
struct Tip {
  Vec3 tip_flange{Vec3::Zero()};  ///< mm
  Taught how{};
};
struct Load {
  path::Payload payload{};
  Taught how{};
};
struct Table {
  double z_mm{0};      ///< in the robot's base
  int tip_version{0};  ///< of the tip that touched it; 0: an older program did not tell
  Taught how{};
};

struct Lines {
  path::ToolLines lines{};
  Taught how{};
};

/// A tool of the cell by its name, as a person or its changer said that it is mounted.
struct MountedTool {
  std::string name;
  Taught how{};
};
/// What is known of a tool that is not mounted now.
struct ShelvedTool {
  std::optional<Tip> tip{};
  std::optional<Load> payload{};
  std::optional<Lines> lines{};
  std::optional<Taught> renewed{};  ///< its disc, brush or roller: wear counts from then
};

struct Record {
  int version{0};  ///< counts every change
  std::optional<MountedTool> tool{};
  std::map<std::string, ShelvedTool> shelf{};  ///< the cell's other tools, by name
  /// Of the mounted tool.
  std::optional<Tip> tip{};
  std::optional<Load> payload{};
  std::optional<Lines> lines{};
  std::optional<Taught> renewed{};
  std::optional<Table> table{};

  /// For a process that names this tool: what was taught of it, mounted or on the shelf; empty: the mounted
  /// one.
  [[nodiscard]] path::Mounted mounted(const std::string& tool) const;
};

enum class Part { Tip, Payload, Table, Tool, Lines, Renewed };
[[nodiscard]] const char* name_of(Part part);  ///< "tip", "payload", "table", "tool", "lines", "renewed"
[[nodiscard]] std::optional<Part> part_of(const std::string& name);

/// Who changes it, and through which door.
struct Hand {
  std::string who, door;
};

[[nodiscard]] nlohmann::ordered_json to_json(const Record& record);
/// One part of it; null: not taught.
[[nodiscard]] nlohmann::ordered_json to_json(const Record& record, Part part);

/// Errc::BadFormat: what stands there was not written by this program; nothing may be sent then.
[[nodiscard]] Result<Record> read_record(const memory::Memory& memory);

/// A new version with what a lesson gave; the answer is the record as it is now.  Here and below change and
/// log line are one transaction.
[[nodiscard]] Result<Record> keep_touched(memory::Memory& memory, kinematics::TouchLesson::Part part,
                                          const kinematics::Touched& touched, std::size_t touches,
                                          const Hand& hand);
/// Errc::BadValue: beyond 20 kg, or a centre beyond 1000 mm, as of a process.
[[nodiscard]] Result<Record> keep_payload(memory::Memory& memory, const path::Payload& payload,
                                          const Hand& hand);
/// Of the mounted tool: what switches it on, and its place in the changer.  Errc::BadValue: not 0 to 7, an
/// output twice, or a place that another tool has; Errc::WrongState: nobody has named the mounted tool.
[[nodiscard]] Result<Record> keep_lines(memory::Memory& memory, const path::ToolLines& lines,
                                        const Hand& hand);
/// The mounted tool has a new disc, brush or roller.  Errc::WrongState: nobody has named it.
[[nodiscard]] Result<Record> renew_tool(memory::Memory& memory, const Hand& hand);
/// A new version with this tool mounted.  Tip, payload and lines are then what was taught of it before; those
/// of the tool before go with that one's name.  A tool without a name gets this one, where the shelf has none
/// of it. Errc::BadValue: path::is_name() takes it for none.
/// Errc::WrongState: what was taught without a name would be lost to what the shelf has of this one.
[[nodiscard]] Result<Record> mount_tool(memory::Memory& memory, const std::string& name, const Hand& hand);
/// A new version without this part: it is checked no more.  Without a tool: nobody has said
/// which one is mounted, and what was taught of it is on the shelf.
[[nodiscard]] Result<Record> forget(memory::Memory& memory, Part part, const Hand& hand);

}  // namespace biteline::mounted
