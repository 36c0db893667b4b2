// SPDX-License-Identifier: MIT
#include "hal/sim/robot/dashboard.hpp"

#include <algorithm>
#include <iterator>

namespace biteline::sim::dashboard {
namespace {

constexpr int k_cb3 = 3;
constexpr std::array<std::string_view, 5> k_roles{"PROGRAMMER", "OPERATOR", "NONE", "LOCKED", "RESTRICTED"};

struct Asked {
  std::string_view text;  ///< what follows the word
  const Facts& facts;
  const std::map<std::string, std::string>& programs;
  Memory& memory;
};

const char* mode_text(RobotMode mode) {
  if (mode == RobotMode::PowerOff) return "POWER_OFF";
  if (mode == RobotMode::Booting) return "BOOTING";
  return mode == RobotMode::Idle ? "IDLE" : "RUNNING";
}

std::string program_name(const Asked& asked) {
  if (asked.facts.program != ProgramState::Stopped && !asked.facts.program_name.empty())
    return asked.facts.program_name;
  return asked.memory.loaded.empty() ? "<unnamed>" : file_of(asked.memory.loaded);
}

Answer loads(const Asked& asked) {
  const std::string name{asked.text};
  if (!asked.programs.contains(file_of(name))) return {"File not found: " + name};
  asked.memory.loaded = name;
  return {"Loading program: " + name, Order::Load};
}

Answer plays(const Asked& asked) {
  const bool ready = asked.facts.mode == RobotMode::Running && asked.facts.takes_programs &&
                     !asked.facts.protective_stop &&
                     (asked.facts.program == ProgramState::Paused || !asked.memory.loaded.empty());
  return ready ? Answer{"Starting program", Order::Play} : Answer{"Failed to execute: play"};
}

Answer pauses(const Asked& asked) {
  const bool runs = asked.facts.program == ProgramState::Playing;
  return runs ? Answer{"Pausing program", Order::Pause} : Answer{"Failed to execute: pause"};
}

Answer state_of(const Asked& asked) {
  const char* const state = asked.facts.program == ProgramState::Playing  ? "PLAYING "
                            : asked.facts.program == ProgramState::Paused ? "PAUSED "
                                                                          : "STOPPED ";
  return {state + program_name(asked)};
}

Answer takes_role(const Asked& asked) {
  const std::string role{asked.text};
  if (std::ranges::find(k_roles, asked.text) == k_roles.end()) return {"Failed setting user role: " + role};
  asked.memory.role = role;
  return {"Setting user role: " + role};
}

Answer takes_operational_mode(const Asked& asked) {
  std::string mode{asked.text};
  std::ranges::transform(mode, mode.begin(), [](unsigned char c) { return std::toupper(c); });
  if (mode != "MANUAL" && mode != "AUTOMATIC") return {"Failed setting operational mode: " + mode};
  asked.memory.operational_mode = mode;
  return {"Operational mode " + mode + " is set"};
}

Answer saved(const Asked& asked) {
  return {asked.memory.loaded.empty() ? "false" : "true " + file_of(asked.memory.loaded)};
}

std::string version_of(const Facts& facts) {
  return std::to_string(facts.version[0]) + "." + std::to_string(facts.version[1]) + "." +
         std::to_string(facts.version[2]) + ".0";
}

struct Word {
  std::string_view word;
  bool has_text;  ///< something follows it
  bool cb3, e_series;
  Answer (*answer)(const Asked& asked);
};

constexpr std::array k_words{
    Word{"PolyscopeVersion", false, true, true,
         [](const Asked& a) {
           return Answer{"URSoftware " + version_of(a.facts) + " (simulated by Biteline)"};
         }},
    Word{"version", false, false, true, [](const Asked& a) { return Answer{version_of(a.facts)}; }},
    Word{"robotmode", false, true, true,
         [](const Asked& a) { return Answer{std::string{"Robotmode: "} + mode_text(a.facts.mode)}; }},
    Word{"safetymode", false, true, true,
         [](const Asked& a) {
           return Answer{std::string{"Safetymode: "} +
                         (a.facts.protective_stop ? "PROTECTIVE_STOP" : "NORMAL")};
         }},
    Word{"safetystatus", false, false, true,
         [](const Asked& a) {
           return Answer{std::string{"Safetystatus: "} +
                         (a.facts.protective_stop ? "PROTECTIVE_STOP" : "NORMAL")};
         }},
    Word{"unlock protective stop", false, true, true,
         [](const Asked& a) {
           return a.facts.just_stopped
                      ? Answer{"Cannot unlock protective stop until 5s after occurrence. Always inspect cause of "
                               "protective stop before unlocking"}
                      : Answer{"Protective stop releasing", Order::Unlock};
         }},
    Word{"restart safety", false, true, true,
         [](const Asked&) {
           return Answer{"Restarting safety", Order::PowerOff};
         }},
    Word{"close safety popup", false, true, true,
         [](const Asked&) { return Answer{"closing safety popup"}; }},
    Word{"power on", false, true, true,
         [](const Asked&) {
           return Answer{"Powering on", Order::PowerOn};
         }},
    Word{"power off", false, true, true,
         [](const Asked&) {
           return Answer{"Powering off", Order::PowerOff};
         }},
    Word{"brake release", false, true, true,
         [](const Asked&) {
           return Answer{"Brake releasing", Order::ReleaseBrakes};
         }},
    Word{"load installation", true, true, true,
         [](const Asked& a) {
           a.memory.installation = std::string{a.text};
           return Answer{"Loading installation: " + a.memory.installation};
         }},
    Word{"load", true, true, true, loads},
    Word{"get loaded program", false, true, true,
         [](const Asked& a) {
           return Answer{a.memory.loaded.empty() ? "No program loaded"
                                                 : "Loaded program: " + a.memory.loaded};
         }},
    Word{"play", false, true, true, plays},
    Word{"pause", false, true, true, pauses},
    Word{"stop", false, true, true,
         [](const Asked&) {
           return Answer{"Stopped", Order::Stop};
         }},
    Word{"running", false, true, true,
         [](const Asked& a) {
           return Answer{a.facts.program == ProgramState::Playing ? "Program running: true"
                                                                  : "Program running: false"};
         }},
    Word{"programState", false, true, true, state_of},
    Word{"programstate", false, true, true, state_of},
    Word{"isProgramSaved", false, true, true, saved},
    Word{"popup", true, true, true,
         [](const Asked& a) {
           a.memory.popup = std::string{a.text};
           return Answer{"showing popup"};
         }},
    Word{"close popup", false, true, true,
         [](const Asked& a) {
           a.memory.popup.clear();
           return Answer{"closing popup", Order::ClosePopup};
         }},
    Word{"saveLog", false, true, true, [](const Asked&) { return Answer{"Log saved to disk"}; }},
    Word{"generate flight report", true, true, true,
         [](const Asked&) {
           return Answer{"Flight Report generated with id: none, this robot is simulated"};
         }},
    Word{"generate support file", true, true, true,
         [](const Asked&) {
           return Answer{"Completed successfully: nothing written, this robot is simulated"};
         }},
    Word{"addToLog", true, true, true, [](const Asked&) { return Answer{"Added log message"}; }},
    Word{"setUserRole", true, true, false, takes_role},
    Word{"getUserRole", false, true, false, [](const Asked& a) { return Answer{a.memory.role}; }},
    Word{"set operational mode", true, false, true, takes_operational_mode},
    Word{"get operational mode", false, false, true,
         [](const Asked& a) { return Answer{a.memory.operational_mode}; }},
    Word{"clear operational mode", false, false, true,
         [](const Asked& a) {
           a.memory.operational_mode = "NONE";
           return Answer{"No longer controlling the operational mode. Current mode is unchanged"};
         }},
    Word{"is in remote control", false, false, true,
         [](const Asked& a) { return Answer{a.facts.remote ? "true" : "false"}; }},
    Word{"get serial number", false, true, true, [](const Asked& a) { return Answer{a.facts.serial}; }},
    Word{"get robot model", false, true, true, [](const Asked& a) { return Answer{a.facts.model}; }},
    Word{"quit", false, true, true,
         [](const Asked&) {
           return Answer{"Disconnected", Order::Quit};
         }},
    Word{"shutdown", false, true, true,
         [](const Asked&) {
           return Answer{"Shutting down", Order::PowerOff};
         }},
};

}  // namespace

std::string file_of(std::string_view path) {
  return std::string{path.substr(path.rfind('/') + 1)};  // npos + 1 is 0
}

Answer answer_to(std::string_view line, const Facts& facts,
                 const std::map<std::string, std::string>& programs, Memory& memory) {
  const bool cb3 = facts.version[0] == k_cb3;
  for (const Word& word : k_words) {
    if (!(cb3 ? word.cb3 : word.e_series) || !line.starts_with(word.word)) continue;
    std::string_view text = line.substr(word.word.size());
    if (word.has_text != text.starts_with(' ')) continue;
    if (word.has_text) text.remove_prefix(1);
    if (!word.has_text && !text.empty()) continue;
    return word.answer({.text = text, .facts = facts, .programs = programs, .memory = memory});
  }
  return {"could not understand: '" + std::string{line} + "'"};
}

}  // namespace biteline::sim::dashboard
