// SPDX-License-Identifier: MIT
#include "host/fleet/metrics.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <string_view>
#include <thread>

#include "host/interfaces/control/exposition.hpp"

namespace biteline::fleet {
namespace {

using control::Exposition;
using control::metric_label;
using Clock = std::chrono::steady_clock;

constexpr std::size_t k_most_request_bytes = 8 * 1024;
constexpr std::chrono::milliseconds k_patience{2000};
constexpr int k_backlog = 8;
constexpr int k_look_ms = 100;

std::string cell_label(const std::string& cell) {
  return metric_label("cell", cell);
}

struct Column {
  const char* name;
  const char* type;
  const char* help;
  double (*value)(const CellRow&);
};
constexpr std::array k_columns{
    Column{"cell_online", "gauge", "1 while the cell's uplink has a line to the broker.",
           [](const CellRow& cell) { return cell.online ? 1.0 : 0.0; }},
    Column{"cell_heard_timestamp_seconds", "gauge", "When the cell was heard last [s since 1970].",
           [](const CellRow& cell) { return static_cast<double>(cell.heard_ms) / 1000; }},
    Column{"cell_waiting", "gauge", "Shoes that waited at the cell when it was heard last.",
           [](const CellRow& cell) { return static_cast<double>(cell.waiting); }},
};

void write_shoes(Exposition& out, std::span<const CellRow> cells) {
  out.head("shoes_total", "counter", "Shoes of a cell in the database, by verdict.");
  for (const CellRow& cell : cells) {
    for (const auto& [verdict, count] :
         {std::pair{"ok", cell.ok}, std::pair{"amber", cell.amber}, std::pair{"review", cell.review},
          std::pair{"refused", cell.refused}, std::pair{"failed", cell.failed}}) {
      out.value(cell_label(cell.cell) + "," + metric_label("verdict", verdict), static_cast<double>(count));
    }
  }
  out.head("cell_last_shoe_timestamp_seconds", "gauge", "The cell's last shoe [s since 1970].");
  for (const CellRow& cell : cells) {
    if (cell.last_shoe_ms) out.value(cell_label(cell.cell), static_cast<double>(*cell.last_shoe_ms) / 1000);
  }
}

/// False: the peer is late or gone.
bool wait_for(int fd, short events, Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
  pollfd polled{.fd = fd, .events = events, .revents = 0};
  return left > 0 && ::poll(&polled, 1, static_cast<int>(left)) > 0;
}

/// Of `Authorization: Bearer TOKEN`; empty: there is none.  Names of headers and the scheme in any case
/// (RFC 9110).
std::string token_in(const std::string& request) {
  std::string lower = request;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::string_view k_header = "\r\nauthorization: bearer ";
  const std::size_t at = lower.find(k_header);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + k_header.size();
  return request.substr(begin, request.find_first_of(" \r\n", begin) - begin);
}

struct Reply {
  const char* head;  ///< status, and the headers of that status
  std::string_view content;
};

Reply reply_to(const std::string& request, const std::string& body, const MetricsPort::MayRead& may_read) {
  if (!request.starts_with("GET /metrics ")) return {"404 Not Found", "GET /metrics expected\n"};
  if (!may_read(token_in(request)))
    return {"401 Unauthorized\r\nWWW-Authenticate: Bearer",
            "a token expected, see biteline-fleet --metrics-token\n"};
  return {"200 OK", body};
}

void answer(int fd, const std::string& body, const MetricsPort::MayRead& may_read) {
  const Clock::time_point until = Clock::now() + k_patience;
  std::string request;
  while (request.find("\r\n\r\n") == std::string::npos) {
    std::array<char, 1024> bytes{};
    if (request.size() > k_most_request_bytes || !wait_for(fd, POLLIN, until)) return;
    const ssize_t got = ::recv(fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got <= 0) return;
    request.append(bytes.data(), static_cast<std::size_t>(got));
  }
  const auto [head, content] = reply_to(request, body, may_read);
  std::string reply = "HTTP/1.1 ";
  reply.append(head)
      .append("\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\nConnection: close\r\n")
      .append("Content-Length: ")
      .append(std::to_string(content.size()))
      .append("\r\n\r\n")
      .append(content);
  for (std::size_t sent = 0; sent < reply.size();) {
    if (!wait_for(fd, POLLOUT, until)) return;
    const ssize_t now = ::send(fd, reply.data() + sent, reply.size() - sent, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (now <= 0) return;
    sent += static_cast<std::size_t>(now);
  }
  ::shutdown(fd, SHUT_WR);
}

}  // namespace

std::string metrics_text(const FleetNews& news) {
  Exposition out{"biteline_fleet_"};
  out.head("broker_up", "gauge", "1 while the centre has a line to the broker.");
  out.value("", news.broker ? 1 : 0);
  out.head("database_up", "gauge", "1 while the database answers.");
  out.value("", news.database ? 1 : 0);
  out.head("taken_total", "counter", "Shoes that came from the broker, also those that come again.");
  out.value("", static_cast<double>(news.taken));
  for (const Column& column : k_columns) {
    out.head(column.name, column.type, column.help);
    for (const CellRow& cell : news.cells) out.value(cell_label(cell.cell), column.value(cell));
  }
  write_shoes(out, news.cells);
  out.head("cell_odd_mm", "gauge",
           "How far the cell's lines of a model lie off the other cells' [mm]; only where they do.");
  for (const OddOfModel& one : news.odd)
    out.value(cell_label(one.odd.cell) + "," + metric_label("model", one.model), one.odd.mm);
  return out.take();
}

struct MetricsPort::State {
  int listener{-1};
  std::uint16_t port{0};
  std::mutex mutex{};
  std::string text{};
  MayRead may_read{};
  std::atomic<bool> stop{false};
  std::thread thread{};

  ~State() {
    if (listener >= 0) ::close(listener);
  }

  void run() {
    pthread_setname_np(pthread_self(), "bl-metrics");
    while (!stop) {
      pollfd polled{.fd = listener, .events = POLLIN, .revents = 0};
      if (::poll(&polled, 1, k_look_ms) <= 0) continue;
      const int client = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
      if (client < 0) {
        // No descriptors left: not in a busy loop.
        std::this_thread::sleep_for(std::chrono::milliseconds{k_look_ms});
        continue;
      }
      std::string body;
      {
        const std::lock_guard lock{mutex};
        body = text;
      }
      answer(client, body, may_read);
      ::close(client);
    }
  }
};

MetricsPort::MetricsPort(std::unique_ptr<State> state) : state_{std::move(state)} {}

MetricsPort::~MetricsPort() {
  state_->stop = true;
  if (state_->thread.joinable()) state_->thread.join();
}

Result<std::unique_ptr<MetricsPort>> MetricsPort::open(std::uint16_t port, MayRead may_read) {
  auto state = std::make_unique<State>();
  state->may_read = std::move(may_read);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const at = reinterpret_cast<sockaddr*>(&address);
  state->listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  ::setsockopt(state->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (state->listener < 0 || ::bind(state->listener, at, size) != 0 ||
      ::listen(state->listener, k_backlog) != 0 || ::getsockname(state->listener, at, &size) != 0)
    return fail_errno(Errc::PeerRefused, errno, "--metrics %u: cannot listen there; choose another port",
                      unsigned{port});
  state->port = ntohs(address.sin_port);
  State* const running = state.get();
  state->thread = std::thread{[running] { running->run(); }};
  return std::unique_ptr<MetricsPort>{new MetricsPort{std::move(state)}};
}

std::uint16_t MetricsPort::port() const {
  return state_->port;
}

void MetricsPort::show(std::string text) {
  const std::lock_guard lock{state_->mutex};
  state_->text = std::move(text);
}

}  // namespace biteline::fleet
