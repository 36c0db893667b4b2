// SPDX-License-Identifier: MIT
#include "hal/sim/robot/robot_api.hpp"

#include <cstdlib>
#include <string_view>

namespace biteline::sim::robot_api {
namespace {

constexpr std::string_view k_base = "/universal-robots/robot-api";

std::string pair(const char* key, const std::string& value) {
  return "\"" + std::string{key} + "\":\"" + value + "\"";
}

Answer told(const std::string& pairs) {
  return {.status = 200, .body = "{" + pairs + "}", .order = Order::None};
}

Answer refused(int status, const char* why) {
  return {.status = status, .body = "{" + pair("message", why) + "}", .order = Order::None};
}

Answer ordered(const Request& request, const State& state) {
  if (!state.remote) return refused(403, "Robot must be in remote mode");
  const auto wants = [&](const char* action) {
    return request.body.find("\"" + std::string{action} + "\"") != std::string::npos;
  };
  const auto done = [](Order order, const std::string& pairs) {
    Answer answer = told(pairs);
    answer.order = order;
    return answer;
  };
  if (request.target.ends_with("/program/v1/state"))
    return wants("stop") ? done(Order::Stop, pair("state", "STOPPED")) : refused(422, "action");
  if (wants("POWER_OFF")) return done(Order::PowerOff, pair("message", "POWER_OFF"));
  if (wants("POWER_ON") || wants("BRAKE_RELEASE")) return done(Order::PowerOn, pair("message", "POWER_ON"));
  if (!wants("UNLOCK_PROTECTIVE_STOP")) return refused(422, "action");
  return state.protective_stop ? done(Order::UnlockProtectiveStop, pair("message", "unlocked"))
                               : refused(409, "not in a protective stop");
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

Answer answer_to(const Request& request, const State& state) {
  if (!request.target.starts_with(k_base)) return refused(404, "Not Found");
  const std::string path = request.target.substr(k_base.size());
  if (request.method == "PUT" && (path == "/program/v1/state" || path == "/robotstate/v1/state"))
    return ordered(request, state);
  if (request.method != "GET") return refused(405, "Method Not Allowed");
  if (path == "/program/v1/state") return told(pair("state", state.program_running ? "PLAYING" : "STOPPED"));
  if (state.version[1] >= 12) {
    if (path == "/system/v1/controlmode") return told(pair("mode", state.remote ? "REMOTE" : "LOCAL"));
    if (path == "/system/v1/operationalmode")
      return told(pair("mode", state.remote ? "AUTOMATIC" : "MANUAL"));
    if (path == "/robotstate/v1/robotmode")
      return told(pair("mode", state.powered ? "RUNNING" : "POWER_OFF"));
    if (path == "/robotstate/v1/safetymode")
      return told(pair("mode", state.protective_stop ? "PROTECTIVE_STOP" : "NORMAL"));
  }
  if (state.version[1] >= 14) {
    if (path == "/system/v1/information")
      return told(pair("robotType", state.model) + "," + pair("serialNumber", state.serial));
    if (path == "/versions/v1")
      return told(pair("marketingVersion", std::to_string(state.version[0]) + "." +
                                               std::to_string(state.version[1]) + "." +
                                               std::to_string(state.version[2])));
  }
  return refused(404, "Not Found");
}

std::string http_text(const Answer& answer) {
  return "HTTP/1.1 " + std::to_string(answer.status) +
         " \r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(answer.body.size()) +
         "\r\nConnection: close\r\n\r\n" + answer.body;
}

}  // namespace biteline::sim::robot_api
