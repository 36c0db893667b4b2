// SPDX-License-Identifier: MIT
#include "hal/sim/bus/bus_devices.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "hal/sim/bus/bus_transfer.hpp"

namespace biteline::sim {

namespace {

/// The cell answers at once; a simulated line that takes longer is a dead one.
constexpr Nanoseconds k_answer_within{200'000'000};
constexpr const char* k_wires = "simulated wires";

}  // namespace

Result<BusConnection> BusConnection::connect(const std::string& name) {
  hal::Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return hal::device_failure(errno, name.c_str(), "socket");
  const BusAddress address(name);
  if (::connect(socket.number(), address.get(), address.size()) != 0) {
    return fail_errno(Errc::DeviceNotFound, errno, "simulated cell '%s'", name.c_str());
  }
  return BusConnection(std::move(socket));
}

Result<void> BusConnection::send(const BusMessage& message) noexcept {
  if (::send(socket_.number(), &message, sizeof message, MSG_NOSIGNAL) !=
      static_cast<ssize_t>(sizeof message)) {
    return fail_errno(Errc::DeviceLost, errno, k_wires);
  }
  return {};
}

Result<BusMessage> BusConnection::receive(Nanoseconds timeout) noexcept {
  BITELINE_TRY(hal::wait_readable(socket_.number(), timeout, k_wires));
  BusMessage message;
  const auto size = receive_whole(socket_.number(), message);
  if (size == static_cast<ssize_t>(sizeof message)) return message;
  return fail_errno(Errc::DeviceLost, size < 0 ? errno : 0, k_wires);
}

Result<bool> BusConnection::ask(const BusMessage& message) noexcept {
  BITELINE_TRY(send(message));
  const auto until = hal::monotonic_now() + k_answer_within;
  for (;;) {
    BITELINE_ASSIGN(const BusMessage answer, receive(until - hal::monotonic_now()));
    if (answer.kind == BusMessage::Kind::Level && answer.line == message.line) return answer.active;
  }
}

Result<std::unique_ptr<SimGpioOut>> SimGpioOut::open(const std::string& name, Line line) {
  BITELINE_ASSIGN(BusConnection connection, BusConnection::connect(name));
  std::unique_ptr<SimGpioOut> output(new SimGpioOut(std::move(connection), line));
  BITELINE_TRY(output->set(false));
  return output;
}

Result<void> SimGpioOut::set(bool active) noexcept {
  BITELINE_ASSIGN(const bool level,
                  connection_.ask({.kind = BusMessage::Kind::Drive, .line = line_, .active = active}));
  if (level != active)
    return fail(Errc::DeviceError, "simulated wires: line %u did not follow", static_cast<unsigned>(line_));
  return {};
}

Result<bool> SimGpioOut::read_back() noexcept {
  return connection_.ask({.kind = BusMessage::Kind::Query, .line = line_});
}

Result<std::unique_ptr<SimEdgeIn>> SimEdgeIn::open(const std::string& name, Line line) {
  BITELINE_ASSIGN(BusConnection edges, BusConnection::connect(name));
  BITELINE_ASSIGN(BusConnection levels, BusConnection::connect(name));
  BITELINE_TRY(edges.send({.kind = BusMessage::Kind::Subscribe, .lines = bit_of(line)}));
  // Its answer comes after the subscription has been read: edges from here on are seen.
  BITELINE_TRY(edges.ask({.kind = BusMessage::Kind::Query, .line = line}));
  return std::unique_ptr<SimEdgeIn>(new SimEdgeIn(std::move(edges), std::move(levels), line));
}

Result<hal::Edge> SimEdgeIn::next_edge(Nanoseconds timeout) {
  const auto until = hal::monotonic_now() + timeout;
  for (;;) {
    BITELINE_ASSIGN(const BusMessage message, edge_connection_.receive(until - hal::monotonic_now()));
    if (message.kind != BusMessage::Kind::Edge) continue;
    if (started_ && message.sequence > next_sequence_) lost_ += message.sequence - next_sequence_;
    started_ = true;
    next_sequence_ = message.sequence + 1;
    ++edges_;
    return hal::Edge{.stamp = SensorClock::time_point{Nanoseconds{message.stamp_ns}},
                     .rising = message.active,
                     .sequence = message.sequence};
  }
}

Result<bool> SimEdgeIn::level() noexcept {
  return level_connection_.ask({.kind = BusMessage::Kind::Query, .line = line_});
}

Result<std::unique_ptr<SimSafetyIn>> SimSafetyIn::open(const std::string& name) {
  BITELINE_ASSIGN(BusConnection connection, BusConnection::connect(name));
  return std::unique_ptr<SimSafetyIn>(new SimSafetyIn(std::move(connection)));
}

Result<hal::SafetyInputs> SimSafetyIn::read() noexcept {
  BITELINE_ASSIGN(const bool closed,
                  connection_.ask({.kind = BusMessage::Kind::Query, .line = Line::Interlock}));
  BITELINE_ASSIGN(const bool key_on, connection_.ask({.kind = BusMessage::Kind::Query, .line = Line::Key}));
  BITELINE_ASSIGN(const bool too_hot,
                  connection_.ask({.kind = BusMessage::Kind::Query, .line = Line::TooHot}));
  return hal::SafetyInputs{
      .interlock_closed = closed, .key_on = key_on, .too_hot = too_hot, .read_at = hal::monotonic_now()};
}

Result<std::unique_ptr<SimPwmOut>> SimPwmOut::open(const std::string& name) {
  BITELINE_ASSIGN(BusConnection connection, BusConnection::connect(name));
  return std::unique_ptr<SimPwmOut>(new SimPwmOut(std::move(connection)));
}

Result<void> SimPwmOut::tell(const hal::PwmSettings& settings) noexcept {
  return connection_.send({.kind = BusMessage::Kind::Trigger,
                           .period_ns = settings.period.count(),
                           .pulse_ns = settings.pulse.count()});
}

Result<hal::PwmSettings> SimPwmOut::configure(const hal::PwmSettings& wanted) {
  if (wanted.period.count() <= 0 || wanted.pulse.count() < 0 || wanted.pulse > wanted.period) {
    return fail(Errc::BadValue, "simulated trigger: 0 <= pulse <= period expected, period > 0");
  }
  settings_ = wanted;
  configured_ = true;
  if (running_) BITELINE_TRY(tell(settings_));
  return settings_;
}

Result<void> SimPwmOut::start() {
  if (!configured_) return fail(Errc::WrongState, "simulated trigger: start before configure");
  BITELINE_TRY(tell(settings_));
  running_ = true;
  return {};
}

Result<void> SimPwmOut::stop() noexcept {
  if (!running_.exchange(false)) return {};
  return tell({});
}

Result<std::unique_ptr<SimCanBus>> SimCanBus::open(const std::string& name) {
  BITELINE_ASSIGN(BusConnection connection, BusConnection::connect(name));
  BITELINE_TRY(connection.send({.kind = BusMessage::Kind::Subscribe, .wants_can = true}));
  return std::unique_ptr<SimCanBus>(new SimCanBus(std::move(connection)));
}

Result<void> SimCanBus::set_filters(std::span<const hal::CanFilter> filters) {
  if (filters.size() > k_most_filters)
    return fail(Errc::BadValue, "simulated CAN: at most %zu filters", k_most_filters);
  std::copy(filters.begin(), filters.end(), filters_.begin());
  filter_count_ = filters.size();
  return {};
}

bool SimCanBus::passes(const hal::CanFrame& frame) const {
  if (filter_count_ == 0) return true;
  return std::any_of(filters_.begin(), filters_.begin() + static_cast<std::ptrdiff_t>(filter_count_),
                     [&](const auto& filter) {
                       return filter.extended == frame.extended &&
                              (frame.id & filter.mask) == (filter.id & filter.mask);
                     });
}

Result<hal::CanFrame> SimCanBus::receive(Nanoseconds timeout) {
  const auto until = hal::monotonic_now() + timeout;
  for (;;) {
    const Result<BusMessage> message = connection_.receive(until - hal::monotonic_now());
    if (!message) {
      if (message.error().code == Errc::DeviceLost) down_ = true;
      return tl::unexpected<Error>(message.error());
    }
    if (message->kind != BusMessage::Kind::Can || !passes(message->can)) continue;
    ++received_;
    return message->can;
  }
}

Result<void> SimCanBus::send(const hal::CanFrame& frame) {
  if (frame.size_bytes > (frame.fd ? frame.data.size() : 8) ||
      frame.id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) {
    return fail(Errc::BadValue, "CAN frame 0x%x with %d bytes", frame.id, int{frame.size_bytes});
  }
  BITELINE_TRY(connection_.send({.kind = BusMessage::Kind::Can, .can = frame}));
  ++sent_;
  return {};
}

hal::CanHealth SimCanBus::health() const noexcept {
  return {.state = down_ ? hal::CanState::Down : hal::CanState::ErrorActive,
          .frames_received = received_,
          .frames_sent = sent_};
}

}  // namespace biteline::sim
