// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/http_question.hpp"

#include <poll.h>

#include <algorithm>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <utility>

namespace biteline::robot::ur {
namespace {

constexpr std::uint32_t k_most_header = 8U << 10U;
constexpr std::uint64_t k_most_body = 64U << 10U;

}  // namespace

struct HttpQuestion::Parser : boost::beast::http::response_parser<boost::beast::http::string_body> {};

std::string http_text(const Endpoint& at, const std::string& method, const std::string& target,
                      const std::string& json) {
  std::string text = method + " " + target + " HTTP/1.1\r\nHost: " + at.host + ":" + std::to_string(at.port) +
                     "\r\nAccept: application/json\r\nConnection: close\r\n";
  if (!json.empty())
    text += "Content-Type: application/json\r\nContent-Length: " + std::to_string(json.size()) + "\r\n";
  return text + "\r\n" + json;
}

HttpQuestion::HttpQuestion() = default;
HttpQuestion::HttpQuestion(HttpQuestion&&) noexcept = default;
HttpQuestion& HttpQuestion::operator=(HttpQuestion&&) noexcept = default;
HttpQuestion::~HttpQuestion() = default;

Result<HttpQuestion> HttpQuestion::begin(const Endpoint& at, std::string text) {
  HttpQuestion question;
  BITELINE_ASSIGN(question.stream_, TcpStream::begin(at));
  question.at_ = at;
  question.text_ = std::move(text);
  question.parser_ = std::make_unique<Parser>();
  question.parser_->eager(true);
  question.parser_->header_limit(k_most_header);
  question.parser_->body_limit(k_most_body);
  return question;
}

Result<std::optional<HttpAnswer>> HttpQuestion::push() {
  namespace http = boost::beast::http;
  if (!text_.empty()) {
    const Result<std::size_t> sent = stream_.write_now(text_);
    if (!sent)
      return fail_errno(Errc::ConnectFailed, sent.error().sys_errno, "%.60s:%u", at_.host.c_str(),
                        static_cast<unsigned>(at_.port));
    text_.erase(0, *sent);
    if (!text_.empty()) return std::optional<HttpAnswer>{};
  }
  const bool open = stream_.take_now(heard_);
  boost::system::error_code code;
  while (!heard_.empty() && !parser_->is_done()) {
    const std::size_t taken = parser_->put(boost::asio::buffer(heard_), code);
    heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(taken));
    if (code == http::error::need_more) {
      code = {};
      break;
    }
    if (code) break;
  }
  // Boost 1.74 does not compare a told length with its limit.
  if (!code && parser_->is_header_done() && parser_->content_length().value_or(0) > k_most_body)
    code = http::error::body_limit;
  if (!code && !open && !parser_->is_done()) {
    if (parser_->got_some()) parser_->put_eof(code);
    if (code == http::error::partial_message || !parser_->is_done())
      return fail(Errc::ConnectionLost, "%.60s:%u: it closes before its answer's end", at_.host.c_str(),
                  static_cast<unsigned>(at_.port));
  }
  if (code)
    return fail(Errc::ProtocolError, "%.60s:%u: no HTTP answer: %.60s", at_.host.c_str(),
                static_cast<unsigned>(at_.port), code.message().c_str());
  if (!parser_->is_done()) return std::optional<HttpAnswer>{};
  return std::optional{
      HttpAnswer{.status = static_cast<int>(parser_->get().result_int()), .body = parser_->get().body()}};
}

Result<HttpAnswer> HttpQuestion::wait(Nanoseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  for (;;) {
    BITELINE_ASSIGN(std::optional<HttpAnswer> answer, push());
    if (answer) return std::move(*answer);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    if (left.count() <= 0)
      return fail(Errc::Timeout, "%.60s:%u", at_.host.c_str(), static_cast<unsigned>(at_.port));
    const auto events = static_cast<short>(text_.empty() ? POLLIN : POLLOUT);
    pollfd entry{.fd = stream_.number(), .events = events, .revents = 0};
    poll(&entry, 1, static_cast<int>(left.count()));
  }
}

}  // namespace biteline::robot::ur
