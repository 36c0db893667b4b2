// SPDX-License-Identifier: MIT
#include "host/robot/link/other/arm_link.hpp"

#include <cmath>
#include <random>
#include <utility>

#include "host/robot/link/other/path_points.hpp"

namespace biteline::robot::other {
namespace {

constexpr Nanoseconds k_fresh{200'000'000};
constexpr Nanoseconds k_poll{50'000'000};       // how soon the thread notices that it should end
constexpr Nanoseconds k_silent{1'000'000'000};  // a connection that says nothing for so long is lost
constexpr Nanoseconds k_retry{300'000'000};
constexpr Nanoseconds k_send_patience{2'000'000'000};
constexpr Nanoseconds k_sum_patience{5'000'000'000};  // a controller that adds up slowly
constexpr Nanoseconds k_beat_patience{20'000'000};    // a turn of the watch
constexpr Nanoseconds k_stop_patience{300'000'000};
constexpr std::size_t k_most_recorded = 10 * 60 * 500;

HostClock::time_point now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

Nanoseconds from_seconds(double seconds) {
  return Nanoseconds{static_cast<std::int64_t>(std::llround(seconds * 1e9))};
}

/// A connection that ends is made anew; the host before this one may not be gone yet.
bool is_passing(Errc code) {
  return code == Errc::ConnectionLost || code == Errc::PeerRefused;
}

bool is_away(Errc code) {
  return code == Errc::ConnectionLost || code == Errc::ConnectFailed || code == Errc::Timeout;
}

/// Why a connection is none of ours.
Result<void> may_serve(const arm_link::Received& received) {
  if (const auto* refusal = std::get_if<arm_link::Refusal>(&received.body);
      refusal != nullptr && refusal->of == 0)
    return fail(Errc::PeerRefused, "%s", arm_link::name_of(refusal->reason));
  const auto* robot = std::get_if<arm_link::Robot>(&received.body);
  if (robot != nullptr && robot->joints != arm_link::k_joints)
    return fail(Errc::NotSupported, "%.24s %.24s: %u joints, six expected", robot->make.c_str(),
                robot->model.c_str(), robot->joints);
  return {};
}

RobotState to_state(const arm_link::State& told) {
  RobotState state;
  state.sampled = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(told.stamp_us) * 1000}};
  state.received = now();
  state.q_rad = told.q_rad;
  state.T_base_tcp = told.T_base_tcp;
  state.T_flange_tcp = told.T_flange_tcp;
  state.powered = told.powered;
  state.program_running = told.phase == arm_link::Phase::Running;
  state.safety = told.safe ? Safety::Normal : Safety::Stopped;
  state.speed_ratio = told.speed_ratio;
  state.digital_outputs = told.outputs;
  return state;
}

}  // namespace

Result<std::unique_ptr<ArmLink>> ArmLink::open(const Config& config) {
  std::unique_ptr<ArmLink> link{new ArmLink{config}};
  // Names of paths that no other service has given lately.
  link->paths_ = std::random_device{}();
  link->thread_ = std::thread{[raw = link.get()] { raw->run(); }};
  std::unique_lock lock{link->mutex_};
  const auto may_come = [&] { return !link->fault_ || is_passing(link->fault_->code); };
  link->changed_.wait_for(lock, from_seconds(config.connect_patience_s),
                          [&] { return link->state_.sequence > 0 || !may_come(); });
  if (link->state_.sequence > 0) return link;
  const Errc code = link->fault_ ? link->fault_->code : Errc::Timeout;
  const std::string why = link->fault_ ? to_line(*link->fault_) : "";
  lock.unlock();
  if (config.may_be_away && is_away(code)) return link;
  return fail(code, "%.60s:%u: no state%s%.150s", config.host.c_str(), static_cast<unsigned>(config.port),
              why.empty() ? "" : ": ", why.c_str());
}

ArmLink::~ArmLink() {
  stopping_ = true;
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void ArmLink::run() {
  while (!stopping_) {
    if (const Result<void> ended = serve_connection(); !ended) note_disconnected(ended.error());
    std::unique_lock lock{mutex_};
    stream_.reset();
    changed_.wait_for(lock, k_retry, [this] { return stopping_.load(); });
  }
}

Result<void> ArmLink::serve_connection() {
  BITELINE_ASSIGN(ur::TcpStream opened, ur::TcpStream::connect({config_.host, config_.port},
                                                               from_seconds(config_.connect_patience_s)));
  const auto stream = std::make_shared<ur::TcpStream>(std::move(opened));
  note_connection(stream);
  BITELINE_TRY(say(arm_link::Hello{}, k_send_patience));
  arm_link::Reader reader;
  std::vector<std::uint8_t> bytes;
  HostClock::time_point heard = now();
  while (!stopping_) {
    BITELINE_TRY(stream->read_some(bytes, k_poll));
    if (is_given_up(stream)) return fail(Errc::ConnectionLost, "%.60s: sending", config_.host.c_str());
    reader.add(bytes);
    while (true) {
      BITELINE_ASSIGN(const std::optional<arm_link::Received> received, reader.next());
      if (!received) break;
      BITELINE_TRY(may_serve(*received));
      hear(*received);
      if (std::holds_alternative<arm_link::State>(received->body) && robot()) heard = now();
    }
    if (now() - heard > k_silent)
      return fail(Errc::ConnectionLost, "%.60s: %s", config_.host.c_str(),
                  robot() ? "silent" : "it does not say which robot it is; is another host connected?");
  }
  return {};
}

void ArmLink::hear(const arm_link::Received& received) {
  if (const auto* state = std::get_if<arm_link::State>(&received.body)) return publish(*state);
  {
    const std::lock_guard lock{mutex_};
    if (const auto* robot = std::get_if<arm_link::Robot>(&received.body)) {
      robot_ = *robot;
    } else if (const auto* sum = std::get_if<arm_link::PathSum>(&received.body)) {
      sum_ = *sum;
    } else if (const auto* refusal = std::get_if<arm_link::Refusal>(&received.body)) {
      refusal_ = *refusal;
      status_.last_text = arm_link::name_of(refusal->reason);
      // Nothing runs that was refused: no wait for what will not begin.
      if (begun_) status_.program_error = std::string{"refused: "} + arm_link::name_of(refusal->reason);
    } else {
      ++status_.unknown_packages;
    }
  }
  changed_.notify_all();
}

void ArmLink::publish(const arm_link::State& told) {
  {
    const std::lock_guard lock{mutex_};
    if (!robot_) return;
    RobotState state = to_state(told);
    state.age_s = age_.take(state);
    state.sequence = state_.sequence + 1;
    ++status_.states;
    if (!std::exchange(status_.connected, true)) ++status_.connections;
    if (told.fault != arm_link::Fault::None) status_.last_text = arm_link::name_of(told.fault);
    state_ = state;
    if (recording_ && recorded_.size() < k_most_recorded) recorded_.push_back(state);
  }
  changed_.notify_all();
}

void ArmLink::note_connection(Stream stream) {
  const std::scoped_lock lock{say_mutex_, mutex_};
  said_ = 0;
  robot_.reset();
  stream_ = std::move(stream);
}

void ArmLink::note_disconnected(const Error& error) {
  {
    const std::lock_guard lock{mutex_};
    status_.connected = false;
    robot_.reset();
    fault_ = error;
    status_.last_error = to_line(error);
  }
  changed_.notify_all();
}

Result<void> ArmLink::say(const arm_link::Body& body, Nanoseconds patience) {
  const std::lock_guard one_by_one{say_mutex_};
  return say_bytes(arm_link::encode(++said_, body), patience);
}

bool ArmLink::is_given_up(const Stream& stream) const {
  const std::lock_guard lock{mutex_};
  return stream_ != stream;
}

Result<void> ArmLink::say_bytes(std::span<const std::uint8_t> bytes, Nanoseconds patience) {
  Stream stream;
  {
    const std::lock_guard lock{mutex_};
    stream = stream_;
  }
  if (!stream) return fail(Errc::ConnectionLost, "robot %.60s", config_.host.c_str());
  const Result<void> written = stream->write_all(bytes, patience);
  if (written) return {};
  // Half a message may have left: the reading thread closes it and calls again.
  const std::lock_guard lock{mutex_};
  if (stream_ == stream) stream_.reset();
  return written;
}

Result<std::uint32_t> ArmLink::upload(const path::CheckedPath& path, std::uint32_t name) {
  const PathPoints points = path_points(path, name);
  if (points.points.size() > arm_link::k_most_points)
    return fail(Errc::Refused, "robot: %zu points, %u at most", points.points.size(),
                arm_link::k_most_points);
  arm_link::Sum sum;
  const std::lock_guard one_by_one{say_mutex_};
  const auto put = [&](const arm_link::Body& body, bool counts) -> Result<void> {
    const arm_link::Message message = arm_link::encode(++said_, body);
    if (counts) sum.add(arm_link::body_bytes(message));
    return say_bytes(message, k_send_patience);
  };
  BITELINE_TRY(put(points.begin, true));
  for (const arm_link::PathPoint& point : points.points) BITELINE_TRY(put(point, true));
  BITELINE_TRY(put(arm_link::PathEnd{name}, false));
  return sum.value();
}

Result<arm_link::PathSum> ArmLink::wait_for_sum(std::uint32_t name) const {
  std::unique_lock lock{mutex_};
  changed_.wait_for(lock, k_sum_patience,
                    [&] { return (sum_ && sum_->path == name) || refusal_ || !stream_ || stopping_; });
  if (refusal_) return fail(Errc::PeerRefused, "robot: %s", arm_link::name_of(refusal_->reason));
  if (sum_ && sum_->path == name) return *sum_;
  return fail(stream_ ? Errc::Timeout : Errc::ConnectionLost, "robot: the path's sum did not come back");
}

Result<void> ArmLink::may_send(const PermittedPath& permitted) const {
  if (permitted.path().path().flow)
    return fail(Errc::NotSupported, "robot: the generic protocol does not carry the process's flow");
  if (permitted.path().path().force)
    return fail(Errc::NotSupported, "robot: the generic protocol does not carry the process's force");
  BITELINE_ASSIGN(const RobotState state, latest());
  if (state.safety == Safety::Stopped) return fail(Errc::InterlockOpen, "robot: its safety system holds it");
  if (!state.powered) return fail(Errc::PeerRefused, "robot: not powered or brakes on");
  if (state.program_running) return fail(Errc::PeerRefused, "robot: another program runs");
  if (!permitted.holds_for(state.q_rad)) return fail(Errc::Refused, "robot: it has moved since the gate");
  return {};
}

Result<void> ArmLink::send(const PermittedPath& permitted) {
  BITELINE_TRY(may_send(permitted));
  begun_ = false;
  {
    const std::lock_guard lock{mutex_};
    sum_.reset();
    refusal_.reset();
    status_.last_text.clear();
    status_.program_error.clear();
  }
  const std::uint32_t name = ++paths_ == 0 ? ++paths_ : paths_;
  BITELINE_ASSIGN(const std::uint32_t sum, upload(permitted.path(), name));
  BITELINE_ASSIGN(const arm_link::PathSum told, wait_for_sum(name));
  if (told.sum != sum) return fail(Errc::CheckFailed, "robot: the path did not arrive as it was sent");
  BITELINE_TRY(may_send(permitted));
  beat();
  // The last look: from here on the watch over the arm heeds a stop.
  if (permitted.mark().stopped()) return fail(Errc::Refused, "robot: stopped before the path was sent");
  begun_ = true;
  return say(arm_link::Go{.path = name, .sum = sum}, k_send_patience);
}

/// A controller that has lost the connection has stopped by itself; the word goes out all the same, as soon
/// as there is one.
Result<void> ArmLink::stop() {
  {
    std::unique_lock lock{mutex_};
    changed_.wait_for(lock, k_stop_patience, [this] { return stream_ != nullptr || stopping_; });
  }
  return say(arm_link::Stop{}, k_stop_patience);
}

void ArmLink::beat() {
  // What cannot be said is a connection that is gone: the watch sees no new state.
  static_cast<void>(say(arm_link::Beat{}, k_beat_patience));
}

std::optional<arm_link::Robot> ArmLink::robot() const {
  const std::lock_guard lock{mutex_};
  return robot_;
}

Result<RobotState> ArmLink::latest() const {
  const std::lock_guard lock{mutex_};
  if (!status_.connected) return fail(Errc::ConnectionLost, "robot %.60s", config_.host.c_str());
  if (now() - state_.received > k_fresh) return fail(Errc::PoseStale, "robot %.60s", config_.host.c_str());
  return state_;
}

Result<RobotState> ArmLink::wait_newer(std::uint64_t sequence, Nanoseconds patience) const {
  std::unique_lock lock{mutex_};
  const bool newer =
      changed_.wait_for(lock, patience, [&] { return state_.sequence > sequence || stopping_; });
  if (newer && !stopping_) return state_;
  return fail(status_.connected ? Errc::Timeout : Errc::ConnectionLost, "robot %.60s: no new state",
              config_.host.c_str());
}

void ArmLink::start_recording() {
  const std::lock_guard lock{mutex_};
  recording_ = true;
  recorded_.clear();
}

std::vector<RobotState> ArmLink::take_recording() {
  const std::lock_guard lock{mutex_};
  recording_ = false;
  return std::exchange(recorded_, {});
}

LinkStatus ArmLink::status() const {
  const std::lock_guard lock{mutex_};
  return status_;
}

}  // namespace biteline::robot::other
