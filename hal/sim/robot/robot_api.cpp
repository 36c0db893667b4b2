// SPDX-License-Identifier: MIT
#include "hal/sim/robot/robot_api.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

namespace biteline::sim::robot_api {
namespace {

using Json = nlohmann::ordered_json;
using Scripts = std::map<std::string, std::string>;

constexpr std::string_view k_base = "/universal-robots/robot-api";
constexpr int k_modes_from = 12, k_information_from = 14;

struct Asked {
  const Request& request;
  const State& state;
  const Scripts& scripts;
  Memory& memory;
};

Answer told(const Json& body, Order order = Order::None) {
  return {.status = 200, .body = body.dump(), .order = order};
}

Answer refused(int status, const char* why) {
  return {.status = status, .body = Json{{"message", why}}.dump(), .order = Order::None};
}

/// Empty: the body has no such word.
std::string word_in(const Request& request, const char* key) {
  const Json body = Json::parse(request.body, nullptr, false);
  if (!body.is_object() || !body.contains(key) || !body[key].is_string()) return {};
  return body[key].get<std::string>();
}

const char* text_of(RobotMode mode) {
  switch (mode) {
    case RobotMode::Booting:
      return "BOOTING";
    case RobotMode::PowerOff:
      return "POWER_OFF";
    case RobotMode::Idle:
      return "IDLE";
    case RobotMode::Running:
      return "RUNNING";
  }
  return "";
}

Answer program_order(const Asked& asked) {
  const std::string action = word_in(asked.request, "action");
  const bool runs = asked.state.mode == RobotMode::Running && !asked.state.protective_stop;
  if (action == "stop") return told({{"state", "STOPPED"}}, Order::Stop);
  if (action == "pause") return told({{"state", "PAUSED"}}, Order::Pause);
  if (action != "play" && action != "resume") return refused(422, "action");
  if (!runs) return refused(409, "the robot does not run");
  if (action == "play" && !asked.scripts.contains(asked.memory.loaded)) return refused(409, "nothing to run");
  return told({{"state", "PLAYING"}}, Order::Play);
}

Answer power_order(const Asked& asked) {
  const std::string action = word_in(asked.request, "action");
  const auto done = [&](Order order) { return told({{"message", action}}, order); };
  if (action == "POWER_OFF" || action == "RESTART_SAFETY") return done(Order::PowerOff);
  if (action == "POWER_ON") return done(Order::PowerOn);
  if (action == "BRAKE_RELEASE") return done(Order::ReleaseBrakes);
  if (action != "UNLOCK_PROTECTIVE_STOP") return refused(422, "action");
  return asked.state.protective_stop ? done(Order::Unlock) : refused(409, "not in a protective stop");
}

Answer load_order(const Asked& asked) {
  const std::string name = word_in(asked.request, "name");
  if (!asked.scripts.contains(name) && !asked.memory.uploaded.contains(name))
    return refused(404, "no such program");
  asked.memory.loaded = name;
  return told({{"name", name}}, Order::Load);
}

Answer program_list(const Asked& asked) {
  Json list = Json::array();
  const auto add = [&](const Scripts& programs) {
    for (const auto& [name, text] : programs) {
      list.push_back({{"name", name},
                      {"description", ""},
                      {"createdDate", 0},
                      {"lastModifiedDate", nullptr},
                      {"lastSavedDate", nullptr},
                      {"programState", "FINAL"}});
    }
  };
  add(asked.scripts);
  add(asked.memory.uploaded);
  return told({{"programs", list}});
}

/// The program of a form's one file: JSON between the head of the part and its boundary.
Answer kept(const Asked& asked, bool anew) {
  const std::string& form = asked.request.body;
  const std::size_t begin = form.find("\r\n\r\n"), end = form.rfind("\r\n--");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return refused(422, "file");
  const std::string text = form.substr(begin + 4, end - begin - 4);
  const Json program = Json::parse(text, nullptr, false);
  const Json::json_pointer name_at{"/program/programInformation/name"};
  if (program.is_discarded() || !program.contains(name_at) || !program[name_at].is_string())
    return refused(422, "a program with a name");
  const auto name = program[name_at].get<std::string>();
  if (anew == asked.memory.uploaded.contains(name))
    return anew ? refused(400, "a program of that name is there") : refused(404, "no such program");
  asked.memory.uploaded[name] = text;
  return told({{"programName", name}});
}

std::string plain_path(std::string_view target) {
  std::string path;
  for (std::size_t i = 0; i < target.size(); ++i) {
    const bool coded = target[i] == '%' && i + 2 < target.size();
    path += coded ? static_cast<char>(std::strtol(std::string{target.substr(i + 1, 2)}.c_str(), nullptr, 16))
                  : target[i];
    if (coded) i += 2;
  }
  return path;
}

struct Question {
  std::string_view path;
  int from_minor;
  Answer (*answer)(const Asked& asked);
};
constexpr std::array k_questions{
    Question{"/openapi.json", 11,
             [](const Asked& asked) {
               const char* version = asked.state.version[1] < k_modes_from ? "3.1.0" : "3.1.4";
               return told({{"openapi", "3.0.3"},
                            {"info", {{"title", "Robot API, simulated by Biteline"}, {"version", version}}}});
             }},
    Question{"/program/v1/state", 11,
             [](const Asked& asked) {
               return told({{"state", asked.state.program}});
             }},
    Question{"/program/v1/loaded", k_modes_from,
             [](const Asked& asked) {
               return told({{"name", asked.memory.loaded}});
             }},
    Question{"/programs/v1/", k_modes_from, program_list},
    Question{"/system/v1/controlmode", k_modes_from,
             [](const Asked& asked) {
               return told({{"mode", asked.state.remote ? "REMOTE" : "LOCAL"}});
             }},
    Question{"/system/v1/operationalmode", k_modes_from,
             [](const Asked& asked) {
               return told({{"mode", asked.state.remote ? "AUTOMATIC" : "MANUAL"}});
             }},
    Question{"/robotstate/v1/robotmode", k_modes_from,
             [](const Asked& asked) {
               return told({{"mode", text_of(asked.state.mode)}});
             }},
    Question{"/robotstate/v1/safetymode", k_modes_from,
             [](const Asked& asked) {
               return told({{"mode", asked.state.protective_stop ? "PROTECTIVE_STOP" : "NORMAL"}});
             }},
    Question{"/system/v1/information", k_information_from,
             [](const Asked& asked) {
               return told({{"robotType", asked.state.model}, {"serialNumber", asked.state.serial}});
             }},
    Question{"/versions/v1", k_information_from, [](const Asked& asked) {
               const auto& v = asked.state.version;
               return told({{"marketingVersion", std::to_string(v[0]) + "." + std::to_string(v[1]) + "." +
                                                     std::to_string(v[2])}});
             }}};

Answer asked_for(const Asked& asked, const std::string& path) {
  constexpr std::string_view k_programs = "/programs/v1/";
  for (const Question& question : k_questions) {
    if (path == question.path && asked.state.version[1] >= question.from_minor) return question.answer(asked);
  }
  if (!path.starts_with(k_programs) || asked.state.version[1] < k_modes_from)
    return refused(404, "Not Found");
  const auto program = asked.memory.uploaded.find(path.substr(k_programs.size()));
  if (program == asked.memory.uploaded.end()) return refused(404, "no such program");
  return {.status = 200, .body = program->second, .order = Order::None};
}

}  // namespace

std::optional<Request> take_request(std::vector<std::uint8_t>& bytes) {
  const std::string text(bytes.begin(), bytes.end());
  const std::size_t head = text.find("\r\n\r\n");
  if (head == std::string::npos) return std::nullopt;
  constexpr std::string_view k_length = "Content-Length: ";
  const std::size_t length_at = text.substr(0, head).find(k_length);
  const std::size_t length = length_at == std::string::npos
                                 ? 0
                                 : std::strtoul(text.c_str() + length_at + k_length.size(), nullptr, 10);
  if (text.size() - head - 4 < length) return std::nullopt;
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(head + 4 + length));
  const std::size_t method_end = text.find(' ');
  const std::size_t target_end = text.find(' ', method_end + 1);
  return Request{.method = text.substr(0, method_end),
                 .target = text.substr(method_end + 1, target_end - method_end - 1),
                 .body = text.substr(head + 4, length)};
}

Answer answer_to(const Request& request, const State& state, const Scripts& scripts, Memory& memory) {
  if (!request.target.starts_with(k_base)) return refused(404, "Not Found");
  const std::string path = plain_path(std::string_view{request.target}.substr(k_base.size()));
  const Asked asked{.request = request, .state = state, .scripts = scripts, .memory = memory};
  if (request.method == "GET") return asked_for(asked, path);
  const bool puts = request.method == "PUT", has_programs = state.version[1] >= k_modes_from;
  if (path == "/programs/v1/" && has_programs && (puts || request.method == "POST"))
    return kept(asked, !puts);
  if (!puts) return refused(405, "Method Not Allowed");
  if (!state.remote) return refused(403, "Robot must be in remote mode");
  if (path == "/program/v1/state") return program_order(asked);
  if (path == "/robotstate/v1/state") return power_order(asked);
  if (path == "/program/v1/loaded" && has_programs) return load_order(asked);
  return refused(404, "Not Found");
}

std::string http_text(const Answer& answer) {
  return "HTTP/1.1 " + std::to_string(answer.status) +
         " \r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(answer.body.size()) +
         "\r\nConnection: close\r\n\r\n" + answer.body;
}

}  // namespace biteline::sim::robot_api
