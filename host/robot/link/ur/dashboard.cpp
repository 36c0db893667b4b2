// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/dashboard.hpp"

#include <algorithm>
#include <chrono>

namespace biteline::robot::ur {
namespace {

constexpr const char* k_remote_question = "is in remote control";

constexpr Nanoseconds k_write_patience{500'000'000};
constexpr std::size_t k_longest_line = 4096;  // who sends more without a line's end is no dashboard
constexpr std::size_t k_told = 200;

std::optional<std::string> after(const std::string& answer, const char* begin) {
  const std::string prefix{begin};
  return answer.starts_with(prefix) ? std::optional{answer.substr(prefix.size())} : std::nullopt;
}

std::string printable(std::string line) {
  std::erase_if(line, [](char c) { return c < ' ' || c > '~'; });
  if (line.size() > k_told) line.resize(k_told);
  return line;
}

}  // namespace

Result<std::unique_ptr<ControllerDoor>> Dashboard::connect(const Endpoint& endpoint, Nanoseconds patience) {
  auto dashboard = std::make_unique<Dashboard>(endpoint);
  BITELINE_ASSIGN(dashboard->stream_, TcpStream::connect(endpoint, patience));
  if (const Endpoint found = dashboard->stream_.numeric_peer(); found.port != 0) dashboard->at_ = found;
  return dashboard;
}

Result<ControllerWords> Dashboard::words(Nanoseconds patience) {
  ControllerWords words;
  BITELINE_ASSIGN(const std::string version, ask("PolyscopeVersion", patience));
  if (version.starts_with("URSoftware ")) words.version = version;
  BITELINE_ASSIGN(const std::string model, ask("get robot model", patience));
  if (is_code(model) && model.starts_with("UR")) words.model = model;
  BITELINE_ASSIGN(const std::string serial, ask("get serial number", patience));
  if (is_code(serial)) words.serial = serial;
  BITELINE_ASSIGN(const std::string remote, ask(k_remote_question, patience));
  if (remote == "true" || remote == "false") words.remote = remote == "true";
  BITELINE_ASSIGN(const std::string mode, ask("robotmode", patience));
  words.robot_mode = after(mode, "Robotmode: ");
  BITELINE_ASSIGN(const std::string program, ask("programState", patience));
  words.program_state = program_state_of(program);
  return words;
}

Result<void> Dashboard::ask_remote() {
  return say(k_remote_question);
}

Result<void> Dashboard::say(const std::string& command) {
  return stream_.write_all(command + "\n", k_write_patience);
}

Result<std::string> Dashboard::hear(Nanoseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::vector<std::uint8_t> bytes;
  while (true) {
    for (std::size_t end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
      const std::string line = printable(heard_.substr(0, end));
      heard_.erase(0, end + 1);
      if (!line.starts_with("Connected")) return line;
    }
    if (heard_.size() > k_longest_line) return fail(Errc::ProtocolError, "dashboard: a line without an end");
    const Nanoseconds left =
        std::max<Nanoseconds>(deadline - std::chrono::steady_clock::now(), Nanoseconds{0});
    BITELINE_TRY(stream_.read_some(bytes, left));
    if (bytes.empty() && left == Nanoseconds{0}) return fail(Errc::Timeout, "dashboard");
    heard_.append(bytes.begin(), bytes.end());
  }
}

Result<std::string> Dashboard::ask(const std::string& command, Nanoseconds patience) {
  BITELINE_TRY(say(command));
  return hear(patience);
}

}  // namespace biteline::robot::ur
