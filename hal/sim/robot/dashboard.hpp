// SPDX-License-Identifier: MIT
#pragma once
/// \file A dashboard's words: what is answered, and what the controller is told to do.

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "hal/sim/robot/power.hpp"

namespace biteline::sim::dashboard {

enum class ProgramState { Stopped, Playing, Paused };

/// Of the controller, at the moment.
struct Facts {
  std::array<int, 3> version{};
  RobotMode mode{RobotMode::Running};
  bool remote{true};          ///< as it says
  bool takes_programs{true};  ///< not in local control
  bool protective_stop{false};
  bool just_stopped{false};  ///< the protective stop is less than 5 s old
  ProgramState program{ProgramState::Stopped};
  std::string program_name{};
  std::string model{}, serial{};
};

/// What clients have set; the controller's own, for all of them.
struct Memory {
  std::string loaded{};  ///< the program, as it was named
  std::string installation{"default.installation"};
  std::string role{"NONE"};              ///< CB3
  std::string operational_mode{"NONE"};  ///< e-Series
  std::string popup{};
};

enum class Order {
  None,
  Load,
  Play,
  Pause,
  Stop,
  PowerOn,
  PowerOff,
  ReleaseBrakes,
  Unlock,
  ClosePopup,
  Quit
};

struct Answer {
  std::string text;
  Order order{Order::None};
};

/// Without its folders.
[[nodiscard]] std::string file_of(std::string_view path);

/// One line of a client, without its end.  `programs`: by their names, as a file system's folder of programs
/// has them.  A word that this generation does not know gets the real one's answer to the unknown.  Universal
/// Robots, "Dashboard server e-Series" and "Dashboard server CB-series": words and answers.
[[nodiscard]] Answer answer_to(std::string_view line, const Facts& facts,
                               const std::map<std::string, std::string>& programs, Memory& memory);

}  // namespace biteline::sim::dashboard
