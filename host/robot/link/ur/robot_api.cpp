// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/robot_api.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/robot/link/ur/told_version.hpp"

namespace biteline::robot::ur {
namespace {

// Universal Robots, "Robot API" 1 of PolyScope X.
constexpr const char* k_base = "/universal-robots/robot-api";
constexpr const char* k_program = "/program/v1/state";
constexpr const char* k_control_mode = "/system/v1/controlmode";
constexpr const char* k_robot_mode = "/robotstate/v1/robotmode";
constexpr const char* k_information = "/system/v1/information";
constexpr std::size_t k_longest_word = 60;
constexpr std::chrono::seconds k_question_lives{2};  // then it is asked anew

Result<HttpAnswer> get(const Endpoint& at, const char* path, Nanoseconds patience) {
  BITELINE_ASSIGN(HttpQuestion question,
                  HttpQuestion::begin(at, http_text(at, "GET", std::string{k_base} + path)));
  return question.wait(patience);
}

/// "true", "false", or why that is not known.
std::string remote_of(const HttpAnswer& answer) {
  const Result<std::string> mode = text_in(answer, "mode");
  if (!mode) return mode.error().where.c_str();
  return *mode == "REMOTE" ? "true" : *mode == "LOCAL" ? "false" : *mode;
}

}  // namespace

Result<std::string> text_in(const HttpAnswer& answer, const char* key) {
  if (answer.status == 404) return fail(Errc::NotSupported, "this software does not tell (HTTP 404)");
  if (answer.status == 401 || answer.status == 403)
    return fail(Errc::PeerRefused, "it does not say (HTTP %d)", answer.status);
  if (answer.status != 200) return fail(Errc::BadFormat, "no answer (HTTP %d)", answer.status);
  const nlohmann::json json = nlohmann::json::parse(answer.body, nullptr, false);
  if (!json.is_object()) return fail(Errc::BadFormat, "its answer is no JSON object");
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string())
    return fail(Errc::BadFormat, "its answer has no text \"%.20s\"", key);
  const auto text = found->get<std::string>();
  const auto odd = [](char c) { return c < ' ' || c > '~'; };
  if (text.size() > k_longest_word || std::ranges::any_of(text, odd))
    return fail(Errc::BadFormat, "its \"%.20s\" is no word", key);
  return text;
}

Result<std::unique_ptr<ControllerDoor>> RobotApi::open(const DoorPlaces& places, Nanoseconds patience) {
  const Endpoint& at = places.robot_api;
  auto door = std::make_unique<RobotApi>(places);
  BITELINE_ASSIGN(TcpStream stream, TcpStream::connect(at, patience));
  if (const Endpoint found = stream.numeric_peer(); found.port != 0) door->at_ = found;
  stream.close();  // a server may take one at a time
  BITELINE_ASSIGN(const HttpAnswer answer, get(door->at_, k_program, patience));
  if (const Result<std::string> state = text_in(answer, "state"); !state)
    return fail(state.error().code, "%.60s:%u%s%s: %.80s", at.host.c_str(), static_cast<unsigned>(at.port),
                k_base, k_program, state.error().where.c_str());
  return door;
}

Result<ControllerWords> RobotApi::words(Nanoseconds patience) {
  ControllerWords words;
  const auto note = [&](const std::string& what, const std::string& why) {
    if (words.odd.empty()) words.odd = what + ": " + why;
  };
  const auto told = [&](const HttpAnswer& answer, const char* path, const char* key) {
    const Result<std::string> text = text_in(answer, key);
    if (!text) note(path, text.error().where.c_str());
    return text ? std::optional{*text} : std::nullopt;
  };
  BITELINE_ASSIGN(const HttpAnswer control, get(at_, k_control_mode, patience));
  const std::string remote = remote_of(control);
  if (remote == "true" || remote == "false")
    words.remote = remote == "true";
  else
    note(k_control_mode, remote);
  BITELINE_ASSIGN(const HttpAnswer mode, get(at_, k_robot_mode, patience));
  words.robot_mode = told(mode, k_robot_mode, "mode");
  BITELINE_ASSIGN(const HttpAnswer program, get(at_, k_program, patience));
  if (const auto state = told(program, k_program, "state")) words.program_state = program_state_of(*state);
  BITELINE_ASSIGN(const HttpAnswer information, get(at_, k_information, patience));
  const auto model = told(information, k_information, "robotType");
  if (model && is_code(*model) && model->starts_with("UR")) words.model = model;
  const auto serial = told(information, k_information, "serialNumber");
  if (serial && is_code(*serial)) words.serial = serial;
  // In local control that port may be closed: the rest is known all the same.
  if (const Result<SoftwareVersion> version = ask_version(script_, patience)) {
    words.version = "PolyScope X " + std::to_string((*version)[0]) + "." + std::to_string((*version)[1]) +
                    "." + std::to_string((*version)[2]);
  } else {
    note("the version of its software", version.error().where.c_str());
  }
  return words;
}

Result<void> RobotApi::ask_remote() {
  BITELINE_ASSIGN(remote_,
                  HttpQuestion::begin(at_, http_text(at_, "GET", std::string{k_base} + k_control_mode)));
  asked_ = std::chrono::steady_clock::now();
  static_cast<void>(remote_->push());
  return {};
}

Result<std::string> RobotApi::hear_remote(Nanoseconds patience) {
  if (!remote_) return fail(Errc::WrongState, "nothing was asked");
  const Result<HttpAnswer> answer = remote_->wait(patience);
  const bool waits = !answer && answer.error().code == Errc::Timeout;
  if (waits && std::chrono::steady_clock::now() - asked_ < k_question_lives)
    return tl::unexpected<Error>{answer.error()};
  remote_.reset();
  if (waits) return fail(Errc::ConnectionLost, "a question without an answer");
  if (!answer) return tl::unexpected<Error>{answer.error()};
  return remote_of(*answer);
}

Delivery RobotApi::stop_word() {
  stop_.close();
  return {stop_, at_, http_text(at_, "PUT", std::string{k_base} + k_program, R"({"action": "stop"})")};
}

}  // namespace biteline::robot::ur
