// SPDX-License-Identifier: MIT
#include "tests/unit/host/robot/link/fake_controller.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <limits>

#include "common/rtde/controller_session.hpp"

namespace biteline::robot::test {
namespace {

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
  explicit Values(const FakeController& controller) : of{controller} {}
  rtde::Value value_of(std::string_view name) const override {
    if (name == "timestamp") return time_s;
    if (name == "robot_mode") return of.robot_mode.load();
    if (name == "safety_mode") return of.safety_mode.load();
    if (name == "runtime_state") return of.runtime_state.load();
    if (name == "speed_scaling") return 1.0;
    if (name == "actual_TCP_pose") {
      const double x = of.not_a_number ? std::numeric_limits<double>::quiet_NaN() : 0.5;
      return rtde::Vector6{x, -0.25, 0.125, 0, 3.0, 0};
    }
    if (name == "actual_q") return rtde::Vector6{turned_rad, 0, 0, 0, 0, 0};
    if (name == "tcp_offset") return rtde::Vector6{0, 0, 0.15, 0, 0, 0};
    return rtde::zero_of(*rtde::output_type(name));
  }
  const FakeController& of;
  double time_s{10}, turned_rad{0};
};

struct Deaf : rtde::ControllerListener {
  void on_inputs(const rtde::Recipe&, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}
};

void read_into(std::string& text, int client) {
  char buffer[4096];
  for (ssize_t got = recv(client, buffer, sizeof buffer, MSG_DONTWAIT); got > 0;
       got = recv(client, buffer, sizeof buffer, MSG_DONTWAIT)) {
    text.append(buffer, static_cast<std::size_t>(got));
  }
}

}  // namespace

FakeController::FakeController() {
  rtde_listener_ = listen_somewhere(rtde_port_);
  script_listener_ = listen_somewhere(script_port_);
  dashboard_listener_ = listen_somewhere(dashboard_port_);
  thread_ = std::thread{[this] { serve(); }};
}

FakeController::~FakeController() {
  stopping_ = true;
  thread_.join();
  for (const int listener : {rtde_listener_, script_listener_, dashboard_listener_}) close(listener);
}

std::string FakeController::script() const {
  const std::lock_guard lock{mutex_};
  return script_;
}
std::string FakeController::dashboard() const {
  const std::lock_guard lock{mutex_};
  return dashboard_;
}

void FakeController::serve() {
  int rtde = -1, script = -1, dashboard = -1;
  rtde::ControllerSession session{{}};
  Values values{*this};
  Deaf deaf;
  const auto replace = [](int& client, int listener) {
    if (client >= 0) close(client);
    client = accept(listener, nullptr, nullptr);
  };
  for (std::uint64_t cycle = 0; !stopping_; ++cycle) {
    pollfd entries[]{
        {rtde_listener_, POLLIN, 0}, {script_listener_, POLLIN, 0}, {dashboard_listener_, POLLIN, 0}};
    poll(entries, 3, 2);  // the cycle's beat
    if ((entries[0].revents & POLLIN) != 0) {
      // The probe that tries whether anybody is there closes at once; the last one to come counts.
      replace(rtde, rtde_listener_);
      ++rtde_connections;
      session.start();
    }
    if ((entries[1].revents & POLLIN) != 0) replace(script, script_listener_);
    if ((entries[2].revents & POLLIN) != 0) replace(dashboard, dashboard_listener_);
    if (rtde >= 0 && drop.exchange(false)) {
      close(rtde);
      rtde = -1;
    }
    if (rtde >= 0) {
      std::string text;
      read_into(text, rtde);
      static_cast<void>(
          session.consume({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, deaf));
      values.time_s += 0.002;
      if (turning) values.turned_rad += 0.01;
      if (!silent) session.append_outputs(cycle, values);
      const auto& out = session.outgoing();
      static_cast<void>(send(rtde, out.data(), out.size(), MSG_NOSIGNAL));
      session.outgoing().clear();
    }
    const std::lock_guard lock{mutex_};
    if (script >= 0) read_into(script_, script);
    if (dashboard >= 0) {
      const std::size_t before = dashboard_.size();
      read_into(dashboard_, dashboard);
      if (dashboard_.size() > before) static_cast<void>(send(dashboard, "Stopped\n", 8, MSG_NOSIGNAL));
    }
  }
  for (const int client : {rtde, script, dashboard}) {
    if (client >= 0) close(client);
  }
}

}  // namespace biteline::robot::test
