// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/ur_link.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/rtde/client_session.hpp"
#include "host/robot/link/ur/arm_claim.hpp"
#include "host/robot/link/ur/delivery.hpp"
#include "host/robot/link/ur/force_script.hpp"
#include "host/robot/link/ur/primary_messages.hpp"
#include "host/robot/link/ur/script.hpp"
#include "host/robot/link/ur/units.hpp"
#include "host/robot/path/force.hpp"

namespace biteline::robot::ur {
namespace {

constexpr Nanoseconds k_fresh{200'000'000};        // 25 states at 125 Hz
constexpr Nanoseconds k_poll{50'000'000};          // how soon the thread notices that it should end
constexpr Nanoseconds k_silent{1'000'000'000};     // a connection that says nothing for so long is lost
constexpr Nanoseconds k_handshake{5'000'000'000};  // a controller that boots answers late, not never
constexpr Nanoseconds k_retry{300'000'000};
constexpr Nanoseconds k_send_patience{2'000'000'000};
constexpr Nanoseconds k_remote_period{500'000'000};
constexpr Nanoseconds k_stop_patience{300'000'000};  // a controller in the same cell answers in some ms
constexpr Nanoseconds k_script_retry{100'000'000};
constexpr std::size_t k_most_recorded = 10 * 60 * 500;

/// In the order of variables().
enum Field : std::size_t {
  Timestamp,
  Joints,
  TcpPose,
  TcpOffset,
  RobotMode,
  SafetyMode,
  RuntimeStatus,
  SpeedScaling,
  SpeedSlider,
  DigitalOutputs,
  First  // of what is there only where it is asked for
};
/// From First on.
struct Asked {
  bool payload{false}, force{false};
  int flange_input{-1};
};
Asked asked_by(const UrLink::Config& config) {
  return {.payload = config.ask_payload, .force = config.ask_force, .flange_input = config.flange_input};
}
constexpr double k_full_volts = 10;  // of an analog input
std::vector<rtde::Variable> variables(const Asked& asked) {
  using enum rtde::FieldType;
  std::vector<rtde::Variable> all{{"timestamp", Double},
                                  {"actual_q", Vector6d},
                                  {"actual_TCP_pose", Vector6d},
                                  {"tcp_offset", Vector6d},
                                  {"robot_mode", Int32},
                                  {"safety_mode", Int32},
                                  {"runtime_state", Uint32},
                                  {"speed_scaling", Double},
                                  {"target_speed_fraction", Double},
                                  {"actual_digital_output_bits", Uint64}};
  if (asked.payload) all.insert(all.end(), {{"payload", Double}, {"payload_cog", Vector3d}});
  if (asked.force) {
    all.push_back({"actual_TCP_force", Vector6d});
    all.push_back({"output_int_register_" + std::to_string(k_force_register), Int32});
  }
  if (asked.flange_input >= 0)
    all.push_back({"standard_analog_input" + std::to_string(asked.flange_input), Double});
  return all;
}

// Universal Robots, RTDE guide, tables of robot_mode, safety_mode and runtime_state.
constexpr std::int32_t k_mode_running = 7;
constexpr std::int32_t k_safety_normal = 1;
constexpr std::int32_t k_safety_reduced = 2;
constexpr std::uint32_t k_runtime_stopped = 1;

HostClock::time_point now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

Nanoseconds from_seconds(double seconds) {
  return Nanoseconds{static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}

bool all_finite(const rtde::Vector6& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

/// Our units, or what is no number.  Pre: of the types of variables().
Result<RobotState> to_state(std::span<const rtde::Value> values, const Asked& asked) {
  const double stamp_s = std::get<double>(values[Timestamp]);
  const auto& joints = std::get<rtde::Vector6>(values[Joints]);
  const auto& pose = std::get<rtde::Vector6>(values[TcpPose]);
  const auto& offset = std::get<rtde::Vector6>(values[TcpOffset]);
  // 1e9 s: 30 years; beyond it nanoseconds overflow.
  if (!(std::abs(stamp_s) <= 1e9)) return fail(Errc::BadValue, "timestamp of %g s", stamp_s);
  if (!all_finite(joints)) return fail(Errc::BadValue, "actual_q without numbers");
  if (!all_finite(pose)) return fail(Errc::BadValue, "actual_TCP_pose without numbers");
  if (!all_finite(offset)) return fail(Errc::BadValue, "tcp_offset without numbers");
  RobotState state;
  state.sampled = RobotClock::time_point{from_seconds(stamp_s)};
  state.received = now();
  for (std::size_t i = 0; i < joints.size(); ++i) state.q_rad[static_cast<Eigen::Index>(i)] = joints[i];
  state.T_base_tcp = from_ur_pose(pose);
  state.T_flange_tcp = from_ur_pose(offset);
  state.powered = std::get<std::int32_t>(values[RobotMode]) == k_mode_running;
  const std::int32_t safety = std::get<std::int32_t>(values[SafetyMode]);
  state.safety = safety == k_safety_normal    ? Safety::Normal
                 : safety == k_safety_reduced ? Safety::Reduced
                                              : Safety::Stopped;
  state.program_running = std::get<std::uint32_t>(values[RuntimeStatus]) != k_runtime_stopped;
  // Two numbers of the controller: what its own limits leave, and the slider.  Each may be told alone as 1.
  const double speed = std::get<double>(values[SpeedScaling]) * std::get<double>(values[SpeedSlider]);
  state.speed_ratio = std::isfinite(speed) ? speed : 0;
  state.digital_outputs = std::get<std::uint64_t>(values[DigitalOutputs]);
  std::size_t next = First;
  if (asked.payload) {
    const double mass_kg = std::get<double>(values[next]);
    const auto& centre_m = std::get<rtde::Vector3>(values[next + 1]);
    next += 2;
    if (std::isfinite(mass_kg) && std::ranges::all_of(centre_m, [](double v) { return std::isfinite(v); }))
      state.payload = path::Payload{
          .mass_kg = mass_kg, .centre_flange_mm = k_mm_per_m * Vec3{centre_m[0], centre_m[1], centre_m[2]}};
  }
  if (asked.force) {
    const auto& force = std::get<rtde::Vector6>(values[next]);
    if (!all_finite(force)) return fail(Errc::BadValue, "actual_TCP_force without numbers");
    state.force_base_newton = Vec3{force[0], force[1], force[2]};
    state.force_word = std::get<std::int32_t>(values[next + 1]);
    next += 2;
  }
  if (asked.flange_input >= 0) {
    const double volts = std::get<double>(values[next]);
    if (!std::isfinite(volts)) return fail(Errc::BadValue, "standard_analog_input without a number");
    state.flange_ratio = volts / k_full_volts;
  }
  return state;
}

/// Switches the tool off and brakes with all joints.  URScript: set_standard_digital_out(), stopj() with
/// rad/s^2.
std::string stop_program(const ToolOutputs& outputs) {
  return "def biteline_stop():\n" + outputs_off(outputs) + "  stopj(2.0)\nend\n";
}

}  // namespace

/// Hands what the session hears to the link.
class UrLink::Reader final : public rtde::ClientListener {
 public:
  Reader(UrLink& link, const Asked& asked) : link_{link}, asked_{asked} {}
  void on_data(std::size_t, std::span<const rtde::Value> values) override {
    if (const Result<RobotState> state = to_state(values, asked_)) {
      link_.publish(*state);
    } else {
      link_.note_unusable(state.error());
    }
  }
  void on_text(const rtde::TextMessage& message) override {
    if (message.level == rtde::TextLevel::Info) return;
    const std::lock_guard lock{link_.mutex_};
    link_.status_.last_text = message.text;
  }

 private:
  UrLink& link_;
  Asked asked_;
};

Result<std::unique_ptr<UrLink>> UrLink::open(const Config& config) {
  std::unique_ptr<UrLink> link{new UrLink{config}};
  link->thread_ = std::thread{[raw = link.get()] { raw->run(); }};
  if (const Result<void> first = link->wait_for_first_state(); !first) {
    return fail(first.error().code, "%.60s:%u: no state%s%.150s", config.host.c_str(),
                static_cast<unsigned>(config.rtde_port), first.error().where.empty() ? "" : ": ",
                first.error().where.c_str());
  }
  return link;
}

Result<void> UrLink::wait_for_first_state() {
  std::unique_lock lock{mutex_};
  const auto hopeless = [this] { return refused_ || (fault_ && fault_->code == Errc::ConnectFailed); };
  changed_.wait_for(lock, from_seconds(config_.connect_patience_s),
                    [&] { return state_.sequence > 0 || hopeless(); });
  if (state_.sequence > 0) return {};
  if (hopeless()) return tl::unexpected<Error>{*fault_};
  if (unusable_) {
    return fail(unusable_->code, "%llu came, none of use, the last: %.120s",
                static_cast<unsigned long long>(status_.unusable_states), unusable_->where.c_str());
  }
  if (fault_) return tl::unexpected<Error>{*fault_};
  return fail(Errc::Timeout,
              running_ ? "%g s since the first call, hand-shake done, no data"
                       : "%g s since the first call, hand-shake not done",
              config_.connect_patience_s);
}

UrLink::~UrLink() {
  stopping_ = true;
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void UrLink::run() {
  rtde::ClientSession session{
      {.outputs = {{.variables = variables(asked_by(config_)), .frequency_hz = config_.rate_hz}},
       .inputs = {}}};
  while (!stopping_) {
    const Result<void> ended = serve_connection(session);
    note_session(session);
    if (!ended) note_disconnected(ended.error());
    std::unique_lock lock{mutex_};
    changed_.wait_for(lock, k_retry, [this] { return stopping_.load(); });
  }
}

Result<void> UrLink::serve_connection(rtde::ClientSession& session) {
  BITELINE_ASSIGN(TcpStream stream, TcpStream::connect({config_.host, config_.rtde_port},
                                                       from_seconds(config_.connect_patience_s)));
  session.start();
  Reader reader{*this, asked_by(config_)};
  std::vector<std::uint8_t> bytes;
  HostClock::time_point heard = now();
  while (!stopping_) {
    BITELINE_TRY(stream.write_all(session.outgoing(), k_send_patience));
    session.outgoing().clear();
    BITELINE_TRY(stream.read_some(bytes, k_poll));
    const std::uint64_t data_before = session.data_packages();
    const bool handshaking = !session.running();
    BITELINE_TRY(session.consume(bytes, reader));
    note_session(session);
    // Only data are a sign of life: texts and what nobody knows may come for ever.
    if (session.data_packages() > data_before || (handshaking && session.running())) heard = now();
    if (!session.running() && now() - heard > k_handshake)
      return fail(Errc::Timeout, "%.60s: hand-shake not done", config_.host.c_str());
    if (session.running() && now() - heard > k_silent)
      return fail(Errc::ConnectionLost, "%.60s: silent", config_.host.c_str());
  }
  return {};
}

void UrLink::publish(RobotState state) {
  {
    const std::lock_guard lock{mutex_};
    state.age_s = age_.take(state);
    state.sequence = state_.sequence + 1;
    ++status_.states;
    if (!std::exchange(status_.connected, true)) ++status_.connections;
    state_ = state;
    if (recording_ && recorded_.size() < k_most_recorded) recorded_.push_back(state);
  }
  changed_.notify_all();
}

void UrLink::note_unusable(const Error& why) {
  const std::lock_guard lock{mutex_};
  ++status_.unusable_states;
  unusable_ = why;
}

void UrLink::note_session(const rtde::ClientSession& session) {
  const std::lock_guard lock{mutex_};
  running_ = session.running();
  refused_ = session.refused();
  status_.unreadable_texts = session.skipped().unreadable_texts;
  status_.unknown_packages = session.skipped().unknown_packages;
}

void UrLink::note_disconnected(const Error& error) {
  {
    const std::lock_guard lock{mutex_};
    status_.connected = false;
    fault_ = error;
    status_.last_error = to_line(error);
  }
  changed_.notify_all();
}

Result<RobotState> UrLink::latest() const {
  const std::lock_guard lock{mutex_};
  if (!status_.connected) return fail(Errc::ConnectionLost, "robot %.60s", config_.host.c_str());
  if (now() - state_.received > k_fresh) return fail(Errc::PoseStale, "robot %.60s", config_.host.c_str());
  return state_;
}

Result<RobotState> UrLink::wait_newer(std::uint64_t sequence, Nanoseconds patience) const {
  std::unique_lock lock{mutex_};
  const bool newer =
      changed_.wait_for(lock, patience, [&] { return state_.sequence > sequence || stopping_; });
  if (newer && !stopping_) return state_;
  return fail(status_.connected ? Errc::Timeout : Errc::ConnectionLost, "robot %.60s: no new state",
              config_.host.c_str());
}

Result<void> UrLink::send(const PermittedPath& permitted) {
  BITELINE_ASSIGN(const RobotState state, latest());
  if (state.safety == Safety::Stopped) return fail(Errc::InterlockOpen, "robot: its safety system holds it");
  if (!state.powered) return fail(Errc::PeerRefused, "robot: not powered or brakes on");
  if (state.program_running) return fail(Errc::PeerRefused, "robot: another program runs");
  if (!permitted.holds_for(state.q_rad)) return fail(Errc::Refused, "robot: it has moved since the gate");
  if (path::presses(permitted.path().path()) && !config_.ask_force)
    return fail(Errc::NotSupported, "robot: this link does not read the tool's force: no path that presses");
  begun_ = dead_man_ = false;
  stops_ = 0;
  BITELINE_ASSIGN(const std::optional<int> beat_register, dead_mans_register());
  {
    const std::lock_guard lock{mutex_};
    status_.last_text.clear();
    status_.program_error.clear();
    status_.stop_door_closed_s = 0;
  }
  // Without it the arm could not be stopped: before the path, and kept open, so that a stop is one word.
  BITELINE_ASSIGN(door_, ControllerDoor::open(places(), from_seconds(config_.connect_patience_s)));
  BITELINE_ASSIGN(script_, TcpStream::connect({config_.host, config_.script_port},
                                              from_seconds(config_.connect_patience_s)));
  if (const Endpoint found = script_.numeric_peer(); found.port != 0) script_at_ = found;
  script_heard_.clear();
  script_lived_ = now();
  outputs_ = outputs_of(permitted.path().path());
  asked_ = false;
  asked_at_ = {};
  remote_.forget();
  const std::string program = urscript(permitted.path(), beat_register);
  // The last look: from here on the watch over the arm heeds a stop.
  if (permitted.mark().stopped()) return fail(Errc::Refused, "robot: stopped before the path was sent");
  dead_man_ = beat_register.has_value();
  begun_ = true;
  return script_.write_all(program, k_send_patience);
}

Result<std::optional<int>> UrLink::dead_mans_register() const {
  if (config_.claim == nullptr || config_.claim->state() == ArmClaim::State::Lacking)
    return std::optional<int>{};
  const std::optional<int> held = config_.claim->beat_register();
  if (!held) return fail(Errc::ConnectionLost, "robot: it cannot be told that the run is watched");
  // Before its program looks for the first time.
  config_.claim->beat();
  return held;
}

/// Both at once. The output stays on when a program is stopped by a word: a program of its own switches it
/// off, and replaces whatever still runs should the word not have arrived.
Result<void> UrLink::stop() {
  Delivery words[]{door_->stop_word(), {script_, script_at_, stop_program(outputs_)}};
  // What the first ones came to is not known: their connections may be dead without a word.
  if (std::exchange(stops_, stops_ + 1) > 0) {
    for (Delivery& word : words) word.use_fresh();
  }
  asked_ = false;
  remote_.forget();
  return deliver(words, k_stop_patience);
}

void UrLink::beat() {
  hear_script();
  keep_script_open();
  if (config_.claim != nullptr) config_.claim->beat();
}

/// Why a program does not run, or no more, is said nowhere else.
void UrLink::hear_script() {
  static_cast<void>(script_.take_now(script_heard_));
  const Result<std::vector<ControllerSaid>> said = take_said(script_heard_);
  if (!said) {
    // Another protocol: its bytes say nothing, and the connection serves as before.
    script_heard_.clear();
    return;
  }
  for (const ControllerSaid& one : *said) {
    using About = ControllerSaid::About;
    if (one.about != About::ProgramError && one.about != About::Fault) continue;
    const std::lock_guard lock{mutex_};
    status_.last_text = one.text;
    if (one.about == About::ProgramError) status_.program_error = one.text;
  }
}

/// A controller that closes it, as one does that goes to local control, is to be known before a stop is.
void UrLink::keep_script_open() {
  const HostClock::time_point time = now();
  if (script_.is_open() && script_.numeric_peer().port != 0) script_lived_ = time;
  if (!script_.is_open() && time - script_tried_ >= k_script_retry) {
    script_tried_ = time;
    script_heard_.clear();
    if (Result<TcpStream> again = TcpStream::begin(script_at_)) script_ = std::move(*again);
  }
  const std::lock_guard lock{mutex_};
  status_.stop_door_closed_s = std::chrono::duration<double>{time - script_lived_}.count();
}

DoorPlaces UrLink::places() const {
  return {.dashboard = {config_.host, config_.dashboard_port},
          .robot_api = {config_.host, config_.robot_api_port},
          .script = {config_.host, config_.script_port}};
}

std::optional<bool> UrLink::remote_control() {
  const HostClock::time_point time = now();
  if (!asked_) {
    if (time - asked_at_ < k_remote_period) return remote_.told();
    asked_at_ = time;
    asked_ = door_->ask_remote().has_value();
    return remote_.told();
  }
  const Result<std::string> answer = door_->hear_remote(Nanoseconds{0});
  if (!answer && answer.error().code == Errc::Timeout) return remote_.told();
  asked_ = false;
  if (!remote_.hear(answer.value_or(""))) asked_at_ = {};
  return remote_.told();
}

void UrLink::start_recording() {
  const std::lock_guard lock{mutex_};
  recording_ = true;
  recorded_.clear();
}

std::vector<RobotState> UrLink::take_recording() {
  const std::lock_guard lock{mutex_};
  recording_ = false;
  return std::exchange(recorded_, {});
}

LinkStatus UrLink::status() const {
  const std::lock_guard lock{mutex_};
  return status_;
}

}  // namespace biteline::robot::ur
