// SPDX-License-Identifier: MIT
#pragma once
/// \file A server that runs against a made service.
#include <CppUTest/TestHarness.h>

#include <memory>
#include <mutex>
#include <thread>

#include "host/apps/biteline-web/web_server.hpp"
#include "tests/support/api_answers.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::web {

using control::Answer;
using control::Json;
using test::WebClient;
using test::WebReply;

inline const std::string k_session{"Authorization: Bearer viewer-token\r\n"};
inline constexpr const char* k_login = R"({"name":"ada","password":"correct horse"})";

/// Knows one user, and tells what it was asked.
class MadeService final : public ServiceDoor {
 public:
  void ask(control::Request request, OnAnswer on_answer) override {
    const std::lock_guard lock{mutex_};
    asked_.push_back(request);
    on_answer(away_ ? control::refusal(503, "host_away", "nobody there") : answer(request));
  }
  void listen(OnEvent on_event) override {
    const std::lock_guard lock{mutex_};
    on_event_ = std::move(on_event);
  }

  void tell(const control::Event& event) {
    const std::lock_guard lock{mutex_};
    on_event_(event);
  }
  void go(bool away) {
    const std::lock_guard lock{mutex_};
    away_ = away;
  }
  void end_session() {
    const std::lock_guard lock{mutex_};
    session_ended_ = true;
  }
  std::vector<control::Request> asked() {
    const std::lock_guard lock{mutex_};
    return asked_;
  }

 private:
  Answer answer(const control::Request& request) const {
    const bool known = request.token == "viewer-token" && !session_ended_;
    if (request.path == "/api/v1/sessions" && request.method == "POST") {
      if (request.body.value("password", "") != "correct horse") {
        return control::refusal(401, "wrong_password", "name or password is wrong");
      }
      return {.id = 0,
              .status = 201,
              .body = {{"token", "viewer-token"}, {"user", {{"name", "ada"}, {"role", "viewer"}}}}};
    }
    const bool stop = request.path == "/api/v1/commands/stop" || request.path == "/api/v1/commands/laser-off";
    if (stop && request.local) return {.id = 0, .status = 200, .body = {{"done", true}}};
    if (!known) return control::refusal(401, "login_needed", "log in");
    if (request.path == "/api/v1/me")
      return {.id = 0, .status = 200, .body = {{"name", "ada"}, {"role", "viewer"}}};
    if (request.path == "/api/v1/history.csv") return {.id = 0, .status = 200, .body = "scan,verdict\n"};
    if (request.path == "/api/v1/scans") {
      const Json scan{{"id", "scan-0001"}, {"verdict", "ok"}};
      return {.id = 0, .status = 200, .body = {{"scans", Json::array({scan})}, {"next", nullptr}}};
    }
    if (request.method == "DELETE") return {.id = 0, .status = 204, .body = {}};
    if (request.path == "/api/v1/exchange/model") {
      if (request.body.value("name", "") == "taken") return control::refusal(409, "exists", "taken");
      return {.id = 0, .status = request.body["last"].get<bool>() ? 201 : 200, .body = {{"name", "boot"}}};
    }
    // Its answer is a file below the results folder; one of them is not there, one is no business of
    // anybody's.
    for (const auto& [name, file] :
         {std::pair{"boot", ".exchange/out-1.tar"}, std::pair{"gone", ".exchange/out-0.tar"},
          std::pair{"outside", "../secret"}}) {
      if (request.path != std::string{"/api/v1/models/"} + name + "/file") continue;
      return {.id = 0, .status = 200, .body = {}, .type = "application/x-tar", .file = file};
    }
    return {
        .id = 0,
        .status = 200,
        .body = {
            {"now", "waiting"}, {"path", request.path}, {"query", request.query}, {"body", request.body}}};
  }

  std::mutex mutex_;
  OnEvent on_event_;
  std::vector<control::Request> asked_;
  bool away_{false};
  bool session_ended_{false};
};

/// A server that runs, with a results folder and a page.
struct RunningServer {
  explicit RunningServer(const WebLimits& limits = {}, const std::optional<TlsFiles>& tls = {}) {
    folder.write("page/index.html", "<!doctype html><title>page</title>");
    folder.write("page/app.js", "1;");
    folder.write("results/scan-0001/line.csv", "0123456789");
    folder.write("results/scan-0001/path/tracking.html", "<script>1</script>");
    folder.write("secret", "hidden words");
    WebConfig config;
    config.port = 0;
    config.page = folder.path() / "page";
    config.openapi = folder.write("share/openapi.yaml", "openapi: 3.1.0\n");
    config.limits = limits;
    config.tls = tls;
    auto door = std::make_unique<MadeService>();
    service = door.get();
    auto opened = WebServer::open(config, std::move(door));
    SUCCEEDS(opened);
    server = std::move(*opened);
    thread = std::thread{[this] { server->run(); }};
    const std::string results = (folder.path() / "results").string();
    service->tell(
        {.name = "hello", .data = {{"results", results}, {"accounts", results}}, .seq = 0, .time = {}});
  }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;
  ~RunningServer() {
    server->stop();
    thread.join();
  }

  [[nodiscard]] WebClient client() const { return WebClient{server->port()}; }
  [[nodiscard]] WebReply get(const std::string& path, const std::string& headers = k_session) const {
    return client().ask("GET", path, headers);
  }
  [[nodiscard]] std::size_t asked() const { return service->asked().size(); }
  /// It lives and answers.
  void check_alive() const { LONGS_EQUAL(200, get("/api/v1/state").status); }

  test::TemporaryFolder folder;
  MadeService* service{nullptr};
  std::unique_ptr<WebServer> server;
  std::thread thread;
};

inline void check_refused(int status, const char* code, const WebReply& reply) {
  LONGS_EQUAL(status, reply.status);
  const Json body = Json::parse(reply.body, nullptr, false);
  CHECK_TEXT(body.is_object() && body.contains("error"), reply.body.c_str());
  STRCMP_EQUAL(code, body["error"]["code"].get<std::string>().c_str());
  CHECK(!body["error"]["message"].get<std::string>().empty());
  test::note_answer("", "", status, "application/json", body);
}

}  // namespace biteline::web
