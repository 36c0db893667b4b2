// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/udp_pose_source.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "hal/linux/udp_poses/egm_message.hpp"
#include "hal/linux/udp_poses/rsi_message.hpp"

namespace biteline::hal {
namespace {

constexpr const char* k_device = "UDP poses";

}  // namespace

Result<std::unique_ptr<UdpPoseSource>> UdpPoseSource::open(const Config& config) {
  in_addr controller{};
  if (::inet_pton(AF_INET, config.controller.c_str(), &controller) != 1)
    return fail(Errc::BadValue, "%.60s is no IPv4 address", config.controller.c_str());
  return std::unique_ptr<UdpPoseSource>{new UdpPoseSource{config, controller}};
}

Result<void> UdpPoseSource::start() {
  if (published_.state() != PoseState::Idle) return fail(Errc::WrongState, "UDP pose source is started");
  Descriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (!socket.is_open()) return device_failure(errno, k_device, "socket");
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(config_.port);
  here.sin_addr.s_addr = htonl(INADDR_ANY);
  socklen_t size = sizeof here;
  if (::bind(socket.number(), reinterpret_cast<const sockaddr*>(&here), size) != 0)
    return fail_errno(Errc::DeviceError, errno, "UDP port %d for poses", int{config_.port});
  if (::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&here), &size) != 0)
    return device_failure(errno, k_device, "getsockname");
  socket_ = std::move(socket);
  bound_port_ = ntohs(here.sin_port);
  peer_port_.reset();
  last_fault_.reset();
  told_.note_silence();
  published_.set(PoseState::Connecting);
  return {};
}

Result<void> UdpPoseSource::stop() {
  socket_.close();
  bound_port_ = 0;
  published_.set(PoseState::Idle);
  return {};
}

Result<RobotPose> UdpPoseSource::next_pose(Nanoseconds timeout) {
  if (published_.state() == PoseState::Idle) return fail(Errc::WrongState, "UDP pose source is not started");
  const SensorClock::time_point deadline = monotonic_now() + timeout;
  while (true) {
    const std::optional<Message> message = receive();
    if (message) {
      if (const std::optional<RobotPose> pose = take(*message)) return *pose;
    }
    const SensorClock::time_point now = monotonic_now();
    note_silence(now);
    if (now >= deadline) break;
    if (!message) static_cast<void>(wait_readable(socket_.number(), deadline - now, k_device));
  }
  if (!last_fault_) return fail(Errc::Timeout, "no word of the controller at UDP port %d", int{bound_port_});
  return fail(Errc::Timeout, "%.180s", last_fault_->where.c_str());
}

std::optional<UdpPoseSource::Message> UdpPoseSource::receive() {
  Message message;
  socklen_t size = sizeof message.sender;
  // MSG_TRUNC: the whole size, also of what was cut off.
  const ssize_t count = ::recvfrom(socket_.number(), buffer_.data(), buffer_.size(), MSG_TRUNC,
                                   reinterpret_cast<sockaddr*>(&message.sender), &size);
  if (count < 0) return std::nullopt;
  const bool fits = static_cast<std::size_t>(count) <= buffer_.size();
  message.bytes = std::span{buffer_}.first(fits ? static_cast<std::size_t>(count) : 0);
  return message;
}

bool UdpPoseSource::is_controller(const sockaddr_in& sender) const {
  return sender.sin_addr.s_addr == controller_.s_addr && (!peer_port_ || *peer_port_ == sender.sin_port);
}

std::optional<RobotPose> UdpPoseSource::take(const Message& message) {
  const SensorClock::time_point received = monotonic_now();
  if (!is_controller(message.sender)) {
    std::array<char, INET_ADDRSTRLEN> name{};
    ::inet_ntop(AF_INET, &message.sender.sin_addr, name.data(), name.size());
    last_fault_ = Error{.code = Errc::PeerRefused,
                        .where = FixedText<256>::format(
                            "poses from %s:%d: the controller at %.60s is heard alone", name.data(),
                            int{ntohs(message.sender.sin_port)}, config_.controller.c_str())};
    ++unreadable_;
    publish_counts();
    return std::nullopt;
  }
  const Result<ToldPose> told =
      config_.language == Language::Egm ? read_egm(message.bytes) : read_rsi(message.bytes);
  std::optional<RobotPose> pose;
  if (!told) {
    last_fault_ = told.error();
    ++unreadable_;
  } else {
    peer_port_ = message.sender.sin_port;
    if (config_.language == Language::Rsi && config_.answers) answer(told->stamp, message.sender);
    pose = told_.accept(*told, received);
    if (!pose) last_fault_ = fail(Errc::BadValue, "poses of the controller do not go on in time").value();
  }
  if (pose) {
    if (published_.state() == PoseState::Lost) published_.add_reconnect();
    published_.set(PoseState::Streaming);
    last_pose_at_ = received;
    last_fault_.reset();
  }
  publish_counts();
  return pose;
}

void UdpPoseSource::answer(RobotClock::time_point stamp, const sockaddr_in& sender) const {
  const RsiAnswer answer{stamp};
  const std::string_view text = answer.text();
  // Whether it arrives the controller alone knows: it counts what is late.
  static_cast<void>(::sendto(socket_.number(), text.data(), text.size(), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&sender), sizeof sender));
}

void UdpPoseSource::note_silence(SensorClock::time_point now) {
  if (published_.state() != PoseState::Streaming || now < last_pose_at_ + config_.lost_after) return;
  published_.set(PoseState::Lost);
  peer_port_.reset();
  told_.note_silence();
}

void UdpPoseSource::publish_counts() {
  published_.publish(told_.poses(), told_.lost(), told_.rejected() + unreadable_,
                     clock_health(told_.clock_health()));
}

}  // namespace biteline::hal
