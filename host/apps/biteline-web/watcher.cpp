// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/watcher.hpp"

#include <chrono>
#include <memory>

#include "host/apps/biteline-web/connection.hpp"
#include "host/apps/biteline-web/foxglove/foxglove_talk.hpp"

namespace biteline::web {
namespace {

using net::redirect_error;
using net::use_awaitable;

/// No client has anything to say that is longer.
constexpr std::size_t k_most_heard_bytes = 4096;
/// Less lies between a slow client and the newest picture than a second of a slow line.
constexpr int k_send_buffer_bytes = 256 * 1024;
constexpr std::chrono::seconds k_silence{30};

/// The reader and the writer of one client.  Both run on the loop; `ended` is how one tells the other.
class Watcher {
 public:
  Watcher(WebContext& context, WatcherRequest request)
      : context_{context},
        asked_{std::move(request)},
        socket_{asked_.stream},
        woken_{asked_.stream.get_executor()} {
    woken_.expires_at(net::steady_timer::time_point::max());
  }

  net::awaitable<void> run() {
    if (!co_await open()) co_return;
    const auto wake = [this] { woken_.cancel(); };
    if (asked_.handling == Handling::Events) {
      events_ = std::make_shared<EventQueue>(wake);
      context_.feed.add(events_);
    } else {
      live_ = std::make_shared<LiveQueue>(wake);
      context_.feed.add(live_);
      ++context_.watchers;
    }
    // The reader ends before this frame does: it uses it.
    bool reader_done = false;
    net::steady_timer reader_gone{socket_.get_executor(), net::steady_timer::time_point::max()};
    net::co_spawn(socket_.get_executor(), read_all(),
                  [this, &reader_done, &reader_gone](const std::exception_ptr& /*error*/) {
                    reader_done = true;
                    ended_ = true;
                    woken_.cancel();
                    reader_gone.cancel();
                  });
    co_await write_all();
    ErrorCode fault;
    if (!ended_) {
      net::steady_timer limit{socket_.get_executor(), std::chrono::seconds{2}};
      // One that ran out already can no longer be cancelled, and this may be gone then.
      const auto closed = std::make_shared<bool>(false);
      limit.async_wait([this, closed](ErrorCode cancelled) {
        if (!cancelled && !*closed) close();
      });
      co_await socket_.async_close(reason_, redirect_error(use_awaitable, fault));
      *closed = true;
      limit.cancel();
    }
    if (live_) --context_.watchers;
    close();
    while (!reader_done) co_await reader_gone.async_wait(redirect_error(use_awaitable, fault));
  }

 private:
  void close() {
    ErrorCode fault;
    asked_.stream.next_layer().close(fault);
  }

  net::awaitable<bool> open() {
    ErrorCode fault;
    asked_.stream.next_layer().set_option(net::socket_base::send_buffer_size{k_send_buffer_bytes}, fault);
    socket_.set_option(websocket::stream_base::timeout{
        .handshake_timeout = std::chrono::seconds{10}, .idle_timeout = k_silence, .keep_alive_pings = true});
    const auto offer = asked_.request[http::field::sec_websocket_protocol];
    const std::string_view protocol = asked_.handling == Handling::Foxglove
                                          ? choose_foxglove_protocol({offer.data(), offer.size()})
                                          : std::string_view{};
    socket_.set_option(websocket::stream_base::decorator([tls = asked_.stream.encrypted(),
                                                          protocol](websocket::response_type& answer) {
      put_security_headers(answer, k_data_policy, tls);
      if (!protocol.empty()) {
        answer.set(http::field::sec_websocket_protocol, beast::string_view{protocol.data(), protocol.size()});
      }
    }));
    socket_.read_message_max(k_most_heard_bytes);
    socket_.auto_fragment(false);
    co_await socket_.async_accept(asked_.request, redirect_error(use_awaitable, fault));
    co_return !fault;
  }

  /// What a client says is wanted of Foxglove's only; of all others its pongs and its close.
  net::awaitable<void> read_all() {
    beast::flat_buffer waste;
    ErrorCode fault;
    while (!fault) {
      co_await socket_.async_read(waste, redirect_error(use_awaitable, fault));
      if (asked_.handling == Handling::Foxglove && !fault) talk_.hear(beast::buffers_to_string(waste.data()));
      waste.clear();
    }
  }

  /// One piece of live data, in the client's own form.
  net::awaitable<void> write_live(LiveBytes bytes, ErrorCode& fault) {
    socket_.binary(true);
    if (asked_.handling != Handling::Foxglove) {
      co_await socket_.async_write(net::buffer(*bytes), redirect_error(use_awaitable, fault));
      co_return;
    }
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto now_ns = static_cast<std::uint64_t>(std::chrono::nanoseconds{since}.count());
    const std::vector<std::string> messages = talk_.messages(*bytes, now_ns);
    for (const std::string& message : messages) {
      if (!fault) co_await socket_.async_write(net::buffer(message), redirect_error(use_awaitable, fault));
    }
  }

  net::awaitable<void> write_all() {
    ErrorCode fault;
    if (asked_.handling == Handling::Foxglove) {
      const std::vector<std::string> first = FoxgloveTalk::first_words();
      socket_.text(true);
      for (const std::string& text : first) {
        if (!fault) co_await socket_.async_write(net::buffer(text), redirect_error(use_awaitable, fault));
      }
    }
    auto check_at = std::chrono::steady_clock::now() + context_.config.limits.session_check;
    while (!fault && !ended_) {
      if (std::chrono::steady_clock::now() >= check_at) {
        if (!co_await session_holds()) co_return;
        check_at = std::chrono::steady_clock::now() + context_.config.limits.session_check;
      }
      if (events_) {
        if (const auto text = events_->take()) {
          socket_.text(true);
          co_await socket_.async_write(net::buffer(*text), redirect_error(use_awaitable, fault));
          continue;
        }
      } else if (LiveBytes bytes = live_->take()) {
        co_await write_live(std::move(bytes), fault);
        continue;
      }
      ErrorCode woken;
      woken_.expires_at(check_at);
      co_await woken_.async_wait(redirect_error(use_awaitable, woken));
    }
    if (fault) ended_ = true;
  }

  net::awaitable<bool> session_holds() {
    const control::Answer who = co_await ask_who(context_, asked_.session, asked_.local);
    // A service that is away takes no session away.
    if (who.status != 401 && who.status != 403) co_return true;
    reason_ =
        websocket::close_reason{websocket::close_code::policy_error, "the session has ended: log in again"};
    co_return false;
  }

  WebContext& context_;
  WatcherRequest asked_;
  websocket::stream<WebStream&> socket_;
  net::steady_timer woken_;
  std::shared_ptr<EventQueue> events_;
  std::shared_ptr<LiveQueue> live_;
  FoxgloveTalk talk_;
  websocket::close_reason reason_{websocket::close_code::going_away};
  bool ended_{false};
};

}  // namespace

net::awaitable<void> serve_watcher(WebContext& context, WatcherRequest request) {
  Watcher watcher{context, std::move(request)};
  co_await watcher.run();
}

}  // namespace biteline::web
