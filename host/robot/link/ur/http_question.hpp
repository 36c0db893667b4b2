// SPDX-License-Identifier: MIT
#pragma once
/// \file One question by HTTP to a controller, every wait bounded.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

struct HttpAnswer {
  int status{0};  ///< 200, 404, ...; a redirect is an answer like any other, and is not followed
  std::string body;
};

/// The whole text of a question.  `json`: its body; empty: none.
[[nodiscard]] std::string http_text(const Endpoint& at, const std::string& method, const std::string& target,
                                    const std::string& json = {});

/// HTTP/1.1 without TLS, a connection for each question: a server may close a kept one at any time.  Of an
/// answer 8 KiB of header and 64 KiB of body are taken.  Not thread-safe.
class HttpQuestion {
 public:
  /// Does not wait, not even for the connection.
  [[nodiscard]] static Result<HttpQuestion> begin(const Endpoint& at, std::string text);
  HttpQuestion(HttpQuestion&&) noexcept;
  HttpQuestion& operator=(HttpQuestion&&) noexcept;
  ~HttpQuestion();

  /// As far as it goes at once; nothing: not answered yet.  Errc::ConnectFailed, Errc::ConnectionLost:
  /// refused or cut off in the middle; Errc::ProtocolError: that is no HTTP, or too much of it.
  [[nodiscard]] Result<std::optional<HttpAnswer>> push();
  /// The same, for up to `patience` from now on for all of it; Errc::Timeout.
  [[nodiscard]] Result<HttpAnswer> wait(Nanoseconds patience);

 private:
  struct Parser;
  HttpQuestion();
  TcpStream stream_;
  Endpoint at_;
  std::string text_;
  std::vector<std::uint8_t> heard_;
  std::unique_ptr<Parser> parser_;
};

}  // namespace biteline::robot::ur
