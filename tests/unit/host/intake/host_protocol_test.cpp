// SPDX-License-Identifier: MIT
#include "host/intake/host_protocol.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>
#include <vector>

#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline::intake {
namespace {

using std::chrono::milliseconds;
constexpr std::uint64_t k_scan_id = 5;

}  // namespace

TEST_GROUP(HostProtocol) {
  std::vector<wire::Message> sent;
  HostClock::time_point now{Nanoseconds{1'000'000'000'000}};
  std::unique_ptr<HostProtocol> sut;

  void setup() override {
    make({});
  }
  void make(HostProtocolConfig config) {
    sent.clear();
    sut = std::make_unique<HostProtocol>(std::move(config), [this](std::span<const std::uint8_t> packet) {
      auto message = wire::decode(packet);
      SUCCEEDS(message);
      sent.push_back(std::move(*message));
    });
  }

  Result<std::optional<LinkEvent>> receive(wire::Body body, std::uint64_t sequence = 0,
                                           std::uint64_t scan_id = k_scan_id) {
    wire::Bytes packet;
    wire::encode({.scan_id = scan_id, .sequence = sequence, .body = std::move(body)}, packet);
    return sut->on_packet(packet, now);
  }
  static wire::SensorHello hello() {
    wire::SensorHello sensor;
    sensor.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 1, .height_px = 1};
    return sensor;
  }
  /// The sequence given out, or -1.
  long profile(std::uint64_t sequence) {
    const auto event = receive(test::made_profile(sequence, 1), sequence);
    SUCCEEDS(event);
    if (!*event) return -1;
    return static_cast<long>(std::get<ProfileEvent>(**event).sequence);
  }
  template <class Kind>
  std::vector<Kind> all() const {
    std::vector<Kind> found;
    for (const wire::Message& message : sent) {
      if (const Kind* kind = std::get_if<Kind>(&message.body)) found.push_back(*kind);
    }
    return found;
  }
};

TEST(HostProtocol, SaysHelloUntilTheSensorAnswers) {
  sut->tick(now);
  now += milliseconds{200};
  sut->tick(now);
  LONGS_EQUAL(1, all<wire::HostHello>().size());
  CHECK(!all<wire::HostHello>()[0].resume);
  now += milliseconds{400};
  sut->tick(now);
  LONGS_EQUAL(2, all<wire::HostHello>().size());
  const auto event = receive(hello());
  SUCCEEDS(event);
  CHECK(std::holds_alternative<Hello>(**event));
  now += milliseconds{400};
  sut->tick(now);
  LONGS_EQUAL(2, all<wire::HostHello>().size());
}

TEST(HostProtocol, GivesOutProfilesInOrderAndOnce) {
  SUCCEEDS(receive(hello()));
  LONGS_EQUAL(0, profile(0));
  LONGS_EQUAL(1, profile(1));
  LONGS_EQUAL(-1, profile(1));
  LONGS_EQUAL(1, sut->counters().duplicates);
  LONGS_EQUAL(2, sut->counters().messages);
}

TEST(HostProtocol, HoleIsAskedForOnceAndNotAcknowledged) {
  SUCCEEDS(receive(hello()));
  (void)profile(0);
  sent.clear();
  LONGS_EQUAL(-1, profile(2));
  LONGS_EQUAL(-1, profile(3));
  LONGS_EQUAL(1, all<wire::HostHello>().size());
  CHECK(all<wire::HostHello>()[0].resume);
  LONGS_EQUAL(k_scan_id, all<wire::HostHello>()[0].resume_scan_id);
  LONGS_EQUAL(1, all<wire::HostHello>()[0].next_sequence);
  LONGS_EQUAL(1, profile(1));
  LONGS_EQUAL(2, profile(2));
}

TEST(HostProtocol, AcknowledgesEveryFewMessagesAndRegularlyAsASignOfLife) {
  SUCCEEDS(receive(hello()));
  sut->tick(now);
  sent.clear();
  for (std::uint64_t i = 0; i < 16; ++i) (void)profile(i);
  LONGS_EQUAL(2, all<wire::Ack>().size());
  LONGS_EQUAL(16, all<wire::Ack>()[1].safe_sequence);
  now += milliseconds{150};
  sut->tick(now);
  LONGS_EQUAL(3, all<wire::Ack>().size());
}

TEST(HostProtocol, NothingIsSafeBeforeItsOwnerSaysSo) {
  make({.name = "h", .resume = {}, .acknowledge_by_itself = false});
  SUCCEEDS(receive(hello()));
  for (std::uint64_t i = 0; i < 20; ++i) (void)profile(i);
  now += milliseconds{150};
  sut->tick(now);
  for (const wire::Ack& ack : all<wire::Ack>()) LONGS_EQUAL(0, ack.safe_sequence);
  sut->acknowledge(now);
  LONGS_EQUAL(20, all<wire::Ack>().back().safe_sequence);
}

TEST(HostProtocol, LossIsToldAndCountedAndTheRestFollows) {
  SUCCEEDS(receive(hello()));
  (void)profile(0);
  const auto event = receive(wire::Gap{.first = 0, .count = 10});
  SUCCEEDS(event);
  LONGS_EQUAL(9, std::get<LossEvent>(**event).messages);
  LONGS_EQUAL(9, sut->counters().lost);
  LONGS_EQUAL(10, profile(10));
  // The same gap told again is no further loss.
  CHECK(!receive(wire::Gap{.first = 0, .count = 10})->has_value());
  LONGS_EQUAL(9, sut->counters().lost);
}

TEST(HostProtocol, ResumesWhereItStoodAndSaysSo) {
  make({.name = "h", .resume = ScanPosition{.scan_id = k_scan_id, .next_sequence = 7}});
  sut->tick(now);
  const auto said = all<wire::HostHello>();
  CHECK(said.at(0).resume && said.at(0).next_sequence == 7 && said.at(0).safe_sequence == 7);
  const auto event = receive(hello());
  CHECK(std::get<Hello>(**event).resumed && !std::get<Hello>(**event).other_scan);
  LONGS_EQUAL(7, profile(7));
}

TEST(HostProtocol, OtherScanThanTheOneItStoodInIsTold) {
  make({.name = "h", .resume = ScanPosition{.scan_id = 4, .next_sequence = 7}});
  const auto event = receive(hello());
  CHECK(!std::get<Hello>(**event).resumed && std::get<Hello>(**event).other_scan);
  LONGS_EQUAL(0, profile(0));
}

TEST(HostProtocol, RestartedSensorIsTold) {
  SUCCEEDS(receive(hello()));
  (void)profile(0);
  const auto event = receive(hello(), 0, 6);
  CHECK(std::get<Hello>(**event).other_scan);
  LONGS_EQUAL(6, sut->position().scan_id);
  LONGS_EQUAL(0, sut->position().next_sequence);
}

TEST(HostProtocol, FarewellsEndTheLinkWithTheReason) {
  SUCCEEDS(receive(hello()));
  FAILS_NAMING(Errc::ConnectionLost, "told to stop",
               receive(wire::Bye{.reason = wire::ByeReason::Stopping, .text = "told to stop"}));
  FAILS_NAMING(Errc::PeerRefused, "full",
               receive(wire::Bye{.reason = wire::ByeReason::Refused, .text = "full"}));
  FAILS_NAMING(Errc::NotSupported, "protocol 7",
               receive(wire::Bye{.reason = wire::ByeReason::VersionMismatch, .text = {}, .protocol = 7}));
}

TEST(HostProtocol, FarewellAfterTheEndIsNoFault) {
  SUCCEEDS(receive(hello()));
  const auto event = receive(wire::EndOfScan{}, 0);
  CHECK(std::holds_alternative<wire::EndOfScan>(**event));
  CHECK(sut->ended());
  LONGS_EQUAL(1, all<wire::Ack>().back().safe_sequence);
  SUCCEEDS(receive(wire::Bye{.reason = wire::ByeReason::Stopping, .text = {}}));
}

TEST(HostProtocol, BrokenMessageIsAskedForAgainAndGivenUpWhenItStaysBroken) {
  SUCCEEDS(receive(hello()));
  const wire::Bytes rubbish(40, 1);
  for (int i = 0; i < 4; ++i) {
    now += milliseconds{300};
    SUCCEEDS(sut->on_packet(rubbish, now));
    SUCCEEDS(sut->on_packet(rubbish, now));  // the same repetition: what was asked for is still on its way
  }
  LONGS_EQUAL(8, sut->counters().rejected);
  LONGS_EQUAL(4, all<wire::HostHello>().size());
  now += milliseconds{300};
  FAILS_NAMING(Errc::ProtocolError, "stays broken", sut->on_packet(rubbish, now));
}

TEST(HostProtocol, RubbishBetweenGoodMessagesOnlyCounts) {
  SUCCEEDS(receive(hello()));
  for (std::uint64_t i = 0; i < 20; ++i) {
    SUCCEEDS(sut->on_packet(wire::Bytes(40, 1), now));
    LONGS_EQUAL(static_cast<long>(i), profile(i));
  }
  LONGS_EQUAL(20, sut->counters().rejected);
}

}  // namespace biteline::intake
