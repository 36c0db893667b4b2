// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/controller_words.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <utility>

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

/// RTDE has tcp_offset from there on.
constexpr std::array<int, 3> k_least_cb3{3, 12, 3}, k_least_e_series{5, 5, 1};

std::string text_of(const std::array<int, 3>& version) {
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

Words program_state_of(const std::string& answer) {
  for (const char* state : {"STOPPED", "PLAYING", "PAUSED"}) {
    if (answer.starts_with(state)) return answer;
  }
  return std::nullopt;
}

}  // namespace

Result<ControllerWords> ask_controller(const Endpoint& endpoint, Nanoseconds patience) {
  Result<Dashboard> connected = Dashboard::connect(endpoint, patience);
  if (!connected && connected.error().sys_errno == ECONNREFUSED) {
    // The machine is there and says no.
    return fail_errno(
        Errc::ConnectFailed, ECONNREFUSED,
        "%.100s: no dashboard server there: PolyScope 3 and 5 have one, PolyScope X has none and is "
        "not supported",
        connected.error().where.c_str());
  }
  if (!connected) return tl::unexpected<Error>{connected.error()};
  Dashboard dashboard = std::move(*connected);
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

std::optional<std::string> unsupported(const ControllerWords& words) {
  // "URSoftware 5.12.0.0 (Jan 01 2022)"
  std::array<int, 3> told{};
  const int found = words.version ? std::sscanf(words.version->c_str(), "URSoftware %3d.%3d.%3d", &told[0],
                                                &told[1], &told[2])
                                  : 0;
  if (found < 2)
    return "the controller does not tell the version of its software: older than PolyScope 3.12.3?";
  for (const std::array<int, 3>& least : {k_least_cb3, k_least_e_series}) {
    if (told[0] != least[0]) continue;
    if (told >= least) return std::nullopt;
    return "PolyScope " + text_of(told) + " is too old: " + text_of(least) + " is the least";
  }
  return "PolyScope " + text_of(told) + " is not supported: 3 from " + text_of(k_least_cb3) +
         " on and 5 from " + text_of(k_least_e_series) + " on are";
}

std::string summary(const ControllerWords& words) {
  const auto told = [](const Words& word) { return word.value_or("not told"); };
  return told(words.model) + ", " + told(words.version) + ", serial number " + told(words.serial) +
         ", mode " + told(words.robot_mode) + ", program " + told(words.program_state) + ", remote control " +
         (words.remote ? (*words.remote ? "on" : "off") : "not told");
}

}  // namespace biteline::robot::ur
