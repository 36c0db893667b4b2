// SPDX-License-Identifier: MIT
#include "hal/linux/arm_link_poses/arm_link_pose_source.hpp"

#include <arpa/inet.h>
#include <poll.h>

#include <algorithm>

namespace biteline::hal {
namespace {

/// 127 years: as nanoseconds twice that fit, and so any difference to our clock.
constexpr std::uint64_t k_latest_us = 4'000'000'000'000'000;

std::uint32_t status_of(const arm_link::State& state) {
  std::uint32_t status = 0;
  if (state.phase == arm_link::Phase::Running) status |= k_pose_program_running;
  if (!state.safe) status |= k_pose_protective_stop;
  return status;
}

ToldPose told_pose(std::uint32_t number, const arm_link::State& state) {
  return {.stamp = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(state.stamp_us) * 1000}},
          .number = number,
          .T_base_flange = state.T_base_tcp * state.T_flange_tcp.inverse(Eigen::Isometry),
          .status = status_of(state)};
}

}  // namespace

Result<std::unique_ptr<ArmLinkPoseSource>> ArmLinkPoseSource::open(const Config& config) {
  in_addr controller{};
  if (::inet_pton(AF_INET, config.controller.address.c_str(), &controller) != 1)
    return fail(Errc::BadValue, "%.60s is no IPv4 address", config.controller.address.c_str());
  return std::unique_ptr<ArmLinkPoseSource>{new ArmLinkPoseSource{config}};
}

Result<void> ArmLinkPoseSource::start() {
  if (published_.state() != PoseState::Idle) return fail(Errc::WrongState, "arm link poses are started");
  last_fault_.reset();
  retry_at_ = monotonic_now();
  published_.set(PoseState::Connecting);
  return {};
}

Result<void> ArmLinkPoseSource::stop() {
  stream_.reset();
  published_.set(PoseState::Idle);
  return {};
}

Result<RobotPose> ArmLinkPoseSource::next_pose(Nanoseconds timeout) {
  if (published_.state() == PoseState::Idle) return fail(Errc::WrongState, "arm link poses are not started");
  const SensorClock::time_point deadline = monotonic_now() + timeout;
  bool looked = false;  // a timeout of 0 still reads what is there
  while (true) {
    Result<std::optional<RobotPose>> pose = take_arrived();
    if (!pose) give_up(pose.error());
    publish_counts();
    if (pose && *pose) return **std::move(pose);
    const SensorClock::time_point now = monotonic_now();
    note_silence(now);
    if (now >= deadline && looked) break;
    if (const Result<void> advanced = advance(deadline); !advanced) give_up(advanced.error());
    looked = true;
  }
  if (!last_fault_) return fail(Errc::Timeout, "no state of the controller");
  return fail(Errc::Timeout, "%.180s: %s", last_fault_->where.c_str(), error_row(last_fault_->code).message);
}

Result<std::optional<RobotPose>> ArmLinkPoseSource::take_arrived() {
  while (stream_) {
    Result<std::optional<arm_link::Received>> received = reader_.next();
    if (!received) {
      ++unreadable_;
      return tl::unexpected<Error>{received.error()};
    }
    if (!*received) break;
    BITELINE_ASSIGN(const std::optional<RobotPose> pose, take(**received));
    if (pose) return std::optional{*pose};
  }
  return std::optional<RobotPose>{};
}

Result<std::optional<RobotPose>> ArmLinkPoseSource::take(const arm_link::Received& received) {
  const auto* state = std::get_if<arm_link::State>(&received.body);
  if (state == nullptr || state->stamp_us > k_latest_us) {
    ++unreadable_;
    const auto* refusal = std::get_if<arm_link::Refusal>(&received.body);
    if (refusal != nullptr) return fail(Errc::PeerRefused, "%s", arm_link::name_of(refusal->reason));
    return fail(Errc::ProtocolError, "kind %d: states with a time expected at the port of poses",
                int{arm_link::kind_of(received.body)});
  }
  last_state_at_ = received_at_;
  const std::optional<RobotPose> pose = told_.accept(told_pose(received.number, *state), received_at_);
  if (!pose) {
    last_fault_ = fail(Errc::BadValue, "poses of the controller do not go on in time").value();
    return pose;
  }
  if (published_.state() == PoseState::Lost) published_.add_reconnect();
  published_.set(PoseState::Streaming);
  last_pose_at_ = received_at_;
  last_fault_.reset();
  return pose;
}

Result<void> ArmLinkPoseSource::advance(SensorClock::time_point until) {
  const SensorClock::time_point now = monotonic_now();
  if (!stream_) {
    if (now < retry_at_) {
      wait_for(-1, 0, std::min(until, retry_at_) - now);
      return {};
    }
    BITELINE_ASSIGN(stream_, TcpStream::connect(config_.controller));
    reader_ = {};
    last_state_at_ = now;
  }
  const SensorClock::time_point patience = last_state_at_ + config_.reconnect_after;
  if (now >= patience) return fail(Errc::Timeout, "%.60s tells no state", config_.controller.address.c_str());
  BITELINE_ASSIGN(const bool connected, stream_->connected());
  wait_for(stream_->number(), connected ? POLLIN : POLLOUT, std::min(until, patience) - now);
  if (!connected) return {};
  BITELINE_ASSIGN(const std::span<const std::uint8_t> bytes, stream_->receive(buffer_));
  received_at_ = monotonic_now();
  reader_.add(bytes);
  return {};
}

void ArmLinkPoseSource::give_up(const Error& fault) {
  last_fault_ = fault;
  stream_.reset();
  retry_at_ = monotonic_now() + config_.retry_after;
  if (published_.state() == PoseState::Streaming) published_.set(PoseState::Lost);
  told_.note_silence();
}

void ArmLinkPoseSource::note_silence(SensorClock::time_point now) {
  if (published_.state() != PoseState::Streaming || now < last_pose_at_ + config_.lost_after) return;
  published_.set(PoseState::Lost);
  told_.note_silence();
}

void ArmLinkPoseSource::publish_counts() {
  published_.publish(told_.poses(), told_.lost(), told_.rejected() + unreadable_,
                     clock_health(told_.clock_health()));
}

}  // namespace biteline::hal
