// SPDX-License-Identifier: MIT
#include "host/fleet/broker.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::fleet {

TEST_GROUP(FleetBroker){};

TEST(FleetBroker, AddressSaysWhetherThereIsTls) {
  const auto tls = parse_broker("mqtts://broker.example:8883");
  SUCCEEDS(tls);
  CHECK(tls->tls.has_value());
  STRCMP_EQUAL("broker.example", tls->host.c_str());
  CHECK(!parse_broker("mqtt://127.0.0.1:1883")->tls);
  for (const char* text : {"", "tcp://127.0.0.1:1", "mqtts://", "mqtts://h", "mqtts://h:99999"})
    CHECK_TEXT(!parse_broker(text), text);
}

TEST(FleetBroker, BeyondLoopbackThereIsTlsOrNothing) {
  BrokerConfig config = *parse_broker("mqtt://192.0.2.1:1883");
  config.client = "test";
  const auto plain = Broker::open(config, {}, {});
  CHECK(!plain);
  CHECK(plain.error().code == Errc::AuthenticationFailed);
}

TEST(FleetBroker, FilesThatAreNoneAreNamed) {
  const test::TemporaryFolder folder;
  BrokerConfig config = *parse_broker("mqtts://127.0.0.1:1");
  config.client = "test";
  config.tls = TlsFiles{.authority = folder.path() / "ca.pem",
                        .certificate = folder.path() / "c.pem",
                        .key = folder.path() / "k.pem"};
  const auto missing = Broker::open(config, {}, {});
  CHECK(!missing);
  STRCMP_CONTAINS("ca.pem", to_line(missing.error()).c_str());
  for (const char* name : {"ca.pem", "c.pem", "k.pem"}) folder.write(name, "no PEM\n");
  // Found when it is opened, or when the first connection is tried: never a silent line without them.
  const auto opened = Broker::open(config, {}, {});
  CHECK(!opened || !(*opened)->turn(std::chrono::milliseconds{10}));
}

TEST(FleetBroker, BrokerThatIsAwayIsToldAndTriedAgain) {
  BrokerConfig config = *parse_broker("mqtt://127.0.0.1:1");
  config.client = "test";
  const auto broker = Broker::open(
      config, [](auto, auto) {}, [] {});
  SUCCEEDS(broker);
  const auto turned = (*broker)->turn(std::chrono::milliseconds{10});
  CHECK(!turned);
  STRCMP_CONTAINS("127.0.0.1 port 1", to_line(turned.error()).c_str());
  CHECK(!(*broker)->ready());
  CHECK(!(*broker)->publish("a", "b", Broker::Delivery::AtLeastOnce));
}

}  // namespace biteline::fleet
