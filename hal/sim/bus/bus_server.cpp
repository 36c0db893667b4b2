// SPDX-License-Identifier: MIT
#include "hal/sim/bus/bus_server.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hal/sim/bus/bus_transfer.hpp"

namespace biteline::sim {

namespace {

/// Some two seconds of the pose bus; the kernel gives at most its own limit (net.core.wmem_max).
constexpr int k_client_buffer_bytes = 2 << 20;

}  // namespace

BusServer::BusServer(hal::Descriptor listener, hal::Descriptor wake, Callbacks callbacks)
    : listener_(std::move(listener)),
      wake_(std::move(wake)),
      callbacks_(std::move(callbacks)),
      thread_([this] { serve(); }) {}

BusServer::~BusServer() {
  close();
}

void BusServer::close() {
  if (!thread_.joinable()) return;
  stopping_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(wake_.number(), &one, sizeof one);
  thread_.join();
  const std::lock_guard lock(clients_mutex_);
  clients_.clear();
}

Result<std::unique_ptr<BusServer>> BusServer::open(const std::string& name, Callbacks callbacks) {
  hal::Descriptor listener(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener.is_open()) return hal::device_failure(errno, name.c_str(), "socket");
  const BusAddress address(name);
  if (bind(listener.number(), address.get(), address.size()) != 0 || listen(listener.number(), 16) != 0) {
    return fail_errno(Errc::ConnectFailed, errno, "simulated wires %s", name.c_str());
  }
  hal::Descriptor wake(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) return hal::device_failure(errno, name.c_str(), "eventfd");
  return std::unique_ptr<BusServer>(
      new BusServer(std::move(listener), std::move(wake), std::move(callbacks)));
}

void BusServer::drive(Line line, bool active, SensorClock::time_point stamp) {
  change(line, active, stamp);
}

void BusServer::change(Line line, bool active, SensorClock::time_point stamp) {
  const std::lock_guard change_lock(change_mutex_);
  const auto index = static_cast<std::size_t>(line);
  if (levels_[index].exchange(active) == active) return;
  const BusMessage edge{.kind = BusMessage::Kind::Edge,
                        .line = line,
                        .active = active,
                        .sequence = edges_[index]++,
                        .stamp_ns = stamp.time_since_epoch().count()};
  if (callbacks_.on_line) callbacks_.on_line(line, active, stamp);
  const std::lock_guard lock(clients_mutex_);
  for (const auto& client : clients_) {
    if ((client->lines & bit_of(line)) != 0) post(*client, edge);
  }
}

void BusServer::send(const hal::CanFrame& frame) {
  const BusMessage message{
      .kind = BusMessage::Kind::Can, .stamp_ns = frame.received.time_since_epoch().count(), .can = frame};
  const std::lock_guard lock(clients_mutex_);
  for (const auto& client : clients_) {
    if (client->wants_can) post(*client, message);
  }
}

void BusServer::post(const Client& client, const BusMessage& message) {
  if (::send(client.socket.number(), &message, sizeof message, MSG_DONTWAIT | MSG_NOSIGNAL) !=
      static_cast<ssize_t>(sizeof message)) {
    ++dropped_;
  }
}

void BusServer::serve() {
  std::vector<pollfd> waits;
  while (!stopping_) {
    waits.assign({{listener_.number(), POLLIN, 0}, {wake_.number(), POLLIN, 0}});
    std::vector<Client*> asked;
    {
      const std::lock_guard lock(clients_mutex_);
      for (const auto& client : clients_) {
        waits.push_back({client->socket.number(), POLLIN, 0});
        asked.push_back(client.get());
      }
    }
    if (poll(waits.data(), waits.size(), -1) < 0) continue;
    if ((waits[0].revents & POLLIN) != 0) accept_client();
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (waits[i + 2].revents == 0 || read_from(*asked[i])) continue;
      std::unique_ptr<Client> gone;
      {
        const std::lock_guard lock(clients_mutex_);
        const auto found = std::find_if(clients_.begin(), clients_.end(),
                                        [&](const auto& c) { return c.get() == asked[i]; });
        gone = std::move(*found);
        clients_.erase(found);
      }
      let_go(*gone);
    }
  }
}

void BusServer::accept_client() {
  hal::Descriptor socket(accept4(listener_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.is_open()) return;
  setsockopt(socket.number(), SOL_SOCKET, SO_SNDBUF, &k_client_buffer_bytes, sizeof k_client_buffer_bytes);
  auto client = std::make_unique<Client>();
  client->socket = std::move(socket);
  const std::lock_guard lock(clients_mutex_);
  clients_.push_back(std::move(client));
}

bool BusServer::read_from(Client& client) {
  for (;;) {
    BusMessage message;
    const auto size = receive_whole(client.socket.number(), message);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return true;
    if (size != static_cast<ssize_t>(sizeof message)) return false;
    const auto now = hal::monotonic_now();
    if (message.line >= Line::Count) return false;
    switch (message.kind) {
      case BusMessage::Kind::Subscribe: {
        const std::lock_guard lock(clients_mutex_);
        client.lines = message.lines;
        client.wants_can = message.wants_can;
        break;
      }
      case BusMessage::Kind::Drive:
        client.driven |= bit_of(message.line);
        change(message.line, message.active, now);
        [[fallthrough]];
      case BusMessage::Kind::Query: {
        const BusMessage answer{.kind = BusMessage::Kind::Level,
                                .line = message.line,
                                .active = level(message.line),
                                .stamp_ns = now.time_since_epoch().count()};
        const std::lock_guard lock(clients_mutex_);
        post(client, answer);
        break;
      }
      case BusMessage::Kind::Trigger:
        client.drives_trigger = message.period_ns > 0;
        if (callbacks_.on_trigger)
          callbacks_.on_trigger(Nanoseconds{message.period_ns}, Nanoseconds{message.pulse_ns});
        break;
      case BusMessage::Kind::Can:
        if (callbacks_.on_can) callbacks_.on_can(message.can);
        break;
      case BusMessage::Kind::Level:
      case BusMessage::Kind::Edge:
        return false;  // these go the other way
    }
  }
}

void BusServer::let_go(const Client& client) {
  const auto now = hal::monotonic_now();
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(Line::Count); ++i) {
    const auto line = static_cast<Line>(i);
    if ((client.driven & bit_of(line)) != 0) change(line, false, now);
  }
  if (client.drives_trigger && callbacks_.on_trigger) callbacks_.on_trigger(Nanoseconds{0}, Nanoseconds{0});
}

}  // namespace biteline::sim
