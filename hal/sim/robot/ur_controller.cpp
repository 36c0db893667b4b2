// SPDX-License-Identifier: MIT
#include "hal/sim/robot/ur_controller.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "hal/sim/robot/primary_messages.hpp"

namespace biteline::sim {

namespace {

constexpr std::size_t k_longest_script_bytes = 8U << 20U;
constexpr std::size_t k_longest_line_bytes = 1000;
constexpr int k_polyscope_3 = 3, k_polyscope_x = 10;

/// A client that reads nothing for so long that this piles up is cut off.
constexpr std::size_t k_most_waiting_bytes = 4U << 20U;

constexpr std::size_t k_longest_request_bytes = 1U << 20U;

/// Universal Robots, "Error codes": the primary interface is read-only; a protective stop.
constexpr std::int32_t k_read_only_code = 210, k_protective_stop_code = 191;

class TakeInputs final : public rtde::ControllerListener {
 public:
  TakeInputs(UrValues& values, Arm& arm) : values_(values), arm_(arm) {}
  void on_inputs(const rtde::Recipe& recipe, std::span<const rtde::Value> values) override {
    for (const OutputStep& set : values_.take_inputs(recipe, values))
      arm_.set_output(set, hal::monotonic_now());
  }
  void on_text(const rtde::TextMessage&) override {}

 private:
  UrValues& values_;
  Arm& arm_;
};

void append(std::vector<std::uint8_t>& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
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
      runner_(arm, 1.0 / config.rate_hz),
      force_(config.force, config.flange ? Touch{} : config.touch),
      turret_{config.turret ? std::optional<ToolTurret>{*config.turret} : std::nullopt},
      flange_{config.flange ? std::optional<ContactFlange>{std::in_place, *config.flange, config.touch}
                            : std::nullopt},
      slider_wish_{config.speed_slider_ratio},
      pace_ratio_{config.speed_slider_ratio} {
  runner_.set_beside(
      {.tcp_force =
           [this] {
             const Vec3& f = force_.told_newton();
             return ScriptPose{f.x(), f.y(), f.z(), 0, 0, 0};
           },
       .act = [this](std::string_view function,
                     std::span<const ScriptValue> arguments) { return act(function, arguments); },
       .program_ended = [this] { force_.end(); },
       .digital_in = [this](int number) { return (inputs_now() >> static_cast<unsigned>(number) & 1U) != 0; },
       .analog_in = [this](int number) { return flange_ ? flange_->volts(number) : 0.0; }});
}

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

ArmState UrController::arm_state(SensorClock::time_point instant) const {
  ArmState state = arm_.at(instant);
  if (const std::string* code = runner_.code_name(); code != nullptr) {
    state.moving = state.program_running = true;
    state.paused = runner_.is_paused();
    state.program_name = *code;
  }
  return state;
}

void UrController::watch_safety(SensorClock::time_point instant) {
  using primary::Level, primary::SafetyMode;
  const bool stopped = protective_stop_;
  if (stopped != std::exchange(was_stopped_, stopped)) {
    stopped_since_ = instant;
    tell(primary::safety_mode(stopped ? SafetyMode::ProtectiveStop : SafetyMode::Normal, stamp_now()));
    if (stopped) tell(primary::error(k_protective_stop_code, Level::Warning, "Protective stop", stamp_now()));
    for (const auto& client : script_clients_) client->state_due = true;
  }
  if (stopped || power_.mode(instant) != RobotMode::Running) runner_.stop(instant);
}

void UrController::take(const ProgramNews& news) {
  using Kind = ProgramNews::Kind;
  switch (news.kind) {
    case Kind::Started:
    case Kind::Ended:
      return tell(primary::program_runs(news.kind == Kind::Started, news.text, stamp_now()));
    case Kind::Text:
      return tell(primary::text(news.text, stamp_now()));
    case Kind::Warning:
      ++moves_skipped_;
      return tell(primary::error(0, primary::Level::Warning, news.text, stamp_now()));
    case Kind::Popup:
    case Kind::BlockingPopup:
      dashboard_memory_.popup = news.text;
      waits_for_popup_ = news.kind == Kind::BlockingPopup;
      if (waits_for_popup_) pause(true);
      return;
    case Kind::ProtectiveStop:
    case Kind::OutOfReach:
      protective_stop_ = true;
      return;
    case Kind::Fault:
      return tell(primary::runtime_exception(0, 0, news.text, stamp_now()));
  }
}

void UrController::run_program(SensorClock::time_point instant) {
  const std::string cut = runner_.step(instant, values_, values_.q_rad());
  for (const ProgramNews& news : runner_.take_news()) take(news);
  if (cut.empty()) return;
  ++programs_cut_;
  for (const auto& client : rtde_clients_)
    client->session.send_text({.level = rtde::TextLevel::Warning, .text = cut, .source = "program"});
}

bool UrController::act(std::string_view function, std::span<const ScriptValue> arguments) {
  if (function != "write_output_integer_register") return force_.act(function, arguments);
  const auto* number = std::get_if<double>(arguments.data());
  const auto* value = std::get_if<double>(&arguments[1]);
  if (number == nullptr || value == nullptr) return false;
  values_.set_output_register(static_cast<int>(*number), static_cast<int>(*value));
  return true;
}

void UrController::step_force(SensorClock::time_point instant) {
  const ArmState state = arm_.at(instant);
  SE3 T_base_tcp = state.T_base_flange * state.T_flange_tcp;
  // A program that has ended leaves the arm where force mode had brought it.
  if (!state.program_running) force_.stand();
  T_base_tcp.translation() -= force_.off_base_mm();
  force_.step(T_base_tcp, 1.0 / config_.rate_hz);
  if (state.program_running) arm_.set_off(force_.off_base_mm(), instant);
  values_.set_tcp_force(force_.told_newton());
  if (!flange_) return;
  flange_->step(T_base_tcp, state.outputs, state.analog_ratio, 1.0 / config_.rate_hz);
  values_.set_analog_inputs({flange_->volts(0), flange_->volts(1)});
}

void UrController::send_states(std::uint64_t number, const ArmState& state) {
  const std::uint64_t cycles_per_state = static_cast<std::uint64_t>(std::max(1, config_.rate_hz / 10));
  const bool due = std::exchange(states_sent_, number / cycles_per_state) != number / cycles_per_state;
  const std::vector<std::uint8_t> told = primary::state({.mode = power_.mode(instant_of(number)),
                                                         .protective_stop = protective_stop_,
                                                         .program_running = state.program_running,
                                                         .program_paused = state.paused,
                                                         .speed_slider_ratio = values_.speed_slider_ratio(),
                                                         .speed_scaling = values_.speed_scaling()},
                                                        stamp_now());
  for (const auto& client : script_clients_) {
    client->state_due = client->state_due || due;
    // What waits to be read is older: the newest comes behind it, and none between.
    if (!client->state_due || !client->outgoing.empty()) continue;
    client->outgoing = told;
    client->state_due = false;
  }
}

std::uint64_t UrController::inputs_now() const {
  const bool ready = flange_ && flange_->ready();
  const std::uint64_t flange =
      ready ? std::uint64_t{1} << static_cast<unsigned>(flange_->facts().ready_input) : 0;
  return digital_inputs_ | turret_inputs_ | flange;
}

void UrController::cycle(std::uint64_t number) {
  const auto instant = instant_of(number);
  set_arms_speed(instant);
  run_program(instant);
  step_force(instant);
  const ArmState state = arm_state(instant);
  const ArmReal real = arm_.real_at(instant);
  const Nanoseconds stamp = instant.time_since_epoch() + config_.clock_offset;
  watch_safety(instant);
  values_.set_mode(power_.mode(instant));
  values_.set_protective_stop(protective_stop_);
  if (turret_)
    turret_inputs_ =
        turret_->step(1e-9 * static_cast<double>(instant.time_since_epoch().count()), state.outputs);
  values_.set_digital_inputs(inputs_now());
  values_.advance(state, real, static_cast<double>(stamp.count()) * 1e-9);
  send_states(number, state);
  for (const auto& client : rtde_clients_) {
    // As above: who reads slowly gets the newest values, and not all.
    if (client->outgoing.empty()) client->session.append_outputs(number, values_);
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
           {primary::version(config_.version, stamp_now()), primary::kinematics(arm_.kinematics()),
            primary::configuration(arm_.kinematics(), config_.model, config_.version[0] == k_polyscope_3)})
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
  TakeInputs listener{values_, arm_};
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
    while (auto program = take_program(client->incoming)) take_program_text(*program);
    if (client->incoming.size() > k_longest_script_bytes) client->closing = true;
    if (!write_available(client->socket, client->outgoing) || !alive || close_all) client->socket.close();
  }
  drop_dead(script_clients_);
}

bool UrController::takes_programs() const {
  return !protective_stop_ && !is_local() && power_.mode(hal::monotonic_now()) == RobotMode::Running;
}

void UrController::take_program_text(const std::string& text) {
  const auto now = hal::monotonic_now();
  const PortOrder order = port_order(text);
  if (order == PortOrder::None) {
    plays_loaded_ = false;
    return run_script(text);
  }
  if (is_local()) return;
  if (order == PortOrder::PowerOn) power_.switch_on(now);
  if (order == PortOrder::PowerOff) power_.switch_off();
  if (order == PortOrder::ReleaseBrakes) power_.release_brakes(now);
  if (order == PortOrder::Unlock) protective_stop_ = false;
  if (order == PortOrder::Stop) stop_program();
}

void UrController::run_script(const std::string& text) {
  if (!takes_programs()) {
    // As a real one: nothing moves, and the script port says nothing.
    ++scripts_refused_;
    if (is_local())
      tell(primary::error(k_read_only_code, primary::Level::Violation, "not in remote control", stamp_now()));
    return;
  }
  auto program = parse_program(text);
  if (!program) {
    ++scripts_refused_;
    const ProgramFault fault = fault_of(program.error(), text);
    return tell(primary::runtime_exception(fault.line, fault.column, fault.text, stamp_now()));
  }
  ++scripts_run_;
  runner_.run(std::move(*program), values_.q_rad(), hal::monotonic_now());
}

void UrController::run_loaded(const std::string& name) {
  const auto program = config_.programs.find(name);
  if (program == config_.programs.end()) return;
  plays_loaded_ = true;
  run_script(program->second);
}

void UrController::pause(bool on) {
  runner_.set_paused(on, hal::monotonic_now());
}

void UrController::stop_program() {
  runner_.stop(hal::monotonic_now());
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
      const ArmState state = arm_state(now);
      const char* const program = state.paused ? "PAUSED" : state.program_running ? "PLAYING" : "STOPPED";
      const robot_api::Answer answer = robot_api::answer_to(*request,
                                                            {.version = config_.version,
                                                             .remote = says_remote(),
                                                             .protective_stop = protective_stop_,
                                                             .mode = power_.mode(now),
                                                             .program = program,
                                                             .model = config_.model,
                                                             .serial = config_.serial},
                                                            config_.programs, robot_api_memory_);
      if (answer.order == Order::Stop || answer.order == Order::Load) stop_program();
      if (answer.order == Order::Pause) pause(true);
      if (answer.order == Order::Play && state.paused) pause(false);
      if (answer.order == Order::Play && !state.paused) run_loaded(robot_api_memory_.loaded);
      if (answer.order == Order::PowerOff) power_.switch_off();
      if (answer.order == Order::PowerOn) power_.switch_on(now);
      if (answer.order == Order::ReleaseBrakes) power_.release_brakes(now);
      if (answer.order == Order::Unlock) protective_stop_ = false;
      append(client->outgoing, robot_api::http_text(answer));
      client->closing = true;
    }
    if (client->incoming.size() > k_longest_request_bytes) client->socket.close();
    if (!write_available(client->socket, client->outgoing) || !alive) client->socket.close();
  }
  drop_dead(robot_api_clients_);
}

std::string UrController::dashboard_answer(const std::string& line, Client& client) {
  using dashboard::Order, dashboard::ProgramState;
  const auto now = hal::monotonic_now();
  const ArmState state = arm_state(now);
  const dashboard::Answer answer = dashboard::answer_to(
      line,
      {.version = config_.version,
       .mode = power_.mode(now),
       .remote = says_remote(),
       .takes_programs = !is_local(),
       .protective_stop = protective_stop_,
       // One that no cycle has seen yet is as new as can be.
       .just_stopped = !was_stopped_ || now < stopped_since_ + config_.unlocks_after,
       .program = state.paused            ? ProgramState::Paused
                  : state.program_running ? ProgramState::Playing
                                          : ProgramState::Stopped,
       .program_name = plays_loaded_ ? dashboard::file_of(dashboard_memory_.loaded) : state.program_name,
       .model = config_.model,
       .serial = config_.serial},
      config_.programs, dashboard_memory_);
  if (answer.order == Order::Stop || answer.order == Order::Load) stop_program();
  if (answer.order == Order::Pause) pause(true);
  if (answer.order == Order::Play && state.paused) pause(false);
  if (answer.order == Order::Play && !state.paused) run_loaded(dashboard::file_of(dashboard_memory_.loaded));
  if (answer.order == Order::ClosePopup && std::exchange(waits_for_popup_, false)) pause(false);
  if (answer.order == Order::PowerOff) power_.switch_off();
  if (answer.order == Order::PowerOn) power_.switch_on(now);
  if (answer.order == Order::ReleaseBrakes) power_.release_brakes(now);
  if (answer.order == Order::Unlock) protective_stop_ = false;
  if (answer.order == Order::Quit) client.closing = true;
  return answer.text;
}

}  // namespace biteline::sim
