// SPDX-License-Identifier: MIT
#pragma once
/// \file A person at a page of the service, who has all rights and control.
#include <future>
#include <memory>
#include <thread>

#include "host/interfaces/accounts/first_token.hpp"
#include "host/interfaces/control/client.hpp"
#include "tests/integration/robot/service_with_arm.hpp"
#include "tests/support/json.hpp"

namespace biteline {

/// A person at the page.
struct Page {
  std::shared_future<std::string> accounts;
  std::unique_ptr<control::Client> client;
  std::string token;

  explicit Page(const std::string& address) {
    const auto told = std::make_shared<std::promise<std::string>>();
    accounts = told->get_future().share();
    auto opened = control::Client::open(
        {.endpoint = *wire::parse_endpoint(address), .keys = {}, .patience = k_patience},
        [told, heard = false](const control::Event& event) mutable {
          if (event.name == "hello" && !std::exchange(heard, true))
            told->set_value(event.data["accounts"].get<std::string>());
        });
    SUCCEEDS(opened);
    client = std::move(*opened);
  }
  control::Answer ask(const std::string& method, const std::string& path, control::Json body = {}) const {
    control::Request request;
    request.token = token;
    request.local = true;
    request.method = method;
    request.path = "/api/v1" + path;
    request.body = std::move(body);
    return client->ask(std::move(request));
  }
  void begin() {
    const control::Json ada{{"name", "ada"}, {"password", "a long password"}};
    control::Json account = ada;
    account["role"] = "administrator";
    token = accounts::read_first_token(accounts.get());
    LONGS_EQUAL(201, ask("POST", "/users", account).status);
    token = ask("POST", "/sessions", ada).body["token"].get<std::string>();
    LONGS_EQUAL(200, ask("POST", "/control", {{"action", "take"}}).status);
  }
  /// A row is written by the result's thread, the phase is told after that thread's end.
  void wait_until_deciding() const {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    std::string phase;
    do {
      phase = ask("GET", "/state").body["phase"].get<std::string>();
      if (phase == "deciding") return;
      std::this_thread::sleep_for(50ms);
    } while (std::chrono::steady_clock::now() < until);
    STRCMP_EQUAL("deciding", phase.c_str());
  }
  /// The scan's row, once `done` says so.
  template <class Done>
  control::Json scan_once(const std::string& name, Done&& done) const {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    control::Json scan;
    // At once: what follows meets the first moment of what it waited for.
    do {
      std::this_thread::sleep_for(1ms);
      scan = ask("GET", "/scans/" + name).body;
    } while (!(scan.contains("decision") && done(scan)) && std::chrono::steady_clock::now() < until);
    CHECK_TEXT(scan.contains("decision"), test::text_of(scan).c_str());
    return scan;
  }
};

inline std::string address_told(ChildProcess& host) {
  const std::string words = "doors come in at ";
  while (const auto line = host.next_line(k_patience)) {
    if (line->starts_with(words)) return line->substr(words.size());
  }
  FAIL("no address was told");
  return {};
}

}  // namespace biteline
