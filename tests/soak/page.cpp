// SPDX-License-Identifier: MIT
#include "tests/soak/page.hpp"

#include <nlohmann/json.hpp>

#include "tests/support/json.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::soak {
namespace {

using intake::ChildProcess;
using test::WebClient;
using namespace std::chrono_literals;

constexpr const char* k_viewer = "soak";
constexpr const char* k_password = "nobody else is here";
constexpr auto k_start_patience = 60s;
/// Between two tries of the viewer, and between two looks whether he is to stop.
constexpr auto k_pause = 300ms;
constexpr int k_look_ms = 100;
constexpr auto k_between_asks = 1s;
constexpr int k_binary = 2, k_close = 8, k_ping = 9;
constexpr char k_picture = 1, k_profile = 2;

/// "http://127.0.0.1:40123" as 40123.
std::uint16_t port_of(const std::string& line) {
  const std::size_t at = line.rfind(':');
  return at == std::string::npos ? std::uint16_t{0}
                                 : static_cast<std::uint16_t>(std::atoi(line.c_str() + at + 1));
}

/// A client's pong is masked (RFC 6455, 5.3); the server's pings are empty.
const std::string k_pong{'\x8A', '\x80', 0, 0, 0, 0};

}  // namespace

Result<void> Page::make_viewer(const std::filesystem::path& programs, const std::filesystem::path& results) {
  BITELINE_ASSIGN(ChildProcess child,
                  ChildProcess::start({.program = programs / "biteline-web",
                                       .arguments = {"--add-user", k_viewer, "--role", "administrator",
                                                     "--out", results.string()},
                                       .give_stdin = true}));
  BITELINE_TRY(child.write_line(k_password));
  BITELINE_ASSIGN(const int status, child.wait(k_start_patience));
  if (status != 0) return fail(Errc::ProcessDied, "no account of the viewer: %s", child.last_words().c_str());
  return {};
}

Page::Page(std::filesystem::path programs, std::string control, std::string sensor)
    : programs_{std::move(programs)}, control_{std::move(control)}, sensor_{std::move(sensor)} {}

Page::~Page() {
  // A viewer who waits for an answer gets his end with the program.
  viewer_.request_stop();
  program_.reset();
}

Result<void> Page::start() {
  program_.reset();
  BITELINE_ASSIGN(
      ChildProcess child,
      ChildProcess::start({.program = programs_ / "biteline-web",
                           .arguments = {"--listen", "127.0.0.1:" + std::to_string(port_wanted_), "--control",
                                         control_, "--sensor", sensor_, "--exit-with-parent"}}));
  BITELINE_ASSIGN(const std::string line, child.next_line(k_start_patience));
  port_wanted_ = port_of(line);
  if (port_wanted_ == 0) return fail(Errc::BadFormat, "biteline-web said '%s'", line.c_str());
  port_ = port_wanted_;
  program_.emplace(std::move(child));
  if (!viewer_.joinable()) viewer_ = std::jthread{[this](const std::stop_token& stop) { look(stop); }};
  return {};
}

Seen Page::seen() const {
  const std::scoped_lock lock{mutex_};
  return {.pictures = pictures_, .profiles = profiles_, .answers = answers_, .losses = losses_};
}

void Page::look(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const std::string why = visit(port_, stop);
    if (stop.stop_requested()) return;
    {
      const std::scoped_lock lock{mutex_};
      ++losses_[why];
    }
    std::this_thread::sleep_for(k_pause);
  }
}

/// Until a connection ends; why.
std::string Page::visit(std::uint16_t port, const std::stop_token& stop) {
  WebClient asks{port};
  if (!asks.connected()) return "nobody listens";
  const auto bearer = [this] { return "Authorization: Bearer " + token_ + "\r\n"; };
  if (token_.empty() || asks.ask("GET", "/api/v1/state", bearer()).status == 401) {
    const nlohmann::json login{{"name", k_viewer}, {"password", k_password}};
    const test::WebReply reply = asks.ask("POST", "/api/v1/sessions", "", test::text_of(login));
    const auto session = test::read_json(reply.body);
    if (reply.status != 201 || !session.is_object()) return "login: " + std::to_string(reply.status);
    token_ = session.value("token", "");
  }
  WebClient live{port};
  const int upgraded = live.upgrade("/api/v1/live", bearer()).status;
  if (upgraded != 101) return "live: " + std::to_string(upgraded);
  auto ask_at = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    if (still_) {
      std::this_thread::sleep_for(k_pause);
      continue;
    }
    if (std::chrono::steady_clock::now() >= ask_at) {
      ask_at += k_between_asks;
      const int status = asks.ask("GET", "/api/v1/state", bearer()).status;
      if (status == 0 || status == 401) return "state: " + std::to_string(status);
      if (status == 200) ++answers_;
      if (starts_) {
        asks.ask("POST", "/api/v1/control", bearer(), R"({"action":"take"})");
        if (asks.ask("POST", "/api/v1/commands/start", bearer(), "{}").status == 202) starts_ = false;
      }
    }
    if (!live.readable(k_look_ms)) continue;
    const auto frame = live.frame();
    if (!frame) return "live data ended";
    if (frame->opcode == k_close) return "live data closed";
    if (frame->opcode == k_ping) live.send(k_pong);
    if (frame->opcode != k_binary || frame->content.empty()) continue;
    if (frame->content[0] == k_picture) ++pictures_;
    if (frame->content[0] == k_profile) ++profiles_;
  }
  return {};
}

}  // namespace biteline::soak
