// SPDX-License-Identifier: MIT
// One client: requests in, answers out.
#include "host/apps/biteline-web/connection.hpp"

#include <openssl/ssl.h>

#include <chrono>
#include <exception>
#include <memory>
#include <utility>

#include "host/apps/biteline-web/deadline.hpp"

namespace biteline::web {
namespace {

using net::redirect_error;
using net::use_awaitable;

constexpr std::size_t k_read_bytes = 4096;
/// Beyond them a connection without a place is closed without a word.
constexpr int k_most_turned_away = 32;

/// What came is no HTTP, or too much of it; other faults are the connection's.
bool is_fault_of_the_text(ErrorCode fault) {
  const ErrorCode of_http = http::error::end_of_stream;
  return fault && fault.category() == of_http.category() && fault != of_http;
}

/// A body whose end is not told in one known way: what stands behind it would be taken for another request.
ErrorCode fault_of_body(const http::request<http::empty_body>& request) {
  const std::size_t codings = request.count(http::field::transfer_encoding);
  if (codings == 0) return {};
  const bool chunked = codings == 1 && request.version() == 11 &&
                       beast::iequals(request[http::field::transfer_encoding], "chunked");
  if (!chunked) return http::error::bad_transfer_encoding;
  return request.count(http::field::content_length) > 0 ? http::error::bad_content_length : ErrorCode{};
}

/// Its body is no message but a file.
bool is_upload(const http::request<http::empty_body>& request) {
  const std::string_view target = view(request.target());
  const RouteMatch match = find_route(view(request.method_string()), target.substr(0, target.find('?')));
  return match.route != nullptr && match.route->handling == Handling::Upload;
}

}  // namespace

Connection::Connection(WebContext& context, Tcp::socket socket, std::string peer, bool local,
                       Places::Id place)
    : context_{context},
      stream_{std::move(socket), context.tls ? &*context.tls : nullptr},
      peer_{std::move(peer)},
      local_{local},
      place_{place} {
  if (place_ != 0) context_.streams.emplace(place_, &stream_);
}

Connection::~Connection() {
  context_.streams.erase(place_);
  context_.places.leave(place_);
}

net::awaitable<void> Connection::run() {
  {
    const Deadline deadline{stream_, context_.config.limits.first_time};
    if (co_await stream_.handshake()) co_return;
  }
  while (co_await one_request()) {
  }
  co_await linger();
}

net::awaitable<bool> Connection::one_request() {
  const WebLimits& limits = context_.config.limits;
  HeadParser head;
  head.header_limit(limits.header_bytes);
  head.body_limit(limits.upload_bytes);
  std::optional<http::request_parser<http::string_body>> parser;
  ErrorCode fault;
  if (buffer_.size() == 0) {
    // The time of a request begins with its first byte.
    const Deadline deadline{stream_, asked_before_ ? limits.idle_time : limits.first_time};
    const std::size_t got =
        co_await stream_.async_read_some(buffer_.prepare(k_read_bytes), redirect_error(use_awaitable, fault));
    if (fault) co_return false;
    buffer_.commit(got);
  }
  bool late = false;
  {
    // Ends with the request: an answer has limits of its own, and a WebSocket stays for as long as both want.
    const Deadline deadline{stream_, limits.request_time};
    co_await http::async_read_header(stream_, buffer_, head, redirect_error(use_awaitable, fault));
    if (!fault) fault = fault_of_body(head.get());
    if (!fault && !is_upload(head.get())) {
      if (head.content_length().value_or(0) > limits.body_bytes) {
        fault = http::error::body_limit;
      } else {
        parser.emplace(std::move(head));
        parser->body_limit(limits.body_bytes);
        co_await http::async_read(stream_, buffer_, *parser, redirect_error(use_awaitable, fault));
      }
    }
    late = deadline.over();
  }
  if (late || is_fault_of_the_text(fault)) {
    co_await refuse_unread(late, fault, is_upload(head.get()) ? limits.upload_bytes : limits.body_bytes);
    co_return false;
  }
  if (fault) co_return false;
  if (!asked_before_) context_.places.stand(place_, Places::Standing::Stranger);
  asked_before_ = true;
  if (!parser) {
    ++context_.requests;
    co_await take_upload(head);
    co_return keep_alive_;
  }
  ++context_.requests;
  const WebRequest request = parser->release();
  keep_alive_ = request.keep_alive();
  head_only_ = request.method() == http::verb::head;
  co_await answer(request);
  co_return keep_alive_ && !upgraded_;
}

net::awaitable<void> Connection::refuse_unread(bool late, ErrorCode fault, std::uint64_t most_bytes) {
  ++context_.requests;
  keep_alive_ = false;
  head_only_ = false;
  if (late) {
    co_await send(error_answer(408, "too_slow", "the request did not come within the time limit"));
  } else if (fault == http::error::header_limit) {
    co_await send(error_answer(431, "header_too_large",
                               "the request's header has more than " +
                                   std::to_string(context_.config.limits.header_bytes) + " bytes"));
  } else if (fault == http::error::body_limit) {
    co_await send(error_answer(413, "too_large",
                               "the request's body has more than " + std::to_string(most_bytes) + " bytes"));
  } else if (fault == http::error::bad_transfer_encoding) {
    co_await send(error_answer(501, "bad_request", "Transfer-Encoding: chunked alone is known"));
  } else {
    co_await send(error_answer(400, "bad_request", "no HTTP/1.1 request: " + fault.message()));
  }
}

net::awaitable<void> Connection::send(WebAnswer answer, std::string_view policy) {
  const unsigned status = answer.result_int();
  if (status >= 400 && status < 500) ++context_.refused;
  put_security_headers(answer, policy, stream_.encrypted());
  answer.keep_alive(keep_alive_);
  if (status == 204) {
    answer.body().clear();
    answer.erase(http::field::content_type);
  } else {
    answer.content_length(answer.body().size());
  }
  if (head_only_) answer.body().clear();
  ErrorCode fault;
  const Deadline deadline{stream_, context_.config.limits.answer_time};
  http::response_serializer<http::string_body> serializer{answer};
  if (head_only_) {
    co_await http::async_write_header(stream_, serializer, redirect_error(use_awaitable, fault));
  } else {
    co_await http::async_write(stream_, serializer, redirect_error(use_awaitable, fault));
  }
  if (fault) keep_alive_ = false;
}

/// Lets the client read the last answer: a connection that is closed while bytes of it are unread is reset,
/// and the answer lost.
net::awaitable<void> Connection::linger() {
  constexpr std::size_t k_most_bytes = 1U << 20U;
  constexpr std::chrono::milliseconds k_time{1000};
  ErrorCode fault;
  if (upgraded_) co_return;
  stream_.next_layer().shutdown(Tcp::socket::shutdown_send, fault);
  const Deadline deadline{stream_, k_time};
  std::string waste(4096, '\0');
  for (std::size_t swallowed = 0; !fault && swallowed < k_most_bytes && !deadline.over();) {
    swallowed += co_await stream_.next_layer().async_read_some(net::buffer(waste),
                                                               redirect_error(use_awaitable, fault));
  }
}

net::awaitable<void> Connection::turn_away() {
  keep_alive_ = false;
  {
    const Deadline deadline{stream_, context_.config.limits.first_time};
    if (co_await stream_.handshake()) co_return;
  }
  co_await send(error_answer(503, "too_busy", "too many connections: close some, then try again"));
  co_await linger();
}

net::awaitable<void> serve_connection(WebContext& context, Tcp::socket socket) {
  ErrorCode fault;
  const auto remote = socket.remote_endpoint(fault).address();
  if (fault) co_return;
  const auto own = socket.local_endpoint(fault).address();
  if (fault) co_return;
  socket.set_option(Tcp::no_delay{true}, fault);
  const std::string peer = remote.to_string();
  const bool local = remote.is_loopback() || remote == own;
  const std::optional<Places::Taken> place = context.places.take(peer, local);
  if (place && place->gives_way) {
    // Its own coroutine finds the socket closed, and ends.
    if (const auto found = context.streams.find(*place->gives_way); found != context.streams.end())
      found->second->next_layer().close(fault);
  }
  if (!place && context.turned_away >= k_most_turned_away) co_return;
  const Places::Id id = place ? place->id : 0;
  if (!place) ++context.turned_away;
  {
    Connection connection{context, std::move(socket), peer, local, id};
    try {
      if (place) {
        co_await connection.run();
      } else {
        co_await connection.turn_away();
      }
    } catch (const std::exception& /*error*/) {
      // Out of memory for this one client: it goes, the others stay.
      ++context.refused;
    }
  }
  if (!place) --context.turned_away;
}

}  // namespace biteline::web
