// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/socketcan_bus.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace biteline::hal {
namespace {

constexpr std::size_t k_filters_max = 64;

Nanoseconds to_nanoseconds(const std::timespec& time) {
  return Nanoseconds{std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec};
}

struct BothClocks {
  Nanoseconds wall;
  SensorClock::time_point monotonic;
};

/// Read again while something came between: a thread that is preempted there would shift every stamp by as
/// much.
BothClocks read_both_clocks() {
  constexpr int k_tries = 5;
  constexpr Nanoseconds k_together{5'000};  // 0.001 mm at 250 mm/s
  BothClocks best{};
  Nanoseconds narrowest = Nanoseconds::max();
  for (int i = 0; i < k_tries && narrowest > k_together; ++i) {
    std::timespec wall{};
    const SensorClock::time_point before = monotonic_now();
    ::clock_gettime(CLOCK_REALTIME, &wall);
    const Nanoseconds apart = monotonic_now() - before;
    if (apart >= narrowest) continue;
    narrowest = apart;
    best = {.wall = to_nanoseconds(wall), .monotonic = before + apart / 2};
  }
  return best;
}

template <class Value>
bool set_option(int socket, int level, int name, const Value& value) {
  return ::setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/// The sizes that a CAN FD frame can have; others are padded by the caller, not here.
bool is_fd_size(std::uint8_t size_bytes) {
  constexpr std::array<std::uint8_t, 7> k_long_sizes{12, 16, 20, 24, 32, 48, 64};
  return size_bytes <= 8 ||
         std::find(k_long_sizes.begin(), k_long_sizes.end(), size_bytes) != k_long_sizes.end();
}

}  // namespace

Result<std::unique_ptr<SocketcanBus>> SocketcanBus::open(const Config& config) {
  const char* const name = config.interface.c_str();
  Descriptor socket{::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW)};
  if (!socket.is_open()) return device_failure(errno, name, "CAN socket");
  const unsigned index = ::if_nametoindex(name);
  if (index == 0) return fail_errno(Errc::DeviceNotFound, errno, "CAN interface %.60s", name);

  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  const int fd = config.fd ? 1 : 0;
  if (!set_option(socket.number(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) ||
      !set_option(socket.number(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, fd) ||
      !set_option(socket.number(), SOL_SOCKET, SO_RXQ_OVFL, on) ||
      !set_option(socket.number(), SOL_SOCKET, SO_TIMESTAMPNS, on)) {
    return device_failure(errno, name, "CAN socket option");
  }
  // The limit of an unprivileged socket (net.core.rmem_max) may keep it smaller; drops are counted in any
  // case.
  if (!set_option(socket.number(), SOL_SOCKET, SO_RCVBUFFORCE, config.receive_buffer_bytes)) {
    set_option(socket.number(), SOL_SOCKET, SO_RCVBUF, config.receive_buffer_bytes);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0) {
    return device_failure(errno, name, "bind");
  }
  return std::unique_ptr<SocketcanBus>{new SocketcanBus{std::move(socket), config.interface}};
}

Result<void> SocketcanBus::set_filters(std::span<const CanFilter> filters) {
  if (filters.size() > k_filters_max) return fail(Errc::BadValue, "%zu CAN filters", filters.size());
  std::array<can_filter, k_filters_max> kernel_filters{};
  for (std::size_t i = 0; i < filters.size(); ++i) {
    kernel_filters[i].can_id = filters[i].id | (filters[i].extended ? CAN_EFF_FLAG : 0U);
    kernel_filters[i].can_mask = filters[i].mask | CAN_EFF_FLAG | CAN_RTR_FLAG;
  }
  const std::size_t count = filters.empty() ? 1 : filters.size();  // one of zeros: everything passes
  if (::setsockopt(socket_.number(), SOL_CAN_RAW, CAN_RAW_FILTER, kernel_filters.data(),
                   static_cast<socklen_t>(count * sizeof(can_filter))) < 0) {
    return device_failure(errno, interface_.c_str(), "CAN filters");
  }
  return {};
}

Result<CanFrame> SocketcanBus::receive(Nanoseconds timeout) {
  const SensorClock::time_point deadline = monotonic_now() + std::max(timeout, Nanoseconds{0});
  while (true) {
    BITELINE_TRY(wait_readable(socket_.number(), deadline - monotonic_now(), interface_.c_str()));
    Result<CanFrame> frame = read_one();
    if (frame || frame.error().code != Errc::Timeout) return frame;
  }
}

Result<CanFrame> SocketcanBus::read_one() {
  canfd_frame raw{};
  iovec part{.iov_base = &raw, .iov_len = sizeof raw};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::timespec)) + CMSG_SPACE(sizeof(std::uint32_t))>
      control{};
  ::msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t size = ::recvmsg(socket_.number(), &message, 0);
  if (size < 0) {
    if (errno == EAGAIN || errno == EINTR) return fail(Errc::Timeout, "%.60s", interface_.c_str());
    if (errno == ENETDOWN) {  // told once; the socket goes on when the link is up again
      set_state(CanState::Down);
      return fail(Errc::Timeout, "%.60s", interface_.c_str());
    }
    return device_failure(errno, interface_.c_str(), "receive");
  }
  const Stamp received = receive_stamp(message);
  if ((raw.can_id & CAN_ERR_FLAG) != 0) {
    on_error_frame(raw.can_id & CAN_ERR_MASK, raw.data[1]);
    return fail(Errc::Timeout, "%.60s", interface_.c_str());
  }
  if (state_ == CanState::Down) set_state(CanState::ErrorActive);
  received_.fetch_add(1, std::memory_order_relaxed);

  const bool extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  CanFrame frame{.id = raw.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK),
                 .extended = extended,
                 .fd = size == CANFD_MTU,
                 .bit_rate_switch = size == CANFD_MTU && (raw.flags & CANFD_BRS) != 0,
                 .size_bytes = std::min<std::uint8_t>(raw.len, sizeof raw.data),
                 .data = {},
                 .received = received.instant,
                 .stamp_estimated = received.estimated};
  std::copy_n(raw.data, frame.size_bytes, frame.data.begin());
  return frame;
}

SocketcanBus::Stamp SocketcanBus::receive_stamp(const ::msghdr& message) {
  std::timespec stamp{};
  bool stamped = false;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(const_cast<::msghdr*>(&message), part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPNS) {
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      stamped = true;
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t drops = 0;  // since the socket was opened
      std::memcpy(&drops, CMSG_DATA(part), sizeof drops);
      dropped_.store(drops, std::memory_order_relaxed);
    }
  }
  const BothClocks now = read_both_clocks();
  const Nanoseconds age = now.wall - to_nanoseconds(stamp);
  // The queue holds well below a second; an age outside is a wall clock that was stepped since the interrupt.
  // A smaller step shows in the distance between both clocks, which otherwise changes by 500 parts per
  // million at most (adjtimex(2)).
  constexpr Nanoseconds k_age_max{1'000'000'000}, k_reading_error{100'000};
  const Nanoseconds apart = now.wall - now.monotonic.time_since_epoch();
  const Nanoseconds changed = std::chrono::abs(apart - clocks_apart_.value_or(apart));
  const bool stepped = changed > k_reading_error + (now.monotonic - clocks_read_) / 2000;
  clocks_apart_ = apart;
  clocks_read_ = now.monotonic;
  if (stamped && !stepped && age >= Nanoseconds{0} && age <= k_age_max)
    return {.instant = now.monotonic - age};
  stamps_estimated_.fetch_add(1, std::memory_order_relaxed);
  return {.instant = now.monotonic, .estimated = true};
}

void SocketcanBus::on_error_frame(std::uint32_t error_class, std::uint8_t controller_state) {
  if ((error_class & CAN_ERR_BUSOFF) != 0) set_state(CanState::BusOff);
  if ((error_class & CAN_ERR_RESTARTED) != 0) {
    restarts_.fetch_add(1, std::memory_order_relaxed);
    set_state(CanState::ErrorActive);
  }
  if ((error_class & CAN_ERR_CRTL) != 0) {
    if ((controller_state & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      set_state(CanState::ErrorPassive);
    } else if ((controller_state & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      set_state(CanState::ErrorWarning);
    } else if ((controller_state & CAN_ERR_CRTL_ACTIVE) != 0) {
      set_state(CanState::ErrorActive);
    }
  }
  if ((error_class & (CAN_ERR_BUSERROR | CAN_ERR_PROT | CAN_ERR_ACK | CAN_ERR_LOSTARB)) != 0) {
    bus_errors_.fetch_add(1, std::memory_order_relaxed);
  }
}

Result<void> SocketcanBus::send(const CanFrame& frame) {
  const bool size_fits = frame.fd ? is_fd_size(frame.size_bytes) : frame.size_bytes <= 8;
  const std::uint32_t id_max = frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK;
  if (!size_fits || frame.id > id_max) {
    return fail(Errc::BadValue, "CAN frame 0x%x with %d bytes", frame.id, int{frame.size_bytes});
  }
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.len = frame.size_bytes;
  raw.flags = frame.fd && frame.bit_rate_switch ? CANFD_BRS : 0;
  std::copy_n(frame.data.begin(), frame.size_bytes, raw.data);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  if (::send(socket_.number(), &raw, size, MSG_DONTWAIT) < 0) {
    if (errno == EAGAIN)
      return fail_errno(Errc::Overrun, errno, "%.60s: transmit queue full", interface_.c_str());
    if (errno == ENETDOWN) set_state(CanState::Down);
    return device_failure(errno, interface_.c_str(), "send");
  }
  sent_.fetch_add(1, std::memory_order_relaxed);
  return {};
}

CanHealth SocketcanBus::health() const noexcept {
  return {.state = state_.load(std::memory_order_relaxed),
          .frames_received = received_.load(std::memory_order_relaxed),
          .frames_sent = sent_.load(std::memory_order_relaxed),
          .frames_dropped = dropped_.load(std::memory_order_relaxed),
          .bus_errors = bus_errors_.load(std::memory_order_relaxed),
          .restarts = restarts_.load(std::memory_order_relaxed),
          .stamps_estimated = stamps_estimated_.load(std::memory_order_relaxed)};
}

}  // namespace biteline::hal
