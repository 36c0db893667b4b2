// SPDX-License-Identifier: MIT
// A file that comes in: it never lies in this program, the service takes it piece by piece.
#include <utility>

#include "common/core/base64.hpp"
#include "host/apps/biteline-web/connection.hpp"
#include "host/apps/biteline-web/deadline.hpp"
#include "host/apps/biteline-web/guards.hpp"

namespace biteline::web {
namespace {

using net::redirect_error;
using net::use_awaitable;

constexpr const char* k_exchange = "/api/v1/exchange/model";
/// In base64 within a message of the control end.
constexpr std::size_t k_piece_bytes = 192 * 1024;

bool is_archive(std::string_view type) {
  return type == "application/x-tar" || type == "application/octet-stream";
}

}  // namespace

struct Connection::Upload {
  http::request_parser<http::buffer_body> parser;
  control::Request question;  ///< all but method and body
  control::Json wish;         ///< name, replace
};

net::awaitable<void> Connection::take_upload(HeadParser& head) {
  WebRequest request;
  request.base() = head.get().base();
  keep_alive_ = request.keep_alive();
  head_only_ = false;
  const std::string_view target = view(request.target());
  const std::size_t mark = target.find('?');
  const auto query = decode_query(mark == std::string_view::npos ? "" : target.substr(mark + 1));
  std::optional<WebAnswer> refusal = judge(request);
  if (!refusal) refusal = judge_origin(request, nullptr, false);
  const std::string session = session_of(request, Handling::Upload, {});
  if (!refusal && session.empty()) refusal = login_needed();
  if (!refusal && !query) refusal = error_answer(400, "bad_request", "the address cannot be read");
  if (!refusal && !is_archive(view(request[http::field::content_type])))
    refusal = error_answer(415, "wrong_type", "the file of a model, with Content-Type: application/x-tar");
  if (refusal) {
    // Its body is not read: the connection ends with it.
    keep_alive_ = false;
    co_await send(std::move(*refusal));
    co_return;
  }
  Upload upload{.parser = http::request_parser<http::buffer_body>{std::move(head)},
                .question = {},
                .wish = control::Json::object()};
  upload.parser.body_limit(context_.config.limits.upload_bytes);
  upload.question.token = session;
  upload.question.local = is_local(request);
  upload.question.door = "web";
  upload.question.path = k_exchange;
  // A session may bring several at once, or anew while an old connection still waits for its end.
  upload.question.query["upload"] = std::to_string(context_.requests);
  if (const auto name = query->find("name"); name != query->end()) upload.wish["name"] = name->second;
  if (const auto replace = query->find("replace"); replace != query->end())
    upload.wish["replace"] = replace->second == "true";
  co_await pass_on(upload);
}

/// The service forgets the pieces that it has.
net::awaitable<void> Connection::give_up(control::Request question) {
  question.method = "DELETE";
  question.body = {};
  static_cast<void>(co_await ask_service(context_, std::move(question)));
}

net::awaitable<void> Connection::pass_on(Upload& upload) {
  std::string piece(k_piece_bytes, '\0');
  std::uint64_t at = 0;
  control::Answer given;
  while (!upload.parser.is_done()) {
    auto& body = upload.parser.get().body();
    body.data = piece.data();
    body.size = piece.size();
    body.more = true;
    ErrorCode fault;
    bool late = false;
    {
      // Each piece has the time of a request: who is slow gets on, who stops does not.
      const Deadline deadline{stream_, context_.config.limits.request_time};
      co_await http::async_read(stream_, buffer_, upload.parser, redirect_error(use_awaitable, fault));
      late = deadline.over();
    }
    if (fault == http::error::need_buffer) fault = {};
    if (fault || late) {
      if (given.status == 200) co_await give_up(std::move(upload.question));
      co_await refuse_unread(late, fault, context_.config.limits.upload_bytes);
      co_return;
    }
    const std::size_t got = piece.size() - upload.parser.get().body().size;
    // What was refused is read to its end, so that the client reads the answer.
    if (given.status != 200) continue;
    upload.question.method = "POST";
    upload.question.body = upload.wish;
    upload.question.body["at"] = at;
    upload.question.body["bytes"] = to_base64({piece.data(), got});
    upload.question.body["last"] = upload.parser.is_done();
    at += got;
    given = co_await ask_service(context_, upload.question);
    note_session(given, upload.question.token);
    if (given.status >= 400 && at > got) co_await give_up(upload.question);
    if (given.status == 401 || given.status == 403) {
      keep_alive_ = false;
      break;
    }
  }
  if (at == 0) given = control::refusal(400, "bad_request", "the file of a model is expected as the body");
  co_await send(as_http(given, k_exchange));
}

}  // namespace biteline::web
