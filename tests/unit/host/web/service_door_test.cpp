// SPDX-License-Identifier: MIT
// What the service says once reaches a door that listens late.
#include "host/apps/biteline-web/service_door.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>
#include <future>
#include <thread>

#include "host/interfaces/control/server.hpp"
#include "tests/support/errors.hpp"

namespace biteline::web {
namespace {

using namespace std::chrono_literals;

constexpr auto k_patience = 60s;  // of a loaded machine

std::unique_ptr<control::Server> open_service() {
  control::ServerConfig config;
  config.endpoint.host = "127.0.0.1";
  config.hello = {{"results", "/somewhere"}};
  auto server = control::Server::open(
      config,
      {.urgent = {}, .ordinary = [](const control::Request&) { return control::Answer{}; }, .is_long = {}});
  SUCCEEDS(server);
  return std::move(*server);
}

bool answers(ServiceDoor& door) {
  control::Request request;
  request.method = "GET";
  request.path = "/api/v1/state";
  std::promise<int> status;
  door.ask(std::move(request), [&status](control::Answer answer) { status.set_value(answer.status); });
  return status.get_future().get() == 200;
}

}  // namespace

TEST_GROUP(ServiceDoor){};

TEST(ServiceDoor, TheHelloThatCameBeforeAnyoneListenedIsTold) {
  const auto service = open_service();
  auto door =
      open_service_door({.endpoint = *wire::parse_endpoint(service->address()), .patience = k_patience});
  SUCCEEDS(door);
  // An answer comes after the hello.
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (!answers(**door) && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(5ms);
  CHECK_TRUE(answers(**door));
  std::promise<std::string> results;
  (*door)->listen([&results](const control::Event& event) {
    if (event.name == "hello") results.set_value(event.data["results"].get<std::string>());
  });
  auto said = results.get_future();
  CHECK_TRUE(said.wait_for(k_patience) == std::future_status::ready);
  STRCMP_EQUAL("/somewhere", said.get().c_str());
}

}  // namespace biteline::web
