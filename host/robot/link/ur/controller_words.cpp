// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/controller_words.hpp"

#include <algorithm>

namespace biteline::robot::ur {
namespace {

using Words = std::optional<std::string>;

bool is_code(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  };
  return !text.empty() && std::ranges::all_of(text, plain);
}

Words after(const std::string& answer, const char* begin) {
  const std::string prefix{begin};
  return answer.starts_with(prefix) ? Words{answer.substr(prefix.size())} : std::nullopt;
}

Words program_state_of(const std::string& answer) {
  for (const char* state : {"STOPPED", "PLAYING", "PAUSED"}) {
    if (answer.starts_with(state)) return answer;
  }
  return std::nullopt;
}

}  // namespace

Result<ControllerWords> ask_controller(const Endpoint& endpoint, Nanoseconds patience) {
  BITELINE_ASSIGN(Dashboard dashboard, Dashboard::connect(endpoint, patience));
  const auto ask = [&](const char* question) { return dashboard.ask(question, patience); };
  ControllerWords words;
  BITELINE_ASSIGN(const std::string version, ask("PolyscopeVersion"));
  if (version.starts_with("URSoftware ")) words.version = version;
  BITELINE_ASSIGN(const std::string model, ask("get robot model"));
  if (is_code(model) && model.starts_with("UR")) words.model = model;
  BITELINE_ASSIGN(const std::string serial, ask("get serial number"));
  if (is_code(serial)) words.serial = serial;
  BITELINE_ASSIGN(const std::string remote, ask("is in remote control"));
  if (remote == "true" || remote == "false") words.remote = remote == "true";
  BITELINE_ASSIGN(const std::string mode, ask("robotmode"));
  words.robot_mode = after(mode, "Robotmode: ");
  BITELINE_ASSIGN(const std::string program, ask("programState"));
  words.program_state = program_state_of(program);
  return words;
}

std::string summary(const ControllerWords& words) {
  const auto told = [](const Words& word) { return word.value_or("not told"); };
  return told(words.model) + ", " + told(words.version) + ", serial number " + told(words.serial) +
         ", mode " + told(words.robot_mode) + ", program " + told(words.program_state) + ", remote control " +
         (words.remote ? (*words.remote ? "on" : "off") : "not told");
}

}  // namespace biteline::robot::ur
