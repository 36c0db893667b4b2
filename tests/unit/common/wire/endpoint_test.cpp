// SPDX-License-Identifier: MIT
#include "common/wire/endpoint.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"

namespace biteline::wire {

TEST_GROUP(Endpoint){};

TEST(Endpoint, PartsAreRead) {
  const Result<Endpoint> sut = parse_endpoint("tcp://127.0.0.1:5555");
  SUCCEEDS(sut);
  STRCMP_EQUAL("127.0.0.1", sut->host.c_str());
  LONGS_EQUAL(5555, sut->port);
  STRCMP_EQUAL("tcp://127.0.0.1:5555", sut->text().c_str());
  STRCMP_EQUAL("[::1]", parse_endpoint("tcp://[::1]:0")->host.c_str());
}

TEST(Endpoint, OnlyWhatStaysOnThisMachineIsLoopback) {
  const struct {
    const char* text;
    bool loopback;
  } rows[] = {
      {"tcp://127.0.0.1:1", true},    {"tcp://127.9.8.7:1", true}, {"tcp://localhost:1", true},
      {"tcp://[::1]:1", true},        {"tcp://0.0.0.0:1", false},  {"tcp://*:1", false},
      {"tcp://10.0.0.1:1", false},    {"tcp://[::]:1", false},     {"tcp://127.evil.example:1", false},
      {"tcp://127.0.0.1.x:1", false}, {"tcp://127.0.0:1", false},  {"tcp://localhost.x:1", false},
      {"tcp://127.0.0.256:1", false}, {"tcp://128.0.0.1:1", false}};
  for (const auto& row : rows) {
    const Result<Endpoint> sut = parse_endpoint(row.text);
    CHECK_TEXT(sut.has_value(), row.text);
    CHECK_EQUAL_TEXT(row.loopback, sut->loopback(), row.text);
  }
}

TEST(Endpoint, AnythingElseIsRefused) {
  for (const char* text :
       {"", "tcp://", "127.0.0.1:5", "tcp://127.0.0.1", "tcp://127.0.0.1:", "tcp://127.0.0.1:x",
        "tcp://127.0.0.1:70000", "tcp://a b:1", "ipc:///tmp/x:1", "tcp://h;tcp://x:1", "tcp://:5"}) {
    CHECK_TEXT(!parse_endpoint(text), text);
  }
}

}  // namespace biteline::wire
