// SPDX-License-Identifier: MIT
// The control end with doors of every kind: well-behaved, slow, hostile, without keys.
#include <CppUTest/TestHarness.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <thread>

#include "common/wire/socket.hpp"
#include "host/interfaces/control/client.hpp"
#include "host/interfaces/control/server.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/key_set.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::control {
namespace {

using namespace std::chrono_literals;

constexpr auto k_patience = 60s;  // of a loaded machine

template <class Condition>
bool comes_true(Condition&& condition) {
  const auto until = std::chrono::steady_clock::now() + k_patience;
  while (std::chrono::steady_clock::now() < until) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

wire::Endpoint endpoint_of(const Server& server) {
  return *wire::parse_endpoint(server.address());
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Says back what it was asked; "/slow" and "/long" wait for `gate`, the second as one that takes seconds.
struct Echo {
  std::promise<void> gate;
  std::shared_future<void> opened{gate.get_future().share()};

  Handlers handlers() {
    return {.urgent = [](const Request& request) -> std::optional<Answer> {
              if (request.path != "/stop") return std::nullopt;
              Answer answer;
              answer.body = "stopped";
              return answer;
            },
            .ordinary =
                [opened = opened](const Request& request) {
                  if (request.path == "/slow" || request.path == "/long") opened.wait();
                  Answer answer;
                  answer.body = {{"path", request.path}, {"door", request.door}, {"body", request.body}};
                  return answer;
                },
            .is_long = [](const Request& request) { return request.path == "/long"; }};
  }
};

std::unique_ptr<Server> open_server(Echo& echo, const std::optional<wire::SensorKeys>& keys = {}) {
  ServerConfig config;
  config.endpoint.host = "127.0.0.1";
  config.keys = keys;
  config.hello = {{"version", "x"}};
  auto server = Server::open(config, echo.handlers());
  SUCCEEDS(server);
  return std::move(*server);
}

Request request_to(const std::string& path) {
  Request request;
  request.id = 5;
  request.method = "GET";
  request.path = path;
  request.body = "text";
  return request;
}

}  // namespace

TEST_GROUP(ControlEnd){};

TEST(ControlEnd, AnswersWhatItIsAsked) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  const Answer answer = (*client)->ask(request_to("/a"));
  LONGS_EQUAL(200, answer.status);
  LONGS_EQUAL(5, answer.id);
  STRCMP_EQUAL("/a", answer.body["path"].get<std::string>().c_str());
  STRCMP_EQUAL("web", answer.body["door"].get<std::string>().c_str());
  STRCMP_EQUAL("text", answer.body["body"].get<std::string>().c_str());
}

TEST(ControlEnd, UrgentRequestsPassThoseThatWait) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  std::promise<Answer> slow;
  (*client)->ask(request_to("/slow"), [&](Answer answer) { slow.set_value(std::move(answer)); });
  STRCMP_EQUAL("stopped", (*client)->ask(request_to("/stop")).body.get<std::string>().c_str());
  std::future<Answer> answer = slow.get_future();
  CHECK(answer.wait_for(0s) == std::future_status::timeout);
  echo.gate.set_value();
  LONGS_EQUAL(200, answer.get().status);
}

TEST(ControlEnd, ARequestThatWaitsIsAsOldAsTheMomentOfItsHearing) {
  std::atomic<std::uint64_t> stops{7};
  std::promise<void> gate;
  const std::shared_future<void> opened = gate.get_future().share();
  ServerConfig config;
  config.endpoint.host = "127.0.0.1";
  const auto server = Server::open(config, {.urgent = [&](const Request& request) -> std::optional<Answer> {
                                              if (request.path != "/stop") return std::nullopt;
                                              ++stops;
                                              return Answer{};
                                            },
                                            .ordinary =
                                                [opened](const Request& request) {
                                                  if (request.path == "/slow") opened.wait();
                                                  Answer answer;
                                                  answer.body = request.stops;
                                                  return answer;
                                                },
                                            .stops = [&] { return stops.load(); }});
  SUCCEEDS(server);
  const auto client = Client::open({.endpoint = endpoint_of(**server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  std::promise<Answer> slow, order;
  (*client)->ask(request_to("/slow"), [&](Answer answer) { slow.set_value(std::move(answer)); });
  (*client)->ask(request_to("/order"), [&](Answer answer) { order.set_value(std::move(answer)); });
  LONGS_EQUAL(200, (*client)->ask(request_to("/stop")).status);
  gate.set_value();
  LONGS_EQUAL(7, slow.get_future().get().body.get<int>());
  LONGS_EQUAL(7, order.get_future().get().body.get<int>());
  LONGS_EQUAL(8, (*client)->ask(request_to("/order")).body.get<int>());
}

/// Through each of the three words.
TEST(ControlEnd, AStopPassesFullQueues) {
  Echo echo;
  Handlers handlers = echo.handlers();
  handlers.urgent = [](const Request& request) -> std::optional<Answer> {
    if (!is_stop(request)) return std::nullopt;
    Answer answer;
    answer.body = "stopped";
    return answer;
  };
  std::promise<void> gate;
  const std::shared_future<void> opened = gate.get_future().share();
  handlers.ordinary = [opened](const Request&) {
    opened.wait();
    return Answer{};
  };
  handlers.is_long = [](const Request& request) { return request.path == "/long"; };
  ServerConfig config;
  config.endpoint.host = "127.0.0.1";
  const auto server = Server::open(config, handlers);
  SUCCEEDS(server);
  const auto client = Client::open({.endpoint = endpoint_of(**server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  std::atomic<int> busy{0}, answered{0};
  const auto count = [&](const Answer& answer) {
    if (answer.status == 503) ++busy;
    ++answered;
  };
  for (int i = 0; i < 100; ++i) (*client)->ask(request_to(i % 2 == 0 ? "/a" : "/long"), count);
  for (const char* path : {k_stop_path, k_laser_off_path, k_line_stop_path}) {
    Request stop = request_to(path);
    stop.method = "POST";
    STRCMP_EQUAL("stopped", (*client)->ask(std::move(stop)).body.get<std::string>().c_str());
  }
  CHECK(comes_true([&] { return busy > 0 && answered == busy; }));
  gate.set_value();
  CHECK(comes_true([&] { return answered == 100; }));
}

TEST(ControlEnd, ADoorKeepsPlacesForStops) {
  std::atomic<int> busy{0}, gone{0}, stops{0};
  {
    // Nobody is there, so that all that is asked waits.
    const auto client =
        Client::open({.endpoint = *wire::parse_endpoint("tcp://127.0.0.1:1"), .keys = {}, .patience = 600s});
    SUCCEEDS(client);
    const auto count = [&](const Answer& answer) {
      ++(answer.body["error"]["code"] == "busy" ? busy : gone);
    };
    for (int i = 0; i < 300; ++i) (*client)->ask(request_to("/a"), count);
    CHECK(busy > 0 && gone == 0);
    Request stop = request_to(k_stop_path);
    stop.method = "POST";
    const int before = busy;
    (*client)->ask(std::move(stop), [&](const Answer& answer) {
      if (answer.body["error"]["code"] != "busy") ++stops;
    });
    LONGS_EQUAL(before, busy);
    LONGS_EQUAL(0, stops);
  }
  // It waited with the others until the door closed.
  LONGS_EQUAL(1, stops);
  LONGS_EQUAL(300, busy + gone);
}

TEST(ControlEnd, WhatTakesSecondsHoldsUpNoOtherRequest) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  std::promise<Answer> first, second;
  (*client)->ask(request_to("/long"), [&](Answer answer) { first.set_value(std::move(answer)); });
  (*client)->ask(request_to("/long"), [&](Answer answer) { second.set_value(std::move(answer)); });
  LONGS_EQUAL(200, (*client)->ask(request_to("/a")).status);
  std::future<Answer> one = first.get_future(), other = second.get_future();
  CHECK(one.wait_for(0s) == std::future_status::timeout);
  CHECK(other.wait_for(0s) == std::future_status::timeout);
  echo.gate.set_value();
  LONGS_EQUAL(200, one.get().status);
  LONGS_EQUAL(200, other.get().status);
}

TEST(ControlEnd, AFloodOfWhatTakesSecondsLeavesRoomForTheRest) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  for (int i = 0; i < 100; ++i) (*client)->ask(request_to("/long"), [](const Answer&) {});
  LONGS_EQUAL(200, (*client)->ask(request_to("/a")).status);
  echo.gate.set_value();
}

TEST(ControlEnd, EventsComeInOrderAndTheFirstIsTheHello) {
  Echo echo;
  const auto server = open_server(echo);
  std::mutex mutex;
  std::vector<Event> events;
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}}, [&](const Event& event) {
    const std::lock_guard lock{mutex};
    events.push_back(event);
  });
  SUCCEEDS(client);
  CHECK(comes_true([&] { return server->doors() == 1; }));
  for (int i = 0; i < 20; ++i) server->publish("state", {{"i", i}});
  CHECK(comes_true([&] {
    const std::lock_guard lock{mutex};
    return events.size() == 21;
  }));
  STRCMP_EQUAL("hello", events.front().name.c_str());
  STRCMP_EQUAL("x", events.front().data["version"].get<std::string>().c_str());
  for (std::size_t i = 1; i < events.size(); ++i) {
    LONGS_EQUAL(events[i - 1].seq + 1, events[i].seq);
    LONGS_EQUAL(i - 1, events[i].data["i"].get<std::size_t>());
  }
}

TEST(ControlEnd, DoorThatNeverReadsHoldsNobodyUp) {
  Echo echo;
  const auto server = open_server(echo);
  // Says hello, then never reads: its queue and the network's room fill.
  auto context = wire::SocketContext::create();
  auto deaf = wire::open_caller(*context, endpoint_of(*server), {});
  SUCCEEDS(deaf);
  SUCCEEDS(deaf->connect(endpoint_of(*server).text()));
  CHECK(deaf->send({bytes_of(to_text(Hello{.door = "deaf"}))}));
  CHECK(comes_true([&] { return server->doors() == 1; }));
  const std::string much(50'000, 'x');
  CHECK(comes_true([&] {
    deaf->send({bytes_of(to_text(Hello{.door = "deaf"}))});
    for (int i = 0; i < 20; ++i) server->publish("state", much);
    return server->counters().dropped_events > 0;
  }));
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  LONGS_EQUAL(200, (*client)->ask(request_to("/a")).status);
}

TEST(ControlEnd, GarbageIsCountedAndTheNextDoorServed) {
  Echo echo;
  const auto server = open_server(echo);
  auto context = wire::SocketContext::create();
  auto rude = wire::open_caller(*context, endpoint_of(*server), {});
  SUCCEEDS(rude);
  SUCCEEDS(rude->connect(endpoint_of(*server).text()));
  for (int i = 0; i < 50; ++i) {
    CHECK(rude->send({bytes_of(std::string(100, '['))}));
    CHECK(rude->send({bytes_of("{}"), bytes_of("{}"), bytes_of("{}")}));
  }
  CHECK(comes_true([&] { return server->counters().refused_messages == 100; }));
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  LONGS_EQUAL(200, (*client)->ask(request_to("/a")).status);
}

TEST(ControlEnd, WhoAsksWhatIsNoRequestIsToldAtOnce) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  Request deep = request_to("/a");
  for (int level = 0; level < k_most_depth; ++level) deep.body = {{"a", std::move(deep.body)}};
  Request long_query = request_to("/a");
  long_query.query["bucket"] = std::string(5000, 'x');
  const Request long_path = request_to("/" + std::string(5000, 'x'));
  for (const Request& request : {deep, long_query, long_path}) {
    const Answer answer = (*client)->ask(request);
    LONGS_EQUAL(400, answer.status);
    LONGS_EQUAL(5, answer.id);
    STRCMP_EQUAL("bad_request", answer.body["error"]["code"].get<std::string>().c_str());
  }
}

TEST(ControlEnd, FloodIsAnsweredBusyAndNothingIsLost) {
  Echo echo;
  const auto server = open_server(echo);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = {}, .patience = k_patience});
  SUCCEEDS(client);
  std::atomic<int> done{0};
  std::atomic<int> busy{0};
  for (int i = 0; i < 100; ++i) {
    (*client)->ask(request_to("/slow"),
                   [&](const Answer& answer) { ++(answer.status == 200 ? done : busy); });
  }
  CHECK(comes_true([&] { return busy > 0; }));
  echo.gate.set_value();
  CHECK(comes_true([&] { return done + busy == 100; }));
  CHECK(done >= 32);
}

TEST(ControlEnd, WithoutAServiceTheAnswerIsGone) {
  const auto client =
      Client::open({.endpoint = *wire::parse_endpoint("tcp://127.0.0.1:1"), .keys = {}, .patience = 100ms});
  SUCCEEDS(client);
  const Answer answer = (*client)->ask(request_to("/a"));
  LONGS_EQUAL(503, answer.status);
  LONGS_EQUAL(5, answer.id);
  CHECK(!(*client)->connected());
}

TEST(ControlEnd, KeysAreAskedForAndOthersStayOut) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder others;
  SUCCEEDS(test::make_key_set(folder.path()));
  SUCCEEDS(wire::make_host_keys(others.path()));
  const auto own = wire::read_sensor_keys(folder.path());
  SUCCEEDS(own);
  Echo echo;
  const auto server = open_server(echo, *own);
  const auto keys = wire::read_host_keys(folder.path());
  SUCCEEDS(keys);
  const auto client = Client::open({.endpoint = endpoint_of(*server), .keys = *keys, .patience = k_patience});
  SUCCEEDS(client);
  LONGS_EQUAL(200, (*client)->ask(request_to("/a")).status);
  std::filesystem::copy_file(folder.path() / "sensor.public", others.path() / "sensor.public");
  const auto stranger_keys = wire::read_host_keys(others.path());
  SUCCEEDS(stranger_keys);
  const auto stranger =
      Client::open({.endpoint = endpoint_of(*server), .keys = *stranger_keys, .patience = 500ms});
  SUCCEEDS(stranger);
  LONGS_EQUAL(503, (*stranger)->ask(request_to("/a")).status);
  CHECK(comes_true([&] { return server->counters().refused_doors > 0; }));
}

TEST(ControlEnd, BeyondLoopbackKeysAreCompulsory) {
  Echo echo;
  ServerConfig everywhere;
  everywhere.endpoint.host = "0.0.0.0";
  FAILS_NAMING(Errc::AuthenticationFailed, "beyond loopback", Server::open(everywhere, echo.handlers()));
  ClientConfig elsewhere;
  elsewhere.endpoint = {.host = "192.0.2.1", .port = 9};
  FAILS_NAMING(Errc::AuthenticationFailed, "beyond loopback", Client::open(elsewhere));
}

}  // namespace biteline::control
