// SPDX-License-Identifier: MIT
#pragma once
/// \file A connection with or without TLS as one type, so that the rest is compiled once.

#include <memory>
#include <optional>

#include "host/apps/biteline-web/beast.hpp"

namespace biteline::web {

/// An AsyncStream of Beast.  Thread: the event loop's.
class WebStream {
 public:
  using next_layer_type = Tcp::socket;
  using executor_type = Tcp::socket::executor_type;

  WebStream(Tcp::socket socket, net::ssl::context* tls)
      : socket_{std::make_unique<Tcp::socket>(std::move(socket))} {
    if (tls != nullptr) tls_ = std::make_unique<net::ssl::stream<Tcp::socket&>>(*socket_, *tls);
  }

  executor_type get_executor() { return socket_->get_executor(); }
  next_layer_type& next_layer() { return *socket_; }
  [[nodiscard]] const next_layer_type& next_layer() const { return *socket_; }
  [[nodiscard]] bool encrypted() const { return tls_ != nullptr; }

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    if (tls_) return tls_->async_read_some(buffers, std::forward<Token>(token));
    return socket_->async_read_some(buffers, std::forward<Token>(token));
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    if (tls_) return tls_->async_write_some(buffers, std::forward<Token>(token));
    return socket_->async_write_some(buffers, std::forward<Token>(token));
  }

  /// Nothing to do without TLS.
  net::awaitable<ErrorCode> handshake() {
    ErrorCode fault;
    if (tls_) {
      co_await tls_->async_handshake(net::ssl::stream_base::server,
                                     net::redirect_error(net::use_awaitable, fault));
    }
    co_return fault;
  }

 private:
  std::unique_ptr<Tcp::socket> socket_;
  std::unique_ptr<net::ssl::stream<Tcp::socket&>> tls_;
};

/// Beast's hooks for the end of a WebSocket: the TCP connection ends with it.
inline void teardown(beast::role_type /*role*/, WebStream& stream, ErrorCode& fault) {
  stream.next_layer().shutdown(Tcp::socket::shutdown_both, fault);
}
template <class Handler>
void async_teardown(beast::role_type role, WebStream& stream, Handler&& handler) {
  ErrorCode fault;
  teardown(role, stream, fault);
  net::post(stream.get_executor(), beast::bind_front_handler(std::forward<Handler>(handler), ErrorCode{}));
}

}  // namespace biteline::web
