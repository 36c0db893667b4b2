// SPDX-License-Identifier: MIT
#include "hal/sim/robot/path_taker.hpp"

#include <poll.h>

#include <algorithm>

namespace biteline::sim {
namespace {

using arm_link::Fault;
using arm_link::PathPoint;
using arm_link::Phase;
using arm_link::Reason;

/// A host that reads nothing for so long is cut off.
constexpr std::size_t k_most_waiting_bytes = 1U << 20U;
constexpr int k_most_output = 7;
/// Who says nothing for so long is no host: a listener at the wrong port keeps no host away.
constexpr Nanoseconds k_first_word{1'000'000'000};

}  // namespace

Result<std::unique_ptr<PathTaker>> PathTaker::open(const Config& config, Arm& arm) {
  std::unique_ptr<PathTaker> taker{new PathTaker{config, arm}};
  BITELINE_ASSIGN(taker->listener_, listen_on_loopback(config.port));
  BITELINE_ASSIGN(taker->teller_, StateTeller::open(config.pose_port));
  taker->thread_ = std::thread{[raw = taker.get()] { raw->serve(); }};
  return taker;
}

PathTaker::~PathTaker() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void PathTaker::serve() {
  const Nanoseconds cycle{1'000'000'000 / config_.rate_hz};
  SensorClock::time_point due = hal::monotonic_now();
  while (!stopping_) {
    const std::int64_t left_ns = std::max<std::int64_t>(0, (due - hal::monotonic_now()).count());
    const timespec wait{.tv_sec = 0, .tv_nsec = left_ns};
    pollfd watched[]{{listener_.socket.number(), POLLIN, 0}, {host_.number(), POLLIN, 0}};
    ppoll(watched, host_.is_open() ? 2 : 1, &wait, nullptr);
    const SensorClock::time_point now = hal::monotonic_now();
    accept_host(now);
    hear(now);
    watch(now);
    if (now < due) continue;
    // A cycle that came too late is skipped, never caught up.
    while (due <= now) due += cycle;
    const arm_link::State state = state_at(now);
    teller_->tell(state);
    if (host_.is_open()) say(state);
    if (host_.is_open() && (!write_available(host_, outgoing_) || outgoing_.size() > k_most_waiting_bytes))
      lose_host(now);
  }
}

void PathTaker::accept_host(SensorClock::time_point now) {
  hal::Descriptor caller = accept_from(listener_);
  if (!caller.is_open()) return;
  if (host_.is_open()) {
    const arm_link::Message no = arm_link::encode(1, arm_link::Refusal{.of = 0, .reason = Reason::Busy});
    std::vector<std::uint8_t> bytes{no.begin(), no.end()};
    static_cast<void>(write_available(caller, bytes));
    return;
  }
  host_ = std::move(caller);
  reader_ = {};
  outgoing_.clear();
  said_ = 0;
  heard_ = false;
  beat_at_ = now;
}

void PathTaker::lose_host(SensorClock::time_point now) {
  host_.close();
  if (phase_ == Phase::Running) halt(Fault::PeerGone, now);
  if (phase_ != Phase::Stopped) phase_ = Phase::Idle;
}

void PathTaker::hear(SensorClock::time_point now) {
  if (!host_.is_open()) return;
  std::vector<std::uint8_t> bytes;
  const bool lives = read_available(host_, bytes);
  reader_.add(bytes);
  while (true) {
    const Result<std::optional<arm_link::Received>> received = reader_.next();
    // Of a stream that is spoilt nothing is believed any more.
    if (!received) return lose_host(now);
    if (!*received) break;
    const Reason reason = take(**received, reader_.last(), now);
    if (reason == Reason::None) continue;
    ++messages_refused_;
    say(arm_link::Refusal{.of = arm_link::kind_of((*received)->body), .reason = reason});
    if (phase_ == Phase::Loading) phase_ = Phase::Idle;
  }
  if (!lives) lose_host(now);
}

Reason PathTaker::take(const arm_link::Received& received, const arm_link::Message& message,
                       SensorClock::time_point now) {
  heard_ = true;
  beat_at_ = now;  // whatever it says, it lives
  if (const auto* begin = std::get_if<arm_link::PathBegin>(&received.body))
    return take_begin(*begin, message);
  if (const auto* point = std::get_if<PathPoint>(&received.body)) return take_point(*point, message);
  if (const auto* end = std::get_if<arm_link::PathEnd>(&received.body)) return take_end(*end, now);
  if (const auto* ready = std::get_if<arm_link::Go>(&received.body)) return go(*ready, now);
  if (std::holds_alternative<arm_link::Stop>(received.body)) {
    halt(Fault::Host, now);
  } else if (std::holds_alternative<arm_link::Hello>(received.body)) {
    say(config_.robot);
  } else if (!std::holds_alternative<arm_link::Beat>(received.body)) {
    return Reason::Order;
  }
  return Reason::None;
}

Reason PathTaker::take_begin(const arm_link::PathBegin& begin, const arm_link::Message& message) {
  if (phase_ == Phase::Running) return Reason::Busy;
  if (begin.points == 0 || begin.points > arm_link::k_most_points || begin.output > k_most_output)
    return Reason::Points;
  path_ = begin;
  points_.clear();
  sum_ = {};
  sum_.add(arm_link::body_bytes(message));
  fault_ = Fault::None;
  phase_ = Phase::Loading;
  return Reason::None;
}

Reason PathTaker::take_point(const PathPoint& point, const arm_link::Message& message) {
  if (phase_ != Phase::Loading) return Reason::Order;
  if (point.path != path_.path) return Reason::WrongPath;
  if (point.index != points_.size() || point.index >= path_.points) return Reason::Points;
  sum_.add(arm_link::body_bytes(message));
  points_.push_back(point);
  return Reason::None;
}

Reason PathTaker::take_end(const arm_link::PathEnd& end, SensorClock::time_point now) {
  if (phase_ != Phase::Loading) return Reason::Order;
  if (end.path != path_.path) return Reason::WrongPath;
  if (points_.size() != path_.points) return Reason::Points;
  phase_ = Phase::Ready;
  whole_at_ = now;
  say(arm_link::PathSum{
      .path = path_.path, .points = path_.points, .sum = sum_.value() ^ (config_.spoils_paths ? 1U : 0U)});
  return Reason::None;
}

Reason PathTaker::go(const arm_link::Go& go, SensorClock::time_point now) {
  if (phase_ == Phase::Running) return Reason::Busy;
  if (phase_ != Phase::Ready) return Reason::Order;
  if (go.path != path_.path || go.sum != sum_.value()) return Reason::WrongPath;
  // Whatever comes of it: a path is gone to once.
  phase_ = Phase::Idle;
  if (now - whole_at_ > config_.path_age_max) return Reason::Stale;
  if (!safe_ || !powered_) return Reason::NotReady;
  arm_.run(script(), now);
  nearest_ = 0;
  phase_ = Phase::Running;
  ++paths_run_;
  return Reason::None;
}

void PathTaker::halt(Fault fault, SensorClock::time_point now) {
  arm_.stop(now);
  if (path_.output >= 0) arm_.set_output(DigitalOutStep{path_.output, false}, now);
  if (phase_ == Phase::Running) fault_ = fault;
  phase_ = Phase::Stopped;
}

void PathTaker::watch(SensorClock::time_point now) {
  if (host_.is_open() && !heard_ && now - beat_at_ > k_first_word) lose_host(now);
  if (phase_ != Phase::Running) return;
  if (!safe_ || !powered_) return halt(Fault::Safety, now);
  if (now - beat_at_ > arm_link::k_dead_man) return halt(Fault::DeadMan, now);
  if (!arm_.at(now).program_running) phase_ = Phase::Idle;
}

Script PathTaker::script() const {
  Script script{.name = "arm_link", .steps = {}};
  script.steps.emplace_back(SetTcpStep{path_.T_flange_tcp});
  if (path_.mass_kg > 0) script.steps.emplace_back(Payload{path_.mass_kg, path_.centre_flange_mm});
  bool on = false;
  const auto switch_to = [&](bool wanted) {
    if (path_.output >= 0) script.steps.emplace_back(DigitalOutStep{path_.output, wanted});
    on = wanted;
  };
  switch_to(false);  // whatever was left on, the arm does not travel with it
  for (const PathPoint& point : points_) {
    if (point.tool_on != on) switch_to(point.tool_on);
    MoveStep move;
    move.speed = point.speed;
    move.acceleration = point.acceleration;
    move.blend_mm = point.blend_mm;
    if (point.move == PathPoint::Move::Joint) {
      move.kind = MoveStep::Kind::Joint;
      move.q_rad = point.q_rad;
    } else {
      move.T_base_tcp = point.T_base_tcp;
    }
    script.steps.emplace_back(move);
  }
  if (on) switch_to(false);
  return script;
}

arm_link::State PathTaker::state_at(SensorClock::time_point now) {
  const ArmState target = arm_.at(now);
  const ArmReal real = arm_.real_at(now);
  const SE3 T_base_tcp = real.T_base_flange_told * target.T_flange_tcp;
  const Vec3 tip = T_base_tcp.translation();
  const auto away_mm = [&](std::size_t i) { return (points_[i].T_base_tcp.translation() - tip).norm(); };
  while (phase_ == Phase::Running && nearest_ + 1 < points_.size() &&
         away_mm(nearest_ + 1) < away_mm(nearest_))
    ++nearest_;
  arm_link::State state{
      .stamp_us = static_cast<std::uint64_t>((now.time_since_epoch() + config_.clock_offset).count() / 1000),
      .T_base_tcp = T_base_tcp,
      .T_flange_tcp = target.T_flange_tcp,
      .phase = phase_,
      .powered = powered_,
      .safe = safe_,
      .outputs = static_cast<std::uint8_t>(target.outputs),
      .path = phase_ == Phase::Idle ? 0 : path_.path,
      .index = static_cast<std::uint16_t>(nearest_),
      .fault = fault_,
      .speed_ratio = 1};
  const std::optional<JointVector> followed =
      real.q_told_rad ? real.q_told_rad
      : q_rad_        ? arm_.kinematics().joints_near(real.T_base_flange_told, *q_rad_)
                      : arm_.kinematics().joints_anywhere(real.T_base_flange_told);
  if (followed) q_rad_ = followed;
  if (q_rad_) state.q_rad = *q_rad_;
  return state;
}

void PathTaker::say(const arm_link::Body& body) {
  const arm_link::Message message = arm_link::encode(++said_, body);
  outgoing_.insert(outgoing_.end(), message.begin(), message.end());
}

}  // namespace biteline::sim
