// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/server.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>
#include <thread>
#include <utility>

#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/device.hpp"

namespace biteline::gige {
namespace {

/// A missed heartbeat is noticed within this.
constexpr int k_turn_ms = 100;
constexpr int k_stream_buffer_bytes = 4 << 20;
constexpr std::uint32_t k_everywhere = 0xffff'ffff;

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_{number} {}
  Descriptor(Descriptor&& other) noexcept : number_{std::exchange(other.number_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_{-1};
};

sockaddr_in place_of(std::uint32_t address, std::uint16_t port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(address);
  place.sin_port = htons(port);
  return place;
}

/// Hears only what comes by this interface.  `shared`: others may listen there, too.
Result<Descriptor> listener(const Interface& interface, std::uint32_t address, std::uint16_t port,
                            bool shared) {
  Descriptor made{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  const int yes = 1;
  const sockaddr_in place = place_of(address, port);
  const bool bound =
      made.number() >= 0 &&
      setsockopt(made.number(), SOL_SOCKET, SO_BINDTODEVICE, interface.name.c_str(),
                 static_cast<socklen_t>(interface.name.size())) == 0 &&
      (!shared || setsockopt(made.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0) &&
      bind(made.number(), reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0;
  if (bound) return made;
  return fail_errno(Errc::ConnectFailed, errno, "%s, %s port %d", interface.name.c_str(),
                    address_text(address).c_str(), int{port});
}

std::uint16_t port_of(const Descriptor& socket) {
  sockaddr_in place{};
  socklen_t size = sizeof place;
  getsockname(socket.number(), reinterpret_cast<sockaddr*>(&place), &size);
  return ntohs(place.sin_port);
}

}  // namespace

/// A packet of the stream that is yet to be sent.
struct Outgoing {
  Peer to;
  std::vector<std::uint8_t> packet;
  bool first{true};  ///< not asked for again
};

struct Server::State {
  ServerConfig config;
  std::vector<Descriptor> listeners;  ///< the first answers for all
  Descriptor stream, waker;
  std::optional<Device> device;
  mutable std::mutex mutex;        ///< of the device, the counts and the two below
  std::vector<Outgoing> outgoing;  ///< while somebody holds the mutex
  bool first_sending{true};        ///< no packet is lost that was asked for again
  ServerCounts counts;
  bool stop{false};
  std::thread thread;

  /// What `act` does with the device, and then, without the mutex, what comes of it for the stream: a network
  /// that takes no more holds up whoever offers, and no client's command.
  template <class Act>
  void with_device(const Act& act) {
    std::vector<Outgoing> batch;
    {
      const std::lock_guard lock{mutex};
      act(*device);
      batch.swap(outgoing);
    }
    if (batch.empty()) return;
    std::uint64_t lost = 0, unsent = 0, unsent_again = 0;
    for (const Outgoing& one : batch) {
      if (one.first && config.lose && config.lose()) {
        ++lost;
      } else if (!send(one)) {
        ++(one.first ? unsent : unsent_again);
      }
    }
    const std::lock_guard lock{mutex};
    counts.lost += lost;
    counts.unsent += unsent;
    counts.unsent_again += unsent_again;
  }

  /// What is sent again goes out on the thread that answers commands, so it waits for nothing: a client that
  /// still lacks it asks once more.
  [[nodiscard]] bool send(const Outgoing& one) const {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = one.to.address;
    place.sin_port = one.to.port;
    return sendto(stream.number(), one.packet.data(), one.packet.size(), one.first ? 0 : MSG_DONTWAIT,
                  reinterpret_cast<const sockaddr*>(&place), sizeof place) >= 0;
  }

  [[nodiscard]] bool may_talk(std::uint32_t address) const {
    return config.clients.empty() || std::ranges::find(config.clients, address) != config.clients.end();
  }

  void hear(const Descriptor& listener) {
    std::array<std::uint8_t, 1024> buffer{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = recvfrom(listener.number(), buffer.data(), buffer.size(), MSG_DONTWAIT,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    if (got <= 0) return;
    if (!may_talk(ntohl(from.sin_addr.s_addr))) {
      const std::lock_guard lock{mutex};
      ++counts.strangers;
      return;
    }
    std::optional<std::vector<std::uint8_t>> reply;
    with_device([&](Device& face) {
      first_sending = false;
      reply = face.on_packet({.address = from.sin_addr.s_addr, .port = from.sin_port},
                             std::span{buffer}.first(static_cast<std::size_t>(got)), Device::Clock::now());
      first_sending = true;
    });
    if (reply)
      (void)sendto(listeners.front().number(), reply->data(), reply->size(), MSG_DONTWAIT,
                   reinterpret_cast<const sockaddr*>(&from), sizeof from);
  }

  void run() {
    pthread_setname_np(pthread_self(), "bl-gige");
    std::vector<pollfd> waits{{.fd = waker.number(), .events = POLLIN, .revents = 0}};
    for (const Descriptor& listener : listeners)
      waits.push_back({.fd = listener.number(), .events = POLLIN, .revents = 0});
    while (true) {
      (void)poll(waits.data(), waits.size(), k_turn_ms);
      bool over = false;
      with_device([&](Device& face) {
        over = stop;
        if (!over) face.tick(Device::Clock::now());
      });
      if (over) return;
      for (std::size_t i = 0; i < listeners.size(); ++i)
        if ((waits[i + 1].revents & POLLIN) != 0) hear(listeners[i]);
    }
  }
};

Result<std::unique_ptr<Server>> Server::open(const ServerConfig& config) {
  if (!config.interface.loopback && config.clients.empty())
    return fail(Errc::InvalidArgument,
                "%s is beyond loopback: GigE Vision has no login, name who may connect (--client)",
                config.interface.name.c_str());
  auto state = std::make_unique<State>();
  state->config = config;
  const Interface& interface = config.interface;
  for (const auto& [address, shared] :
       {std::pair{interface.address, false}, {interface.broadcast(), true}, {k_everywhere, true}}) {
    BITELINE_ASSIGN(Descriptor heard, listener(interface, address, k_port, shared));
    state->listeners.push_back(std::move(heard));
  }
  BITELINE_ASSIGN(state->stream, listener(interface, interface.address, 0, false));
  const int whole = IP_PMTUDISC_DO;
  setsockopt(state->stream.number(), IPPROTO_IP, IP_MTU_DISCOVER, &whole, sizeof whole);
  setsockopt(state->stream.number(), SOL_SOCKET, SO_SNDBUF, &k_stream_buffer_bytes,
             sizeof k_stream_buffer_bytes);
  state->waker = Descriptor{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  if (state->waker.number() < 0) return fail_errno(Errc::DeviceError, errno, "eventfd");
  state->device.emplace(
      Identity{.address = interface.address,
               .mask = interface.mask,
               .mac = interface.mac,
               .version = config.version,
               .serial = config.serial,
               .name = config.name},
      port_of(state->stream), [own = state.get()](const Peer& to, std::span<const std::uint8_t> packet) {
        own->outgoing.push_back(
            {.to = to, .packet = {packet.begin(), packet.end()}, .first = own->first_sending});
      });
  state->thread = std::thread{[own = state.get()] { own->run(); }};
  return std::unique_ptr<Server>{new Server{std::move(state)}};
}

Server::Server(std::unique_ptr<State> state) : state_{std::move(state)} {}

Server::~Server() {
  {
    const std::lock_guard lock{state_->mutex};
    state_->stop = true;
  }
  (void)eventfd_write(state_->waker.number(), 1);
  state_->thread.join();
}

void Server::set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures) {
  state_->with_device([&](Device& device) { device.set_head(columns, depth, pictures); });
}

void Server::set_exposure(Nanoseconds exposure) {
  state_->with_device([&](Device& device) { device.set_exposure(exposure); });
}

void Server::offer(std::uint64_t scan, const wire::Picture& picture) {
  state_->with_device([&](Device& device) { device.offer(scan, picture); });
}

void Server::offer(std::uint64_t scan, const profile::Profile& profile) {
  state_->with_device([&](Device& device) { device.offer(scan, profile); });
}

void Server::end_scan() {
  state_->with_device([](Device& device) { device.end_scan(); });
}

bool Server::acquiring() const {
  const std::lock_guard lock{state_->mutex};
  return state_->device->acquiring();
}

bool Server::wants_pictures() const {
  const std::lock_guard lock{state_->mutex};
  return state_->device->wants_pictures();
}

std::uint64_t Server::starts() const {
  const std::lock_guard lock{state_->mutex};
  return state_->device->starts();
}

ServerCounts Server::counts() const {
  const std::lock_guard lock{state_->mutex};
  ServerCounts counts = state_->counts;
  counts.stream = state_->device->counts();
  counts.pictures_left_out = state_->device->pictures_left_out();
  return counts;
}

}  // namespace biteline::gige
