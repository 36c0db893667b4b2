// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/controller_words.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace biteline::robot::ur {
namespace {

/// The least of each generation: RTDE has tcp_offset from 3.12.3 and 5.5.1 on; a PolyScope X tells whether it
/// is in remote control from 10.12 on.
constexpr std::array<std::array<int, 3>, 3> k_least{{{3, 12, 3}, {5, 5, 1}, {10, 12, 0}}};

std::string text_of(const std::array<int, 3>& version) {
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

}  // namespace

bool is_code(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  };
  return !text.empty() && std::ranges::all_of(text, plain);
}

std::optional<std::string> program_state_of(const std::string& answer) {
  for (const char* state : {"STOPPED", "PLAYING", "PAUSED"}) {
    if (answer.starts_with(state)) return answer;
  }
  return std::nullopt;
}

std::optional<std::string> unsupported(const ControllerWords& words) {
  // "URSoftware 5.12.0.0 (Jan 01 2022)", "PolyScope X 10.12.1"
  std::array<int, 3> told{};
  int found = 0;
  for (const char* form : {"URSoftware %3d.%3d.%3d", "PolyScope X %3d.%3d.%3d"}) {
    if (words.version && found < 2)
      found = std::sscanf(words.version->c_str(), form, &told[0], &told[1], &told[2]);
  }
  if (found < 2)
    return "the controller does not tell the version of its software: older than PolyScope 3.12.3?";
  for (const std::array<int, 3>& least : k_least) {
    if (told[0] != least[0]) continue;
    if (told >= least) return std::nullopt;
    return "PolyScope " + text_of(told) + " is too old: " + text_of(least) + " is the least";
  }
  return "PolyScope " + text_of(told) + " is not supported: 3 from " + text_of(k_least[0]) + " on, 5 from " +
         text_of(k_least[1]) + " on and 10 from " + text_of(k_least[2]) + " on are";
}

std::string summary(const ControllerWords& words) {
  const auto told = [](const std::optional<std::string>& word) { return word.value_or("not told"); };
  return told(words.model) + ", " + told(words.version) + ", serial number " + told(words.serial) +
         ", mode " + told(words.robot_mode) + ", program " + told(words.program_state) + ", remote control " +
         (words.remote ? (*words.remote ? "on" : "off") : "not told") +
         (words.odd.empty() ? "" : "; not known: " + words.odd);
}

}  // namespace biteline::robot::ur
