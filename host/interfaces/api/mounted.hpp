// SPDX-License-Identifier: MIT
#pragma once
/// \file What is mounted is taught: touches of the arm, numbers, and versions in the memory.

#include <chrono>
#include <optional>

#include "host/interfaces/api/cell.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/records/memory/memory.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/robot/kinematics/touch_lesson.hpp"

namespace biteline::api {

/// The lesson in work, and what the controller said last.  Lost with the service: touching takes a minute.
/// Thread: one at a time.
class MountedRoom {
 public:
  MountedRoom(memory::Memory& memory, Cell& cell) : memory_{memory}, cell_{cell} {}

  /// `Mounted` of the API.
  [[nodiscard]] control::Answer read();
  /// Begins a lesson of `part` where another one was in work.
  [[nodiscard]] control::Answer touch(const Json& body, std::chrono::steady_clock::time_point heard);
  [[nodiscard]] control::Answer end_lesson();
  [[nodiscard]] control::Answer keep(const std::string& part, const Json& body, const std::string& who,
                                     const std::string& door);
  /// A person has mounted this tool.
  [[nodiscard]] control::Answer mount(const Json& body, const std::string& who, const std::string& door);
  [[nodiscard]] control::Answer forget(const std::string& part, const std::string& who,
                                       const std::string& door);

 private:
  [[nodiscard]] Json lesson_json() const;
  [[nodiscard]] control::Answer keep_lines(Fields& fields, const mounted::Hand& hand);

  memory::Memory& memory_;
  Cell& cell_;
  kinematics::TouchLesson lesson_;
  std::optional<robot::ur::ArmLook> look_{};
};

}  // namespace biteline::api
