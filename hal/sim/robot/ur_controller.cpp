// SPDX-License-Identifier: MIT
#include "hal/sim/robot/ur_controller.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "hal/sim/robot/blends.hpp"
#include "hal/sim/robot/primary_messages.hpp"
#include "hal/sim/robot/robot_api.hpp"

namespace biteline::sim {

namespace {

constexpr std::size_t k_longest_script_bytes = 8U << 20U;
constexpr std::size_t k_longest_line_bytes = 1000;
constexpr int k_polyscope_3 = 3, k_polyscope_x = 10;

/// A client that reads nothing for so long that this piles up is cut off.
constexpr std::size_t k_most_waiting_bytes = 4U << 20U;

/// States for a client that does not read are dropped beyond so much; scripts are still taken from it.
constexpr std::size_t k_most_unread_states = 64U << 10U;

class TakeInputs final : public rtde::ControllerListener {
 public:
  explicit TakeInputs(UrValues& values) : values_(values) {}
  void on_inputs(const rtde::Recipe& recipe, std::span<const rtde::Value> values) override {
    values_.take_inputs(recipe, values);
  }
  void on_text(const rtde::TextMessage&) override {}

 private:
  UrValues& values_;
};

/// The line that a script's error names.
int line_in(const std::string& error) {
  constexpr std::string_view k_before = "script line ";
  const std::size_t at = error.find(k_before);
  return at == std::string::npos ? 0 : std::atoi(error.c_str() + at + k_before.size());
}

void append(std::vector<std::uint8_t>& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// The first whole program in `bytes`: up to an `end` at the begin of a line.  Bare lines: one each.
std::optional<std::string> take_program(std::vector<std::uint8_t>& bytes) {
  const std::string text(bytes.begin(), bytes.end());
  std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return std::nullopt;
  const bool function = text.compare(begin, 4, "def ") == 0 || text.compare(begin, 4, "sec ") == 0;
  std::size_t end = text.find('\n', begin);
  int depth = 0;
  for (std::size_t first = begin; function && end != std::string::npos;) {
    std::string line = text.substr(first, end - first);
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.ends_with(':') && !line.starts_with("else") && !line.starts_with("elif")) ++depth;
    if (line == "end" && --depth <= 0) break;
    first = end + 1;
    end = text.find('\n', first);
  }
  if (end == std::string::npos) return std::nullopt;
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end + 1));
  return text.substr(begin, end + 1 - begin);
}

template <class Clients>
void drop_dead(Clients& clients) {
  std::erase_if(clients, [](const auto& client) {
    const bool done = client->closing && client->outgoing.empty();
    return done || client->outgoing.size() > k_most_waiting_bytes || !client->socket.is_open();
  });
}

}  // namespace

UrController::UrController(const Config& config, Arm& arm, OnCycle on_cycle)
    : config_(config),
      arm_(arm),
      on_cycle_(std::move(on_cycle)),
      values_(arm.kinematics()),
      program_watch_(arm, 1.0 / config.rate_hz),
      slider_wish_{config.speed_slider_ratio},
      pace_ratio_{config.speed_slider_ratio} {}

UrController::~UrController() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

Result<std::unique_ptr<UrController>> UrController::open(const Config& config, Arm& arm, OnCycle on_cycle) {
  std::unique_ptr<UrController> controller(new UrController(config, arm, std::move(on_cycle)));
  BITELINE_ASSIGN(controller->rtde_listener_, listen_on_loopback(config.rtde_port));
  BITELINE_ASSIGN(controller->script_listener_, listen_on_loopback(config.script_port));
  if (config.version[0] >= k_polyscope_x) {
    BITELINE_ASSIGN(controller->robot_api_listener_, listen_on_loopback(config.robot_api_port));
  } else {
    BITELINE_ASSIGN(controller->dashboard_listener_, listen_on_loopback(config.dashboard_port));
  }
  BITELINE_ASSIGN(controller->primary_listener_, listen_on_loopback(config.primary_port));
  // Whole microseconds: the pose bus stamps in them.
  controller->begin_ =
      SensorClock::time_point{Nanoseconds{hal::monotonic_now().time_since_epoch().count() / 1000 * 1000}};
  controller->thread_ = std::thread([raw = controller.get()] { raw->serve(); });
  return controller;
}

SensorClock::time_point UrController::instant_of(std::uint64_t cycle) const {
  return begin_ + Nanoseconds{static_cast<std::int64_t>(cycle) * (1'000'000'000 / config_.rate_hz)};
}

void UrController::serve() {
  std::uint64_t number = 0;
  while (!stopping_) {
    wait_until(instant_of(number));
    accept_clients();
    serve_rtde();
    serve_scripts();
    serve_dashboard();
    serve_robot_api();
    if (hal::monotonic_now() < instant_of(number)) continue;
    cycle(number);
    // A cycle that came too late is skipped, never caught up: its instant is gone.
    ++number;
    while (instant_of(number + 1) < hal::monotonic_now()) ++number;
  }
}

void UrController::wait_until(SensorClock::time_point instant) {
  std::vector<pollfd> waits;
  for (const auto* listener :
       {&rtde_listener_, &script_listener_, &dashboard_listener_, &robot_api_listener_, &primary_listener_})
    waits.push_back({listener->socket.number(), POLLIN, 0});
  for (const auto& client : rtde_clients_) waits.push_back({client->socket.number(), POLLIN, 0});
  for (const auto& client : script_clients_) waits.push_back({client->socket.number(), POLLIN, 0});
  for (const auto* clients : {&dashboard_clients_, &robot_api_clients_}) {
    for (const auto& client : *clients) waits.push_back({client->socket.number(), POLLIN, 0});
  }
  const std::int64_t left_ns = std::max<std::int64_t>(0, (instant - hal::monotonic_now()).count());
  const timespec timeout{.tv_sec = left_ns / 1'000'000'000, .tv_nsec = left_ns % 1'000'000'000};
  ppoll(waits.data(), waits.size(), &timeout, nullptr);
}

void UrController::set_arms_speed(SensorClock::time_point instant) {
  constexpr double k_ramp_per_s = 2;
  if (const double wish = slider_wish_.exchange(-1); wish >= 0) values_.set_speed_slider(wish);
  values_.set_speed_scaling(speed_scaling_);
  const double wanted = values_.speed_slider_ratio() * values_.speed_scaling();
  const double step = k_ramp_per_s / config_.rate_hz;
  pace_ratio_ = std::clamp(wanted, pace_ratio_ - step, pace_ratio_ + step);
  arm_.set_speed(pace_ratio_, instant);
}

void UrController::cycle(std::uint64_t number) {
  const auto instant = instant_of(number);
  set_arms_speed(instant);
  if (const std::string cut = program_watch_.step(instant, values_); !cut.empty()) {
    ++programs_cut_;
    for (const auto& client : rtde_clients_)
      client->session.send_text({.level = rtde::TextLevel::Warning, .text = cut, .source = "program"});
  }
  const ArmState state = arm_.at(instant);
  if (std::exchange(program_ran_, state.program_running) != state.program_running)
    tell(primary::program_runs(state.program_running, state.program_name, stamp_now()));
  const ArmReal real = arm_.real_at(instant);
  const Nanoseconds stamp = instant.time_since_epoch() + config_.clock_offset;
  if (protective_stop_ || !powered_) arm_.stop(instant);
  values_.set_powered(powered_);
  values_.set_protective_stop(protective_stop_);
  values_.set_digital_inputs(digital_inputs_);
  values_.advance(state, real, static_cast<double>(stamp.count()) * 1e-9);
  const std::uint64_t cycles_per_state = static_cast<std::uint64_t>(std::max(1, config_.rate_hz / 10));
  if (std::exchange(states_sent_, number / cycles_per_state) != number / cycles_per_state) {
    const std::vector<std::uint8_t> told = primary::state({.powered = powered_,
                                                           .protective_stop = protective_stop_,
                                                           .program_running = state.program_running,
                                                           .speed_slider_ratio = values_.speed_slider_ratio(),
                                                           .speed_scaling = values_.speed_scaling()},
                                                          stamp);
    for (const auto& client : script_clients_) {
      if (client->outgoing.size() < k_most_unread_states)
        client->outgoing.insert(client->outgoing.end(), told.begin(), told.end());
    }
  }
  for (const auto& client : rtde_clients_) {
    client->session.append_outputs(number, values_);
    pass_on(*client);
    if (!write_available(client->socket, client->outgoing)) client->socket.close();
  }
  drop_dead(rtde_clients_);
  if (!on_cycle_) return;
  ArmState told = state;
  told.q_rad = values_.q_rad();
  on_cycle_(instant, told, real);
}

void UrController::pass_on(RtdeClient& client) {
  auto& bytes = client.session.outgoing();
  client.outgoing.insert(client.outgoing.end(), bytes.begin(), bytes.end());
  bytes.clear();
}

void UrController::accept_clients() {
  if (hal::Descriptor socket = accept_from(rtde_listener_); socket.is_open()) {
    rtde_clients_.push_back(std::make_unique<RtdeClient>(
        rtde::ControllerSession::Config{.version = {.major = static_cast<std::uint32_t>(config_.version[0]),
                                                    .minor = static_cast<std::uint32_t>(config_.version[1]),
                                                    .bugfix = static_cast<std::uint32_t>(config_.version[2]),
                                                    .build = 0},
                                        .rate_hz = static_cast<double>(config_.rate_hz),
                                        .owners = input_owners_}));
    rtde_clients_.back()->socket = std::move(socket);
    rtde_clients_.back()->session.start();
  }
  for (const auto* listener : {&script_listener_, &primary_listener_}) {
    if (hal::Descriptor socket = accept_from(*listener); socket.is_open()) {
      script_clients_.push_back(std::make_unique<ScriptClient>());
      ScriptClient& client = *script_clients_.back();
      client.socket = std::move(socket);
      client.primary = listener == &primary_listener_;
      for (const auto& told :
           {primary::version(config_.version, stamp_now()), primary::kinematics(arm_.kinematics())})
        client.outgoing.insert(client.outgoing.end(), told.begin(), told.end());
    }
  }
  if (hal::Descriptor socket = accept_from(dashboard_listener_); socket.is_open()) {
    dashboard_clients_.push_back(std::make_unique<Client>());
    dashboard_clients_.back()->socket = std::move(socket);
    append(dashboard_clients_.back()->outgoing, "Connected: Universal Robots Dashboard Server\n");
  }
  if (hal::Descriptor socket = accept_from(robot_api_listener_); socket.is_open()) {
    robot_api_clients_.push_back(std::make_unique<Client>());
    robot_api_clients_.back()->socket = std::move(socket);
  }
}

void UrController::serve_rtde() {
  TakeInputs listener{values_};
  for (const auto& client : rtde_clients_) {
    bool alive = read_available(client->socket, client->incoming);
    alive = client->session.consume(client->incoming, listener).has_value() && alive;
    client->incoming.clear();
    pass_on(*client);
    if (!alive || !write_available(client->socket, client->outgoing)) client->socket.close();
  }
  drop_dead(rtde_clients_);
}

void UrController::serve_scripts() {
  const bool close_all = close_scripts_.exchange(false);
  for (const auto& client : script_clients_) {
    const bool alive = read_available(client->socket, client->incoming);
    // A program sent without its last line end is complete when the sender closes.
    if (!alive) client->incoming.push_back('\n');
    while (auto program = take_program(client->incoming)) run_script(*program);
    if (client->incoming.size() > k_longest_script_bytes) client->closing = true;
    if (!write_available(client->socket, client->outgoing) || !alive || close_all) client->socket.close();
  }
  drop_dead(script_clients_);
}

void UrController::run_script(const std::string& text) {
  if (protective_stop_ || !remote_control_ || !powered_) {
    // As a real one: nothing moves, and the script port says nothing.
    ++scripts_refused_;
    return;
  }
  auto script = parse_script(text);
  if (script) {
    for (const std::string& warning : skip_overlapping_blends(*script)) {
      ++moves_skipped_;
      tell(primary::warning(warning, stamp_now()));
    }
    ++scripts_run_;
    script->start_rad = values_.q_rad();
    arm_.run(*script, hal::monotonic_now());
    return;
  }
  ++scripts_refused_;
  const std::string error = to_line(script.error());
  tell(primary::runtime_exception(line_in(error), error, stamp_now()));
}

Nanoseconds UrController::stamp_now() const {
  return hal::monotonic_now().time_since_epoch() + config_.clock_offset;
}

void UrController::tell(const std::vector<std::uint8_t>& message) {
  for (const auto& client : script_clients_) {
    if (client->primary) client->outgoing.insert(client->outgoing.end(), message.begin(), message.end());
  }
}

void UrController::serve_dashboard() {
  for (const auto& client : dashboard_clients_) {
    const bool alive = read_available(client->socket, client->incoming);
    for (;;) {
      const auto line_end = std::find(client->incoming.begin(), client->incoming.end(), '\n');
      if (line_end == client->incoming.end()) break;
      std::string line(client->incoming.begin(), line_end);
      client->incoming.erase(client->incoming.begin(), line_end + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      append(client->outgoing, dashboard_answer(line, *client) + "\n");
    }
    if (client->incoming.size() > k_longest_line_bytes) client->closing = true;
    if (!write_available(client->socket, client->outgoing) || !alive) client->socket.close();
  }
  drop_dead(dashboard_clients_);
}

void UrController::serve_robot_api() {
  using robot_api::Order;
  for (const auto& client : robot_api_clients_) {
    const bool alive = read_available(client->socket, client->incoming);
    if (const auto request = robot_api::take_request(client->incoming); request && !client->closing) {
      const auto now = hal::monotonic_now();
      const robot_api::Answer answer =
          robot_api::answer_to(*request, {.version = config_.version,
                                          .remote = remote_control_,
                                          .powered = powered_,
                                          .protective_stop = protective_stop_,
                                          .program_running = arm_.at(now).program_running,
                                          .model = config_.model,
                                          .serial = config_.serial});
      if (answer.order == Order::Stop) arm_.stop(now);
      if (answer.order == Order::PowerOff || answer.order == Order::PowerOn)
        powered_ = answer.order == Order::PowerOn;
      if (answer.order == Order::UnlockProtectiveStop) protective_stop_ = false;
      append(client->outgoing, robot_api::http_text(answer));
      client->closing = true;
    }
    if (client->incoming.size() > k_most_unread_states) client->socket.close();
    if (!write_available(client->socket, client->outgoing) || !alive) client->socket.close();
  }
  drop_dead(robot_api_clients_);
}

std::string UrController::dashboard_answer(const std::string& line, Client& client) {
  const auto now = hal::monotonic_now();
  const ArmState state = arm_.at(now);
  if (line == "robotmode") return powered_ ? "Robotmode: RUNNING" : "Robotmode: POWER_OFF";
  if (line == "safetystatus" || line == "safetymode") {
    return (line == "safetymode" ? "Safetymode: " : "Safetystatus: ") +
           std::string(protective_stop_ ? "PROTECTIVE_STOP" : "NORMAL");
  }
  if (line == "unlock protective stop") {
    protective_stop_ = false;
    return "Protective stop releasing";
  }
  if (line == "running") return state.program_running ? "Program running: true" : "Program running: false";
  if (line == "programState" || line == "programstate") {
    return (state.program_running ? "PLAYING " : "STOPPED ") +
           (state.program_name.empty() ? "<unnamed>" : state.program_name);
  }
  if (line == "is in remote control" && config_.version[0] != k_polyscope_3)
    return remote_control_ ? "true" : "false";
  // Four numbers: some clients take nothing else.
  if (line == "PolyscopeVersion") {
    return "URSoftware " + std::to_string(config_.version[0]) + "." + std::to_string(config_.version[1]) +
           "." + std::to_string(config_.version[2]) + ".0 (simulated by Biteline)";
  }
  if (line == "get serial number") return config_.serial;
  if (line == "get robot model") return config_.model;
  if (line == "stop") {
    arm_.stop(now);
    return "Stopped";
  }
  if (line == "quit") {
    client.closing = true;
    return "Disconnected";
  }
  return "could not understand: '" + line + "'";
}

}  // namespace biteline::sim
