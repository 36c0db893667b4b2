// SPDX-License-Identifier: MIT
#pragma once
/// \file One client over HTTP, from its first byte to its last.

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "host/apps/biteline-web/answers.hpp"
#include "host/apps/biteline-web/routes.hpp"
#include "host/apps/biteline-web/served_folder.hpp"
#include "host/apps/biteline-web/web_context.hpp"
#include "host/apps/biteline-web/web_stream.hpp"

namespace biteline::web {

/// Thread: the event loop's.
class Connection {
 public:
  /// `peer`: its address; `local`: it is on this machine; `place`: 0: none, it is only to be turned away.
  Connection(WebContext& context, Tcp::socket socket, std::string peer, bool local, Places::Id place);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection();

  [[nodiscard]] net::awaitable<void> run();
  /// 503, where there are too many already.
  [[nodiscard]] net::awaitable<void> turn_away();

 private:
  struct Asked {
    RouteMatch match;
    std::string path;
    std::map<std::string, std::string> query;
  };
  enum class FileKind { Page, Result, Download };
  /// Of a request whose body was not yet read.
  using HeadParser = http::request_parser<http::empty_body>;
  struct Upload;

  /// True: the connection stays.
  [[nodiscard]] net::awaitable<bool> one_request();
  [[nodiscard]] net::awaitable<void> refuse_unread(bool late, ErrorCode fault, std::uint64_t most_bytes);
  /// The file of POST /model-files, and its pieces to the service.
  [[nodiscard]] net::awaitable<void> take_upload(HeadParser& head);
  [[nodiscard]] net::awaitable<void> pass_on(Upload& upload);
  [[nodiscard]] net::awaitable<void> give_up(control::Request question);
  [[nodiscard]] net::awaitable<void> answer(const WebRequest& request);
  [[nodiscard]] net::awaitable<void> answer_route(const WebRequest& request, Asked asked);
  [[nodiscard]] net::awaitable<void> forward(const WebRequest& request, Asked asked);
  /// What the first account is asked for with; empty: it may not be read, or no service has said where.
  [[nodiscard]] net::awaitable<std::string> first_token();
  [[nodiscard]] net::awaitable<void> log_in(control::Request question);
  [[nodiscard]] net::awaitable<void> watch(const WebRequest& request, Handling handling, std::string session);

  [[nodiscard]] net::awaitable<void> send(WebAnswer answer, std::string_view policy = k_data_policy);
  [[nodiscard]] net::awaitable<void> send_openapi();
  [[nodiscard]] net::awaitable<void> send_metrics(std::string token);
  [[nodiscard]] net::awaitable<void> send_file_list(std::string scan);
  [[nodiscard]] net::awaitable<void> send_result_file(const WebRequest& request, std::string scan,
                                                      std::string path);
  /// Packed where the client takes that and the file lies packed beside itself; nothing but "as you have it"
  /// where it has it.
  [[nodiscard]] net::awaitable<void> send_page(const WebRequest& request, std::string path);
  /// What the service names as its answer, for people to keep as `name`.
  [[nodiscard]] net::awaitable<void> send_download(const control::Answer& given, std::string name);
  /// Give it a name before it is handed over: GCC 12 destroys a braced one within co_await twice.
  struct SentAs {
    FileKind kind;
    std::string_view range{};
    std::string tag{};   ///< of this version of the file; empty: not told
    bool packed{false};  ///< by gzip
  };
  [[nodiscard]] net::awaitable<void> send_file(const ServedFile& file, std::string path, SentAs as);
  [[nodiscard]] net::awaitable<void> linger();

  /// What is wrong with the request before its address is looked at.
  [[nodiscard]] std::optional<WebAnswer> judge(const WebRequest& request) const;
  /// Whether a page of this origin asks, as far as the program knows.
  [[nodiscard]] bool origin_is_own(const WebRequest& request) const;
  /// `of_page`: what is asked for is a file of the page, and no path of the API or beside it.
  [[nodiscard]] std::optional<WebAnswer> judge_origin(const WebRequest& request, const Route* route,
                                                      bool of_page) const;
  /// The service knows this session: its place is its own.
  void note_session(const control::Answer& given, const std::string& token);
  [[nodiscard]] bool is_local(const WebRequest& request) const;
  [[nodiscard]] std::string session_of(const WebRequest& request, Handling handling,
                                       const std::map<std::string, std::string>& query) const;
  [[nodiscard]] std::string cookie_text(const std::string& token, bool gone) const;

  WebContext& context_;
  WebStream stream_;
  std::string peer_;
  bool local_;
  Places::Id place_;
  beast::flat_buffer buffer_;
  bool asked_before_{false};  ///< a whole request has come
  bool keep_alive_{true};
  bool head_only_{false};
  bool upgraded_{false};
};

/// Asks the service; resumes on the event loop.
[[nodiscard]] net::awaitable<control::Answer> ask_service(WebContext& context, control::Request request);
/// GET /api/v1/me: whose session this is, and whether it still holds.
[[nodiscard]] net::awaitable<control::Answer> ask_who(WebContext& context, std::string session, bool local);

}  // namespace biteline::web
