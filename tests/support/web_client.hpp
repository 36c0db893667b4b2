// SPDX-License-Identifier: MIT
#pragma once
/// \file A client of HTTP and WebSocket over a bare socket: sends exactly the bytes that a test wants.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace biteline::test {

struct WebReply {
  int status{0};  ///< 0: the connection ended without an answer
  std::string headers;
  std::string body;

  /// Of a header, by its name in lower case; empty: it is not there.
  [[nodiscard]] std::string header(const std::string& name) const {
    std::string lower = headers;
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    const std::size_t at = lower.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 4;
    return headers.substr(begin, headers.find("\r\n", begin) - begin);
  }
};

class WebClient {
 public:
  explicit WebClient(std::uint16_t port) : fd_{socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) end();
  }
  WebClient(WebClient&& other) noexcept : fd_{std::exchange(other.fd_, -1)}, read_{std::move(other.read_)} {}
  WebClient& operator=(WebClient&&) = delete;
  ~WebClient() { end(); }

  [[nodiscard]] bool connected() const { return fd_ >= 0; }
  void end() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

  void send(const std::string& bytes) const {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t now = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += static_cast<std::size_t>(now);
    }
  }

  /// One answer; the limit guards against a hang alone.
  WebReply receive() {
    WebReply reply;
    std::size_t end = 0;
    while ((end = read_.find("\r\n\r\n")) == std::string::npos) {
      if (!read_more()) return reply;
    }
    reply.headers = "\r\n" + read_.substr(0, end + 2);
    reply.status = std::atoi(read_.substr(9, 3).c_str());
    read_.erase(0, end + 4);
    const std::string length = reply.header("content-length");
    const std::size_t bytes = length.empty() ? 0 : std::stoul(length);
    while (reply.status != 101 && read_.size() < bytes && read_more()) {
    }
    reply.body = read_.substr(0, bytes);
    read_.erase(0, std::min(bytes, read_.size()));
    return reply;
  }

  /// `method` and `path`, further header lines (each with its end), a body.
  WebReply ask(const std::string& method, const std::string& path, const std::string& headers = "",
               const std::string& body = "") {
    std::string text = method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers;
    if (!body.empty()) {
      text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
    }
    send(text + "\r\n" + body);
    return receive();
  }

  /// Asks for a WebSocket; 101 when it is one.
  WebReply upgrade(const std::string& path, const std::string& headers = "") {
    return ask("GET", path,
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                   headers);
  }

  struct Frame {
    int opcode{0};  ///< RFC 6455, 5.2: 1 text, 2 binary, 8 close, 9 ping
    std::string content;
  };
  /// One whole frame; nothing: the connection has ended.
  std::optional<Frame> frame() {
    if (!have(2)) return std::nullopt;
    const int opcode = byte(0) & 0x0F;
    std::size_t length = byte(1) & 0x7F;
    std::size_t begin = 2;
    if (length >= 126) {
      const std::size_t bytes = length == 126 ? 2 : 8;
      if (!have(2 + bytes)) return std::nullopt;
      length = 0;
      for (std::size_t i = 0; i < bytes; ++i) length = length * 256 + byte(2 + i);
      begin += bytes;
    }
    if (!have(begin + length)) return std::nullopt;
    Frame frame{.opcode = opcode, .content = read_.substr(begin, length)};
    read_.erase(0, begin + length);
    return frame;
  }

  /// True: something can be read, or the other side has ended it.
  [[nodiscard]] bool readable(int patience_ms) const {
    pollfd poller{.fd = fd_, .events = POLLIN, .revents = 0};
    return !read_.empty() || poll(&poller, 1, patience_ms) > 0;
  }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  static constexpr int k_hang_ms = 120'000;

  [[nodiscard]] std::size_t byte(std::size_t at) const { return static_cast<unsigned char>(read_[at]); }
  bool have(std::size_t bytes) {
    while (read_.size() < bytes) {
      if (!read_more()) return false;
    }
    return true;
  }
  bool read_more() {
    pollfd poller{.fd = fd_, .events = POLLIN, .revents = 0};
    if (fd_ < 0 || poll(&poller, 1, k_hang_ms) <= 0) return false;
    std::string piece(65536, '\0');
    const ssize_t got = recv(fd_, piece.data(), piece.size(), 0);
    if (got <= 0) return false;
    read_.append(piece, 0, static_cast<std::size_t>(got));
    return true;
  }

  int fd_{-1};
  std::string read_;
};

}  // namespace biteline::test
