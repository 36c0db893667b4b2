// SPDX-License-Identifier: MIT
#include "host/interfaces/control/server.hpp"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "common/wire/socket.hpp"
#include "host/interfaces/control/poll.hpp"

namespace biteline::control {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Door = std::string;  // libzmq's name of a connection

/// Nobody waits for it: the end is woken when there is something to say.
constexpr Nanoseconds k_turn = milliseconds{200};
constexpr auto k_door_lives = std::chrono::seconds{5};
constexpr std::size_t k_most_waiting = 128;
constexpr std::size_t k_most_waiting_of_one = 32;
constexpr std::size_t k_most_doors = 64;
/// Events that the socket's thread has not sent yet; it is never behind but under a flood.
constexpr std::size_t k_most_unsent = 1024;
constexpr int k_messages_a_turn = 64;

std::string_view view(const wire::Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

struct Work {
  Door door;
  Request request;
};

/// A worker, and what waits for it.
struct Line {
  std::deque<Work> work{};
  std::condition_variable has_work{};
  std::thread thread{};
};

struct Outgoing {
  Door door;  ///< empty: an event for all
  std::string text;
};

}  // namespace

struct Server::State {
  ServerConfig config;
  Handlers handlers;
  wire::SocketContext context;
  std::optional<wire::Socket> gatekeeper;
  wire::Socket socket;
  Wake wake;
  std::string address;

  mutable std::mutex mutex{};
  Line usual{}, seconds{};  ///< what takes seconds holds up nothing else
  std::deque<Outgoing> outgoing{};
  std::map<Door, Clock::time_point> doors{};  ///< that said hello, and when last
  std::uint64_t next_seq{1};
  ServerCounters counters{};
  std::vector<std::string> allowed{};
  Clock::time_point allowed_read{};
  std::atomic<bool> stop{false};
  std::thread io{};

  State(ServerConfig config_, Handlers handlers_, wire::SocketContext context_,
        std::optional<wire::Socket> gatekeeper_, wire::Socket socket_, Wake wake_, std::string address_)
      : config{std::move(config_)},
        handlers{std::move(handlers_)},
        context{std::move(context_)},
        gatekeeper{std::move(gatekeeper_)},
        socket{std::move(socket_)},
        wake{std::move(wake_)},
        address{std::move(address_)} {
    if (config.keys) allowed = config.keys->allowed_hosts;
  }

  /// False: that door is gone or does not read; nobody waits for it.
  bool send_to(const Door& door, const std::string& text) {
    if (socket.send({bytes_of(door), bytes_of(text)})) return true;
    const std::lock_guard lock{mutex};
    ++counters.dropped_events;
    return false;
  }

  void greet(const Door& door) {
    bool fresh = false;
    std::uint64_t seq = 0;
    {
      const std::lock_guard lock{mutex};
      if (!doors.contains(door) && doors.size() >= k_most_doors) {
        ++counters.refused_messages;
        return;
      }
      fresh = !doors.contains(door);
      doors[door] = Clock::now();
      seq = next_seq - 1;  // of the last one before: the next is no gap
    }
    if (fresh) {
      const Event hello{.name = "hello", .data = config.hello, .seq = seq, .time = utc_now()};
      if (send_to(door, to_text(hello))) return;
      // It is said once: a door that did not get it is greeted as a new one again.
      const std::lock_guard lock{mutex};
      doors.erase(door);
    } else {
      send_to(door, to_text(Event{.name = "alive", .data = {}, .seq = seq, .time = utc_now()}));
    }
  }

  void take_request(const Door& door, Request request) {
    if (handlers.stops) request.stops = handlers.stops();
    {
      const std::lock_guard lock{mutex};
      ++counters.requests;
    }
    const std::uint64_t id = request.id;
    if (std::optional<Answer> urgent = handlers.urgent ? handlers.urgent(request) : std::nullopt) {
      urgent->id = id;
      send_to(door, to_text(*urgent));
      return;
    }
    Line& line = handlers.is_long && handlers.is_long(request) ? seconds : usual;
    {
      const std::lock_guard lock{mutex};
      // Of this worker alone: what waits for the other one must not keep it idle.
      const auto of_this =
          static_cast<std::size_t>(std::ranges::count(line.work, door, [](const Work& w) { return w.door; }));
      if (line.work.size() < k_most_waiting && of_this < k_most_waiting_of_one) {
        line.work.push_back({.door = door, .request = std::move(request)});
        line.has_work.notify_one();
        return;
      }
      ++counters.refused_messages;
    }
    Answer busy = refusal(503, "busy", "too many requests wait; ask again in a second");
    busy.id = id;
    send_to(door, to_text(busy));
  }

  void hear() {
    for (int i = 0; i < k_messages_a_turn; ++i) {
      std::optional<wire::Socket::Parts> message = socket.receive();
      if (!message) return;
      if (message->parts.size() != 2 || message->surplus_parts > 0) {
        const std::lock_guard lock{mutex};
        ++counters.refused_messages;
        continue;
      }
      const Door door{view(message->parts[0])};
      auto heard = read_from_door(view(message->parts[1]));
      if (!heard) {
        {
          const std::lock_guard lock{mutex};
          ++counters.refused_messages;
        }
        // A person's address may be longer than a request's: who asked is told, and waits for nothing.
        Answer told = refusal(400, "bad_request", to_line(heard.error()));
        told.id = id_of_refused(view(message->parts[1]));
        send_to(door, to_text(told));
        continue;
      }
      if (auto* request = std::get_if<Request>(&*heard)) {
        take_request(door, std::move(*request));
      } else {
        greet(door);
      }
    }
  }

  void forget_silent_doors() {
    const std::lock_guard lock{mutex};
    std::erase_if(doors, [](const auto& door) { return Clock::now() - door.second > k_door_lives; });
  }

  void say() {
    std::deque<Outgoing> all;
    std::vector<Door> listeners;
    {
      const std::lock_guard lock{mutex};
      all.swap(outgoing);
      for (const auto& [door, heard] : doors) listeners.push_back(door);
    }
    for (const Outgoing& one : all) {
      if (!one.door.empty()) {
        send_to(one.door, one.text);
        continue;
      }
      for (const Door& door : listeners) send_to(door, one.text);
    }
  }

  void guard_the_gate() {
    if (!gatekeeper) return;
    if (Clock::now() - allowed_read > std::chrono::seconds{1}) {
      // A list that cannot be read now lets nobody new in that it did not before.
      if (auto list = wire::read_allowed_hosts(config.keys->folder); list) allowed = std::move(*list);
      allowed_read = Clock::now();
    }
    const int refused = wire::serve_gatekeeper(*gatekeeper, allowed);
    const std::lock_guard lock{mutex};
    counters.refused_doors += static_cast<std::uint64_t>(refused);
  }

  void run_io() {
    pthread_setname_np(pthread_self(), "bl-control");
    while (!stop) {
      if (gatekeeper) {
        wait_for({&socket, &*gatekeeper}, wake, k_turn);
      } else {
        wait_for({&socket}, wake, k_turn);
      }
      guard_the_gate();
      hear();
      say();
      forget_silent_doors();
    }
  }

  void run_work(Line& line, const char* name) {
    pthread_setname_np(pthread_self(), name);
    while (true) {
      Work next;
      {
        std::unique_lock lock{mutex};
        line.has_work.wait(lock, [&] { return stop || !line.work.empty(); });
        if (stop) return;
        next = std::move(line.work.front());
        line.work.pop_front();
      }
      Answer answer = handlers.ordinary(next.request);
      answer.id = next.request.id;
      {
        const std::lock_guard lock{mutex};
        outgoing.push_back({.door = std::move(next.door), .text = to_text(answer)});
      }
      wake.ring();
    }
  }
};

Result<std::unique_ptr<Server>> Server::open(const ServerConfig& config, Handlers handlers) {
  BITELINE_ASSIGN(wire::SocketContext context, wire::SocketContext::create());
  std::optional<wire::Socket> gatekeeper;
  std::optional<wire::KeyPair> own;
  if (config.keys) {
    BITELINE_ASSIGN(gatekeeper, wire::open_gatekeeper(context));
    own = config.keys->own;
  }
  BITELINE_ASSIGN(wire::Socket socket,
                  wire::open_listener(context, config.endpoint, own, gatekeeper ? &*gatekeeper : nullptr));
  BITELINE_ASSIGN(const std::string address, socket.bound_address());
  BITELINE_ASSIGN(Wake wake, Wake::create());
  return std::unique_ptr<Server>{new Server{
      std::make_unique<State>(config, std::move(handlers), std::move(context), std::move(gatekeeper),
                              std::move(socket), std::move(wake), address)}};
}

Server::Server(std::unique_ptr<State> state) : state_{std::move(state)} {
  state_->io = std::thread{[state = state_.get()] { state->run_io(); }};
  state_->usual.thread = std::thread{[own = state_.get()] { own->run_work(own->usual, "bl-control-work"); }};
  state_->seconds.thread =
      std::thread{[own = state_.get()] { own->run_work(own->seconds, "bl-control-long"); }};
}

Server::~Server() {
  {
    const std::lock_guard lock{state_->mutex};
    state_->stop = true;
  }
  state_->usual.has_work.notify_all();
  state_->seconds.has_work.notify_all();
  state_->wake.ring();
  state_->usual.thread.join();
  state_->seconds.thread.join();
  state_->io.join();
}

const std::string& Server::address() const {
  return state_->address;
}

void Server::publish(const std::string& name, Json data) {
  {
    const std::lock_guard lock{state_->mutex};
    Event event{.name = name, .data = std::move(data), .seq = state_->next_seq++, .time = utc_now()};
    if (state_->doors.empty()) return;
    if (state_->outgoing.size() >= k_most_unsent) {
      ++state_->counters.dropped_events;
      return;
    }
    state_->outgoing.push_back({.door = {}, .text = to_text(event)});
  }
  state_->wake.ring();
}

std::uint64_t Server::last_seq() const {
  const std::lock_guard lock{state_->mutex};
  return state_->next_seq - 1;
}

ServerCounters Server::counters() const {
  const std::lock_guard lock{state_->mutex};
  return state_->counters;
}

int Server::doors() const {
  const std::lock_guard lock{state_->mutex};
  return static_cast<int>(state_->doors.size());
}

}  // namespace biteline::control
