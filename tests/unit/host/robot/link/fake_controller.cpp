// SPDX-License-Identifier: MIT
#include "tests/unit/host/robot/link/fake_controller.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "common/rtde/controller_session.hpp"

namespace biteline::robot::test {
namespace {

constexpr double k_beat_s = 0.002;

int listen_somewhere(std::uint16_t& port) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address);
  listen(listener, 4);
  socklen_t size = sizeof address;
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  port = ntohs(address.sin_port);
  return listener;
}

struct Values : rtde::ValueSource {
  rtde::Value value_of(std::string_view name) const override {
    if (name == "timestamp") return now.time_s;
    if (name == "robot_mode") return now.robot_mode;
    if (name == "safety_mode") return now.safety_mode;
    if (name == "runtime_state") return now.runtime_state;
    if (name == "speed_scaling") return now.speed_scaling;
    if (name == "target_speed_fraction") return now.speed_slider;
    if (name == "actual_TCP_pose") return now.tcp_pose;
    if (name == "actual_q") return now.q;
    if (name == "tcp_offset") return now.tcp_offset;
    if (name == "actual_digital_output_bits") return now.outputs;
    if (name == "actual_digital_input_bits") return now.inputs;
    return rtde::zero_of(*rtde::output_type(name));
  }
  PlayedState now;
};

struct Deaf : rtde::ControllerListener {
  void on_inputs(const rtde::Recipe&, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}
};

/// false: the other side has closed.
bool read_into(std::string& text, int client) {
  char buffer[4096];
  ssize_t got = 0;
  while ((got = recv(client, buffer, sizeof buffer, MSG_DONTWAIT)) > 0)
    text.append(buffer, static_cast<std::size_t>(got));
  return got < 0;
}

}  // namespace

FakeController::FakeController(Play play, double cycle_s) : play_{std::move(play)}, cycle_s_{cycle_s} {
  rtde_listener_ = listen_somewhere(rtde_port_);
  script_listener_ = listen_somewhere(script_port_);
  dashboard_listener_ = listen_somewhere(dashboard_port_);
  thread_ = std::thread{[this] { serve(); }};
}

FakeController::~FakeController() {
  stopping_ = true;
  thread_.join();
  for (const int listener : {rtde_listener_, script_listener_, dashboard_listener_}) {
    if (listener >= 0) close(listener);
  }
}

std::string FakeController::script() const {
  const std::lock_guard lock{mutex_};
  return script_;
}
std::string FakeController::dashboard() const {
  const std::lock_guard lock{mutex_};
  return dashboard_;
}
FakeController::Times FakeController::times() const {
  const std::lock_guard lock{mutex_};
  return times_;
}

void FakeController::say_on_script(std::vector<std::uint8_t> bytes) {
  const std::lock_guard lock{mutex_};
  to_say_ = std::move(bytes);
}

void FakeController::read_script(int client) {
  const std::lock_guard lock{mutex_};
  read_into(script_, client);
  const std::size_t stop = script_.find("def biteline_stop():");
  if (stop == std::string::npos || !script_.ends_with("\nend\n")) return;
  times_.stop_programs = 0;
  for (std::size_t at = stop; at != std::string::npos; at = script_.find("def biteline_stop():", at + 1))
    ++times_.stop_programs;
  if (!times_.stop) times_.stop = Clock::now();
  if (!times_.output_off && script_.find("set_standard_digital_out(0, False)", stop) != std::string::npos)
    times_.output_off = Clock::now();
}

bool FakeController::read_dashboard(Asker& asker) {
  const std::lock_guard lock{mutex_};
  if (refuse_dashboard) return true;
  const bool there = read_into(asker.heard, asker.client);
  for (std::size_t end = asker.heard.find('\n'); end != std::string::npos; end = asker.heard.find('\n')) {
    const std::string command = asker.heard.substr(0, end);
    asker.heard.erase(0, end + 1);
    dashboard_ += command + "\n";
    if (command == "stop" && !times_.stop) times_.stop = Clock::now();
    if (command == "stop") ++times_.stop_words;
    if (!mute_dashboard) answer(asker.client, command);
  }
  return there;
}

void FakeController::answer(int client, const std::string& command) {
  const auto known = answers.find(command);
  std::string text = known == answers.end() ? "Stopped" : known->second;
  if (command == "is in remote control" && (!remote_ || local_control || noes > 0)) {
    --noes;
    text = "false";
  }
  text += "\n";
  static_cast<void>(send(client, text.data(), text.size(), MSG_NOSIGNAL));
}

void FakeController::serve() {
  struct Client {
    int socket;
    std::unique_ptr<rtde::ControllerSession> session;
  };
  std::vector<Client> clients;
  const auto owners = std::make_shared<rtde::InputOwners>();
  int script = -1;
  std::vector<Asker> askers;
  Values values;
  double time_s = 10, turned_rad = 0, script_at_s = -1;
  Deaf deaf;
  Clock::time_point cycle_began = Clock::now();
  const auto replace = [](int& client, int listener) {
    if (client >= 0) close(client);
    client = accept(listener, nullptr, nullptr);
  };
  for (std::uint64_t cycle = 0; !stopping_; ++cycle) {
    pollfd entries[]{
        {rtde_listener_, POLLIN, 0}, {script_listener_, POLLIN, 0}, {dashboard_listener_, POLLIN, 0}};
    poll(entries, 3, 2);  // the cycle's beat
    const Clock::time_point cycle_begins = Clock::now();
    const double real_s =
        std::chrono::duration<double>(cycle_begins - std::exchange(cycle_began, cycle_begins)).count();
    if ((entries[0].revents & POLLIN) != 0) {
      clients.push_back({.socket = accept(rtde_listener_, nullptr, nullptr),
                         .session = std::make_unique<rtde::ControllerSession>(
                             rtde::ControllerSession::Config{.owners = owners})});
      clients.back().session->start();
      ++rtde_connections;
    }
    if (close_script.exchange(false) && script >= 0) {
      read_script(script);
      close(std::exchange(script, -1));
    }
    if (shut_script && script_listener_ >= 0) {
      close(std::exchange(script_listener_, -1));
      if (script >= 0) close(std::exchange(script, -1));
    }
    if (script_listener_ >= 0 && (entries[1].revents & POLLIN) != 0) {
      replace(script, script_listener_);
      ++script_connections;
    }
    if (script >= 0) {
      const std::lock_guard lock{mutex_};
      if (!to_say_.empty()) static_cast<void>(send(script, to_say_.data(), to_say_.size(), MSG_NOSIGNAL));
      to_say_.clear();
    }
    if (stream_script && script >= 0) {
      static constexpr char k_state[1100] = {};
      static_cast<void>(send(script, k_state, sizeof k_state, MSG_NOSIGNAL | MSG_DONTWAIT));
    }
    if ((entries[2].revents & POLLIN) != 0)
      askers.push_back({.client = accept(dashboard_listener_, nullptr, nullptr), .heard = {}});
    const bool dropped = drop.exchange(false);
    std::erase_if(clients, [&](Client& client) {
      std::string text;
      const bool there = !dropped && read_into(text, client.socket);
      static_cast<void>(
          client.session->consume({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, deaf));
      if (!there) close(client.socket);
      return !there;
    });
    if (!clients.empty()) {
      // Never slower than this machine's clock, unless a test asks for that: its states would look old.
      time_s += cycle_s_ < k_beat_s ? cycle_s_ : std::max(cycle_s_, real_s);
      if (turning) turned_rad += 0.01;
      values.now = {.time_s = time_s,
                    .q = {turned_rad, 0, 0, 0, 0, 0},
                    .robot_mode = robot_mode,
                    .safety_mode = safety_mode,
                    .runtime_state = runtime_state,
                    .inputs = digital_inputs,
                    .send = !silent};
      if (not_a_number) values.now.tcp_pose[0] = std::numeric_limits<double>::quiet_NaN();
      {
        const std::lock_guard lock{mutex_};
        if (script_at_s < 0 && script_.ends_with("\nend\n")) script_at_s = time_s;
        values.now.stopped = times_.stop.has_value();
        values.now.stop_programs = times_.stop_programs;
      }
      if (script_at_s >= 0) values.now.since_script_s = time_s - script_at_s;
      if (play_) play_(values.now);
      remote_ = values.now.remote;
      if (values.now.rests) {
        const std::lock_guard lock{mutex_};
        if (!times_.rest) times_.rest = Clock::now();
      }
      if (values.now.lie) {
        const std::lock_guard lock{mutex_};
        if (!times_.lie) times_.lie = Clock::now();
      }
      for (const Client& client : clients) {
        if (values.now.send) client.session->append_outputs(cycle, values);
        const auto& out = client.session->outgoing();
        static_cast<void>(send(client.socket, out.data(), out.size(), MSG_NOSIGNAL));
        client.session->outgoing().clear();
      }
    }
    if (script >= 0) read_script(script);
    std::erase_if(askers, [this](Asker& asker) {
      const bool there = read_dashboard(asker);
      if (!there) close(asker.client);
      return !there;
    });
  }
  for (const Client& client : clients) close(client.socket);
  for (const Asker& asker : askers) close(asker.client);
  if (script >= 0) close(script);
}

}  // namespace biteline::robot::test
