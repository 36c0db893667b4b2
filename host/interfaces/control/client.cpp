// SPDX-License-Identifier: MIT
#include "host/interfaces/control/client.hpp"

#include <pthread.h>
#include <zmq.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <thread>

#include "common/wire/socket.hpp"
#include "host/interfaces/control/poll.hpp"

namespace biteline::control {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr Nanoseconds k_turn = milliseconds{100};
constexpr auto k_between_hellos = std::chrono::seconds{1};
constexpr auto k_silence = std::chrono::seconds{5};
constexpr std::size_t k_most_waiting = 256;
constexpr std::size_t k_most_stops = 64;  // beyond them
/// The history of 200 000 shoes as one table.
constexpr std::int64_t k_most_answer_bytes = 64 * 1024 * 1024;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Answer gone() {
  return refusal(503, "service_gone", "biteline-host does not answer; check that it runs, then ask again");
}

}  // namespace

struct Client::State {
  struct Waiting {
    std::uint64_t callers_id{0};
    OnAnswer on_answer;
    Clock::time_point until;
  };

  ClientConfig config;
  OnEvent on_event;
  OnLink on_link;
  wire::SocketContext context;
  wire::Socket socket;
  Wake wake;

  std::mutex mutex{};
  std::deque<std::string> outgoing{};
  std::map<std::uint64_t, Waiting> waiting{};
  std::uint64_t next_id{1};
  std::atomic<bool> stop{false};
  std::atomic<bool> connected{false};
  Clock::time_point last_heard{};
  Clock::time_point last_hello{};
  std::thread io{};

  State(ClientConfig config_, OnEvent on_event_, OnLink on_link_, wire::SocketContext context_,
        wire::Socket socket_, Wake wake_)
      : config{std::move(config_)},
        on_event{std::move(on_event_)},
        on_link{std::move(on_link_)},
        context{std::move(context_)},
        socket{std::move(socket_)},
        wake{std::move(wake_)} {}

  void set_connected(bool now) {
    if (connected.exchange(now) != now && on_link) on_link(now);
  }

  void hear() {
    while (const std::optional<wire::Socket::Parts> message = socket.receive()) {
      if (message->parts.empty()) continue;
      const wire::Bytes& bytes = message->parts.front();
      auto heard = read_from_service({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      if (!heard) continue;  // not our service's words; silence ends the link
      last_heard = Clock::now();
      set_connected(true);
      if (auto* answer = std::get_if<Answer>(&*heard)) {
        finish(std::move(*answer));
      } else if (const auto& event = std::get<Event>(*heard); on_event && event.name != "alive") {
        on_event(event);
      }
    }
  }

  void finish(Answer answer) {
    OnAnswer on_answer;
    {
      const std::lock_guard lock{mutex};
      const auto found = waiting.find(answer.id);
      if (found == waiting.end()) return;
      answer.id = found->second.callers_id;
      on_answer = std::move(found->second.on_answer);
      waiting.erase(found);
    }
    if (on_answer) on_answer(std::move(answer));
  }

  void end_patience(bool all) {
    std::vector<Waiting> ended;
    {
      const std::lock_guard lock{mutex};
      std::erase_if(waiting, [&](auto& entry) {
        if (!all && Clock::now() < entry.second.until) return false;
        ended.push_back(std::move(entry.second));
        return true;
      });
    }
    for (const Waiting& one : ended) {
      Answer answer = all || !connected ? gone()
                                        : refusal(504, "no_answer",
                                                  "biteline-host is busy; look at the state, then ask again");
      answer.id = one.callers_id;
      if (one.on_answer) one.on_answer(std::move(answer));
    }
  }

  void say() {
    if (Clock::now() - last_hello >= k_between_hellos) {
      last_hello = Clock::now();
      static_cast<void>(socket.send({bytes_of(to_text(Hello{.door = config.door}))}));
    }
    std::deque<std::string> all;
    {
      const std::lock_guard lock{mutex};
      all.swap(outgoing);
    }
    // One that does not leave gets 504: its patience runs.
    for (const std::string& text : all) static_cast<void>(socket.send({bytes_of(text)}));
  }

  void run() {
    pthread_setname_np(pthread_self(), "bl-door");
    while (!stop) {
      say();
      wait_for({&socket}, wake, k_turn);
      hear();
      if (connected && Clock::now() - last_heard > k_silence) set_connected(false);
      end_patience(false);
    }
    end_patience(true);
  }
};

Result<std::unique_ptr<Client>> Client::open(const ClientConfig& config, OnEvent on_event, OnLink on_link) {
  BITELINE_ASSIGN(wire::SocketContext context, wire::SocketContext::create());
  BITELINE_ASSIGN(wire::Socket socket, wire::open_caller(context, config.endpoint, config.keys));
  if (zmq_setsockopt(socket.handle(), ZMQ_MAXMSGSIZE, &k_most_answer_bytes, sizeof k_most_answer_bytes) != 0)
    return fail_errno(Errc::DeviceError, zmq_errno(), "zmq_setsockopt MAXMSGSIZE");
  BITELINE_TRY(socket.connect(config.endpoint.text()));
  BITELINE_ASSIGN(Wake wake, Wake::create());
  return std::unique_ptr<Client>{
      new Client{std::make_unique<State>(config, std::move(on_event), std::move(on_link), std::move(context),
                                         std::move(socket), std::move(wake))}};
}

Client::Client(std::unique_ptr<State> state) : state_{std::move(state)} {
  state_->io = std::thread{[state = state_.get()] { state->run(); }};
}

Client::~Client() {
  state_->stop = true;
  state_->wake.ring();
  state_->io.join();
}

void Client::ask(Request request, OnAnswer on_answer) {
  const std::uint64_t callers_id = request.id;
  const bool stop = is_stop(request);
  if (request.door.empty()) request.door = state_->config.door;
  Answer refused;
  {
    const std::lock_guard lock{state_->mutex};
    if (!state_->stop && state_->waiting.size() < k_most_waiting + (stop ? k_most_stops : 0)) {
      request.id = state_->next_id++;
      std::string text = to_text(request);
      if (text.size() <= k_most_message_bytes) {
        state_->waiting.emplace(request.id, State::Waiting{.callers_id = callers_id,
                                                           .on_answer = std::move(on_answer),
                                                           .until = Clock::now() + state_->config.patience});
        // A stop leaves before all that waits to leave.
        if (stop) {
          state_->outgoing.push_front(std::move(text));
        } else {
          state_->outgoing.push_back(std::move(text));
        }
        state_->wake.ring();
        return;
      }
      refused = refusal(413, "too_long", "the request is longer than 512 KiB; send files by their own door");
    } else {
      refused = refusal(503, "busy", "too many requests wait; ask again in a second");
    }
  }
  refused.id = callers_id;
  if (on_answer) on_answer(std::move(refused));
}

Answer Client::ask(Request request) {
  std::promise<Answer> promise;
  std::future<Answer> answer = promise.get_future();
  ask(std::move(request), [&promise](Answer got) { promise.set_value(std::move(got)); });
  return answer.get();
}

bool Client::connected() const {
  return state_->connected;
}

}  // namespace biteline::control
