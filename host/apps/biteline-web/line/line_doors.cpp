// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/line/line_doors.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>
#include <tuple>
#include <utility>

#include "common/system/file.hpp"
#include "host/apps/biteline-web/line/line_socket.hpp"
#include "host/apps/biteline-web/line/line_talk.hpp"
#include "host/interfaces/control/poll.hpp"

namespace biteline::web {
namespace {

using Clock = std::chrono::steady_clock;
using line_control::LineState;
using line_control::Refusal;
using std::chrono::milliseconds;

/// How old the state is that peers read, at most, while the service answers.
constexpr milliseconds k_between_reads{100};
constexpr milliseconds k_between_beats{1000};
/// A state that is older is none.
constexpr milliseconds k_state_lives{2000};
constexpr std::size_t k_most_token_bytes = 256;
/// For so long after a request a peer counts as at work: a control reads some times a second.
constexpr milliseconds k_at_work{5000};

/// What must be asked of the service before a command can be answered.
struct Pending {
  LineCommand command;
  std::deque<control::Request> steps;
};

struct Peer {
  Socket socket;
  std::string address;
  bool asked{false};  ///< a whole request has come
  std::vector<std::uint8_t> in;
  Clock::time_point last_request;
  Clock::time_point first_byte;  ///< of what stands in `in`
  std::optional<Pending> pending;
  int stops_said{0};  ///< of what stands in `in`
  bool ended{false};  ///< it says no more
};

struct Door {
  std::unique_ptr<LineTalk> talk;
  Socket listener;
  std::uint16_t port{0};
  std::map<std::uint64_t, Peer> peers;
  Refusal refusal{Refusal::None};  ///< of its last command
};

control::Request request_of(const LineTalk& talk, const char* method, const char* path,
                            control::Json body = {}) {
  control::Request request;
  request.door = talk.name();
  request.method = method;
  request.path = path;
  request.body = std::move(body);
  return request;
}

constexpr const char* k_line = "/api/v1/line";

/// The refusal of a command's answer; a service that is away is one, too.
Refusal refusal_of(const control::Answer& answer) {
  if (answer.status != 200 || !answer.body.is_object()) return Refusal::HostAway;
  const auto found = answer.body.find("refusal");
  if (found == answer.body.end() || !found->is_number_integer()) return Refusal::HostAway;
  const auto number = found->get<std::int64_t>();
  constexpr auto k_last = static_cast<std::int64_t>(Refusal::BadRequest);
  return number < 0 || number > k_last ? Refusal::HostAway : static_cast<Refusal>(number);
}

}  // namespace

struct LineDoors::State {
  LineDoorsConfig config;
  control::Wake wake;
  std::array<Door, 2> doors{};
  std::vector<std::string> allowed{};

  LineState line{};
  Clock::time_point heard{};  ///< the state
  Clock::time_point asked{};  ///< for the state
  bool asking{false};
  Clock::time_point beat_at{};
  std::uint16_t heartbeat{0};
  std::uint64_t next_peer{1};

  struct Mail {
    std::size_t door;  ///< k_no_door: the state, for all
    std::uint64_t peer;
    control::Answer answer;
  };
  static constexpr std::size_t k_no_door = 99;
  static constexpr std::size_t k_nobody = 98;  ///< the answer is for nobody
  std::mutex mutex{};
  std::vector<Mail> mail{};
  std::string token{};  ///< of the service that said hello last
  std::atomic<bool> stop{false};
  std::unique_ptr<ServiceDoor> service{};  // its callbacks use the rest
  std::thread thread{};

  State(LineDoorsConfig config_, control::Wake wake_) : config{std::move(config_)}, wake{std::move(wake_)} {}

  [[nodiscard]] Result<void> listen(Door& door, const LineListener& at, const char* option) const;
  void run();
  void wait();
  void hear(const control::Event& event);
  void ask(std::size_t door, std::uint64_t peer, control::Request request);
  void ask_state(Clock::time_point now);
  void take_mail();
  void take_state(const control::Answer& answer);
  void take_answer(Door& door, std::size_t index, std::uint64_t id, const control::Answer& answer);
  void accept(Door& door, Clock::time_point now);
  /// Ends a peer that asks nothing.  False: all are at work.
  [[nodiscard]] static bool make_room(Door& door, Clock::time_point now);
  /// False: the connection ends, here and below.
  [[nodiscard]] bool read(std::size_t index, std::uint64_t id, Peer& peer, Clock::time_point now);
  [[nodiscard]] bool serve(std::size_t index, std::uint64_t id, Peer& peer, Clock::time_point now);
  /// A stop behind a command that waits for the service waits for nothing.
  void hear_stop(std::size_t index, Peer& peer);
  [[nodiscard]] bool answer(Door& door, const Peer& peer, const LineCommand& command);
  void end_late(Clock::time_point now);
};

Result<void> LineDoors::State::listen(Door& door, const LineListener& at, const char* option) const {
  BITELINE_ASSIGN(Listening listening, listen_for_line(at, !allowed.empty(), option));
  door.listener = std::move(listening.socket);
  door.port = listening.port;
  return {};
}

void LineDoors::State::hear(const control::Event& event) {
  if (event.name != "hello") return;
  const auto results = event.data.find("results");
  if (results == event.data.end() || !results->is_string()) return;
  const std::filesystem::path file =
      std::filesystem::path{results->get<std::string>()} / line_control::k_token_file;
  // None where the service has no jobs, or knows this program by its keys.
  const Result<std::string> text = read_regular_file(file, k_most_token_bytes);
  if (!text && text.error().code != Errc::FileNotFound)
    std::fprintf(stderr, "biteline-web: %s: a line's starts are refused; run as the service's user\n",
                 to_line(text.error()).c_str());
  const std::lock_guard lock{mutex};
  token = text ? text->substr(0, text->find('\n')) : std::string{};
}

void LineDoors::State::ask(std::size_t door, std::uint64_t peer, control::Request request) {
  {
    const std::lock_guard lock{mutex};
    request.token = token;
  }
  service->ask(std::move(request), [this, door, peer](control::Answer answer) {
    {
      const std::lock_guard lock{mutex};
      mail.push_back({.door = door, .peer = peer, .answer = std::move(answer)});
    }
    wake.ring();
  });
}

void LineDoors::State::ask_state(Clock::time_point now) {
  if (asking || now - asked < k_between_reads) return;
  asking = true;
  asked = now;
  // Read in the name of a door that is open; both read the same.
  const Door& door = doors[0].talk ? doors[0] : doors[1];
  ask(k_no_door, 0, request_of(*door.talk, "GET", k_line));
}

void LineDoors::State::take_state(const control::Answer& answer) {
  std::optional<LineState> state;
  if (answer.status == 200) state = line_control::line_state_of(answer.body);
  if (!state) return;
  line = *state;
  heard = Clock::now();
}

void LineDoors::State::take_answer(Door& door, std::size_t index, std::uint64_t id,
                                   const control::Answer& answer_) {
  const auto found = door.peers.find(id);
  if (found == door.peers.end() || !found->second.pending) return;  // it has left
  Peer& peer = found->second;
  Pending& pending = *peer.pending;
  const bool was_reading = pending.steps.front().method == "GET";
  pending.steps.pop_front();
  if (was_reading) {
    take_state(answer_);
  } else {
    door.refusal = refusal_of(answer_);
    // A start for another job or shoe than the one that was asked for is none.
    if (door.refusal != Refusal::None) pending.steps.erase(pending.steps.begin(), pending.steps.end() - 1);
  }
  if (!pending.steps.empty()) return ask(index, id, pending.steps.front());
  const LineCommand command = std::move(pending.command);
  peer.pending.reset();
  const Clock::time_point now = Clock::now();
  peer.first_byte = now;
  const bool goes_on = answer(door, peer, command) && serve(index, id, peer, now);
  if (!goes_on || (peer.ended && !peer.pending)) door.peers.erase(found);
}

void LineDoors::State::take_mail() {
  std::vector<Mail> come;
  {
    const std::lock_guard lock{mutex};
    come.swap(mail);
  }
  for (const Mail& one : come) {
    if (one.door == k_no_door) {
      asking = false;
      take_state(one.answer);
    } else if (one.door != k_nobody) {
      take_answer(doors.at(one.door), one.door, one.peer, one.answer);
    }
  }
}

void LineDoors::State::accept(Door& door, Clock::time_point now) {
  for (;;) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    Socket socket{::accept4(door.listener.get(), reinterpret_cast<sockaddr*>(&from), &size,
                            SOCK_CLOEXEC | SOCK_NONBLOCK)};
    if (socket.get() < 0) {
      // No descriptors left: others go on; not in a busy loop.
      if (errno == EMFILE || errno == ENFILE) std::this_thread::sleep_for(milliseconds{50});
      return;
    }
    std::string address = text_of(from);
    if (!allowed.empty() && std::ranges::find(allowed, address) == allowed.end()) continue;  // turned away
    if (std::ssize(door.peers) >= config.limits.peers && !make_room(door, now)) continue;
    door.peers.emplace(next_peer++, Peer{.socket = std::move(socket),
                                         .address = std::move(address),
                                         .in = {},
                                         .last_request = now,
                                         .first_byte = now,
                                         .pending = {}});
  }
}

bool LineDoors::State::make_room(Door& door, Clock::time_point now) {
  std::map<std::string, int> of_address;
  for (const auto& [id, peer] : door.peers) ++of_address[peer.address];
  auto chosen = door.peers.end();
  for (auto one = door.peers.begin(); one != door.peers.end(); ++one) {
    const Peer& peer = one->second;
    const bool at_work = peer.pending || (peer.asked && now - peer.last_request < k_at_work);
    if (at_work) continue;
    // Who never asked goes first, then whose address has the most, then who has been silent longest.
    const auto weight = [&](const Peer& of) {
      return std::tuple{!of.asked, of_address[of.address], now - of.last_request};
    };
    if (chosen == door.peers.end() || weight(peer) > weight(chosen->second)) chosen = one;
  }
  if (chosen == door.peers.end()) return false;
  door.peers.erase(chosen);
  return true;
}

bool LineDoors::State::read(std::size_t index, std::uint64_t id, Peer& peer, Clock::time_point now) {
  std::array<std::uint8_t, k_most_request_bytes> bytes{};
  const ssize_t got = ::recv(peer.socket.get(), bytes.data(), bytes.size(), 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  // Who has said all still gets the answer that it waits for.
  if (got == 0) peer.ended = true;
  if (got == 0) return peer.pending.has_value();
  if (peer.in.empty()) peer.first_byte = now;
  peer.in.insert(peer.in.end(), bytes.begin(), bytes.begin() + got);
  return serve(index, id, peer, now);
}

bool LineDoors::State::serve(std::size_t index, std::uint64_t id, Peer& peer, Clock::time_point now) {
  Door& door = doors.at(index);
  while (!peer.pending && !peer.in.empty()) {
    LineCut cut = door.talk->cut(peer.in);
    if (cut.garbled || cut.farewell) return false;
    if (cut.used == 0) return peer.in.size() < k_most_request_bytes;
    peer.in.erase(peer.in.begin(), peer.in.begin() + static_cast<std::ptrdiff_t>(cut.used));
    peer.last_request = peer.first_byte = now;
    peer.asked = peer.asked || cut.command.fault == 0;
    if (cut.last) return static_cast<void>(answer(door, peer, cut.command)), false;
    const bool commands = cut.command.fault == 0 &&
                          (cut.command.job || cut.command.part || cut.command.start || cut.command.stop);
    if (!commands) {
      if (!answer(door, peer, cut.command)) return false;
      continue;
    }
    Pending pending{.command = std::move(cut.command), .steps = {}};
    if (pending.command.stop) {
      // Of a request that says more than that a stop is meant.  One that was heard before is done.
      if (peer.stops_said == 0) {
        pending.steps.push_back(request_of(*door.talk, "POST", control::k_line_stop_path));
      } else {
        --peer.stops_said;
        door.refusal = Refusal::None;
      }
    } else {
      if (pending.command.job)
        pending.steps.push_back(
            request_of(*door.talk, "PUT", "/api/v1/line/job", {{"job", *pending.command.job}}));
      if (pending.command.part)
        pending.steps.push_back(
            request_of(*door.talk, "PUT", "/api/v1/line/part", {{"part", *pending.command.part}}));
      if (pending.command.start)
        pending.steps.push_back(
            request_of(*door.talk, "POST", "/api/v1/line/start", {{"request", *pending.command.start}}));
    }
    // What the peer reads next shows what its command did.
    pending.steps.push_back(request_of(*door.talk, "GET", k_line));
    peer.pending = std::move(pending);
    ask(index, id, peer.pending->steps.front());
  }
  if (peer.pending) hear_stop(index, peer);
  return true;
}

void LineDoors::State::hear_stop(std::size_t index, Peer& peer) {
  const LineTalk& talk = *doors.at(index).talk;
  std::span<const std::uint8_t> rest = peer.in;
  int stops = 0;
  while (!rest.empty()) {
    const LineCut cut = talk.cut(rest);
    if (cut.garbled || cut.farewell || cut.used == 0) break;
    if (cut.command.fault == 0 && cut.command.stop) ++stops;
    rest = rest.subspan(cut.used);
  }
  if (stops <= peer.stops_said) return;
  peer.stops_said = stops;
  ask(k_nobody, 0, request_of(talk, "POST", control::k_line_stop_path));
}

bool LineDoors::State::answer(Door& door, const Peer& peer, const LineCommand& command) {
  const bool known = heard != Clock::time_point{} && Clock::now() - heard < k_state_lives;
  const LineNews news{.state = known ? line : LineState{}, .heartbeat = heartbeat, .refusal = door.refusal};
  const std::string reply = door.talk->answer(command, news);
  if (reply.empty()) return false;
  // A peer whose socket has no room for one answer has not read for long.
  const ssize_t sent = ::send(peer.socket.get(), reply.data(), reply.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(reply.size());
}

void LineDoors::State::end_late(Clock::time_point now) {
  for (Door& door : doors) {
    std::erase_if(door.peers, [&](const auto& one) {
      const Peer& peer = one.second;
      if (peer.pending) return false;  // the service's patience ends it
      if (!peer.in.empty()) return now - peer.first_byte > config.limits.request_time;
      return now - peer.last_request > config.limits.idle_time;
    });
  }
}

void LineDoors::State::wait() {
  std::vector<pollfd> polled{{.fd = wake.handle(), .events = POLLIN, .revents = 0}};
  struct Whose {
    std::size_t door;
    std::uint64_t peer;  ///< 0: the listener
  };
  std::vector<Whose> whose{{.door = k_no_door, .peer = 0}};
  for (std::size_t i = 0; i < doors.size(); ++i) {
    if (!doors[i].talk) continue;
    polled.push_back({.fd = doors[i].listener.get(), .events = POLLIN, .revents = 0});
    whose.push_back({.door = i, .peer = 0});
    for (const auto& [id, peer] : doors[i].peers) {
      // Who waits for an answer is read on for a stop; its further requests wait.
      const bool full = peer.pending && peer.in.size() >= k_most_request_bytes;
      const auto events = static_cast<short>(full || peer.ended ? 0 : POLLIN);
      polled.push_back({.fd = peer.socket.get(), .events = events, .revents = 0});
      whose.push_back({.door = i, .peer = id});
    }
  }
  ::poll(polled.data(), polled.size(), static_cast<int>(k_between_reads.count()));
  wake.silence();
  const Clock::time_point now = Clock::now();
  for (std::size_t i = 1; i < polled.size(); ++i) {
    if (polled[i].revents == 0) continue;
    Door& door = doors.at(whose[i].door);
    if (whose[i].peer == 0) {
      accept(door, now);
      continue;
    }
    const auto found = door.peers.find(whose[i].peer);
    if (found == door.peers.end()) continue;
    const bool goes_on = (polled[i].revents & POLLIN) != 0
                             ? read(whose[i].door, whose[i].peer, found->second, now)
                             : (polled[i].revents & (POLLHUP | POLLERR | POLLNVAL)) == 0;
    if (!goes_on) door.peers.erase(found);
  }
}

void LineDoors::State::run() {
  pthread_setname_np(pthread_self(), "bl-doors");
  while (!stop) {
    const Clock::time_point now = Clock::now();
    ask_state(now);
    if (now - heard < k_state_lives && now - beat_at >= k_between_beats) {
      ++heartbeat;
      beat_at = now;
    }
    wait();
    take_mail();
    end_late(Clock::now());
  }
}

LineDoors::LineDoors(std::unique_ptr<State> state) : state_{std::move(state)} {}

LineDoors::~LineDoors() {
  state_->stop = true;
  state_->wake.ring();
  if (state_->thread.joinable()) state_->thread.join();
  // Its last answers still find the mail.
  state_->service.reset();
}

Result<std::unique_ptr<LineDoors>> LineDoors::open(const LineDoorsConfig& config,
                                                   std::unique_ptr<ServiceDoor> service) {
  BITELINE_ASSIGN(control::Wake wake, control::Wake::create());
  auto state = std::make_unique<State>(config, std::move(wake));
  for (const std::string& peer : config.peers) {
    state->allowed.push_back(text_of_address(peer));
    if (state->allowed.back().empty())
      return fail(Errc::InvalidArgument, "--line-peer %.60s: an address expected, e.g. 192.0.2.7",
                  peer.c_str());
  }
  if (config.modbus) {
    BITELINE_ASSIGN(state->doors[0].talk, modbus_talk());
    BITELINE_TRY(state->listen(state->doors[0], *config.modbus, "--modbus"));
  }
  if (config.text) {
    state->doors[1].talk = text_talk();
    BITELINE_TRY(state->listen(state->doors[1], *config.text, "--text"));
  }
  if (!config.modbus && !config.text) return fail(Errc::InvalidArgument, "--modbus or --text expected");
  state->service = std::move(service);
  State* const running = state.get();
  running->service->listen([running](const control::Event& event) { running->hear(event); });
  state->thread = std::thread{[running] { running->run(); }};
  return std::unique_ptr<LineDoors>{new LineDoors{std::move(state)}};
}

std::uint16_t LineDoors::modbus_port() const {
  return state_->doors[0].port;
}

std::uint16_t LineDoors::text_port() const {
  return state_->doors[1].port;
}

}  // namespace biteline::web
