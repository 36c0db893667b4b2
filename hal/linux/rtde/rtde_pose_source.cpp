// SPDX-License-Identifier: MIT
#include "hal/linux/rtde/rtde_pose_source.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

namespace biteline::hal {

RtdePoseSource::RtdePoseSource(const Config& config)
    : config_{config},
      samples_{config.samples},
      session_{rtde::ClientSession::Config{.outputs = {RtdeSamples::recipe(config.samples.rate_hz)},
                                           .inputs = {}}} {}

Result<std::unique_ptr<RtdePoseSource>> RtdePoseSource::open(const Config& config) {
  if (!(config.samples.rate_hz > 0 && config.samples.rate_hz <= 1000)) {
    return fail(Errc::BadValue, "RTDE rate %g Hz", config.samples.rate_hz);
  }
  return std::unique_ptr<RtdePoseSource>{new RtdePoseSource{config}};
}

Result<void> RtdePoseSource::start() {
  if (published_.state() != PoseState::Idle) return fail(Errc::WrongState, "RTDE pose source is started");
  published_.set(PoseState::Connecting);
  retry_at_ = monotonic_now();
  return {};
}

Result<void> RtdePoseSource::stop() {
  stream_.reset();
  published_.set(PoseState::Idle);
  return {};
}

Result<RobotPose> RtdePoseSource::next_pose(Nanoseconds timeout) {
  if (published_.state() == PoseState::Idle) return fail(Errc::WrongState, "RTDE pose source is not started");
  const SensorClock::time_point deadline = monotonic_now() + timeout;
  bool looked = false;  // a timeout of 0 still reads what is there
  while (true) {
    if (std::optional<RobotPose> sample = samples_.take()) {
      if (std::exchange(made_anew_, false)) published_.add_reconnect();
      published_.set(PoseState::Streaming);
      last_fault_.reset();
      publish_counts();
      return *std::move(sample);
    }
    if (monotonic_now() >= deadline && looked) {
      if (!last_fault_) return fail(Errc::Timeout, "RTDE pose");
      return fail(Errc::Timeout, "RTDE pose: %.180s: %s", last_fault_->where.c_str(),
                  error_row(last_fault_->code).message);
    }
    if (const Result<void> advanced = advance(deadline); !advanced) {
      give_up(advanced.error());
      if (session_.refused()) return tl::unexpected<Error>{advanced.error()};
    }
    publish_counts();
    looked = true;
  }
}

Result<void> RtdePoseSource::advance(SensorClock::time_point until) {
  const SensorClock::time_point now = monotonic_now();
  if (!stream_) {
    if (now < retry_at_) {
      wait_for(-1, 0, std::min(until, retry_at_) - now);
      return {};
    }
    begin_connection(now);
    BITELINE_ASSIGN(stream_, TcpStream::connect(config_.controller));
  }
  const SensorClock::time_point patience =
      handshaking_ ? connection_began_ + config_.connect_timeout : last_data_ + config_.reconnect_after;
  if (now >= patience) {
    return fail(Errc::Timeout, handshaking_ ? "RTDE hand-shake not done" : "RTDE controller is silent");
  }
  if (published_.state() == PoseState::Streaming && now >= last_data_ + config_.stale_after)
    published_.set(PoseState::Lost);
  BITELINE_ASSIGN(const bool connected, stream_->connected());
  if (!connected) {
    wait_for(stream_->number(), POLLOUT, std::min(until, patience) - now);
    return {};
  }
  BITELINE_TRY(stream_->send(session_.outgoing()));
  const short events = session_.outgoing().empty() ? POLLIN : POLLIN | POLLOUT;
  wait_for(stream_->number(), events, std::min(until, patience) - now);
  // A piece at a time: a burst beyond the waiting samples stays in the kernel until those are fetched.
  BITELINE_ASSIGN(const std::span<const std::uint8_t> bytes, stream_->receive(received_bytes_));
  if (bytes.empty()) return {};
  const SensorClock::time_point received = monotonic_now();
  samples_.set_received(received);
  const std::uint64_t data_before = session_.data_packages();
  BITELINE_TRY(session_.consume(bytes, samples_));
  // Only data are a sign of life: texts and what nobody knows may come for ever.
  const bool shaken = session_.running() && std::exchange(handshaking_, false);
  if (shaken || session_.data_packages() > data_before) last_data_ = received;
  return {};
}

void RtdePoseSource::begin_connection(SensorClock::time_point now) {
  session_.start();
  samples_.begin_connection();
  handshaking_ = true;
  connection_began_ = now;
}

void RtdePoseSource::give_up(const Error& fault) {
  last_fault_ = fault;
  stream_.reset();
  retry_at_ = monotonic_now() + config_.retry_after;
  made_anew_ = published_.state() != PoseState::Connecting;
  if (published_.state() == PoseState::Streaming) published_.set(PoseState::Lost);
}

void RtdePoseSource::publish_counts() {
  const RtdeSampleCounts& counts = samples_.counts();
  published_.publish(counts.poses, counts.poses_lost, counts.poses_rejected,
                     hal::clock_health(samples_.clock_health()));
}

}  // namespace biteline::hal
