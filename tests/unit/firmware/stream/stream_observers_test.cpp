// SPDX-License-Identifier: MIT
// Observers beside the hosts of a stream server.
#include "tests/unit/firmware/stream/server_bench.hpp"

namespace biteline::stream {

TEST_GROUP_BASE(StreamObservers, ServerBench){};

TEST(StreamObservers, ObserverSeesAndChangesNothing) {
  receive("o", wire::ObserverHello{.name = "web", .profile_rate_hz = 100, .picture = {}});
  LONGS_EQUAL(1, outbox.of<wire::SensorHello>("o").size());
  LONGS_EQUAL(wire::k_protocol_minor, outbox.of<wire::SensorHello>("o")[0].protocol_minor);
  LONGS_EQUAL(0, sut->hosts_present());  // nobody who keeps the laser alive
  add(3);
  sut->tick(now);
  LONGS_EQUAL(1, profiles_sent("o"));
  LONGS_EQUAL(2, outbox.of<profile::Profile>("o")[0].header.sequence);
  LONGS_EQUAL(1, outbox.of<wire::Health>("o").size());
  LONGS_EQUAL(1, outbox.of<wire::Health>("o")[0].observers);
  sut->add_end({});
  LONGS_EQUAL(1, outbox.of<wire::EndOfScan>("o").size());
  CHECK(!sut->end_acknowledged());
  sut->begin_scan(k_scan_id + 1, "next", 0);
  LONGS_EQUAL(2, outbox.of<wire::SensorHello>("o").size());
  sut->say_bye("over");
  LONGS_EQUAL(1, outbox.of<wire::Bye>("o").size());
}

TEST(StreamObservers, ObserverCannotCommandAcknowledgeOrTurnHost) {
  receive("o", wire::ObserverHello{});
  for (const wire::Command command :
       {wire::Command::StartScan, wire::Command::StopScan, wire::Command::LaserOff})
    receive("o", wire::Control{.id = 5, .command = command});
  CHECK(commands.empty());
  LONGS_EQUAL(3, outbox.of<wire::ControlReply>("o").size());
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), outbox.of<wire::ControlReply>("o")[0].errc);
  add(2);
  receive("o", wire::Ack{.safe_sequence = 2});
  receive("o", wire::HostHello{});
  LONGS_EQUAL(5, counters().packets_rejected);
  LONGS_EQUAL(0, sut->hosts_present());
}

TEST(StreamObservers, HostStaysHostAndTakesNoObserversPlace) {
  config.observers.max_observers = 1;
  make();
  receive("a", wire::HostHello{});
  receive("a", wire::ObserverHello{});
  LONGS_EQUAL(1, counters().packets_rejected);
  receive("o", wire::ObserverHello{});
  receive("p", wire::ObserverHello{});
  LONGS_EQUAL(1, outbox.of<wire::Bye>("p").size());
  CHECK(outbox.of<wire::Bye>("p")[0].reason == wire::ByeReason::Refused);
  receive("o", wire::Bye{});
  receive("p", wire::ObserverHello{});
  LONGS_EQUAL(1, outbox.of<wire::SensorHello>("p").size());
}

TEST(StreamObservers, PictureOfAnotherScanIsLeftOut) {
  const wire::PictureWish wish{.rate_hz = 10};
  receive("o", wire::ObserverHello{.name = {}, .picture = wish});
  wire::Picture picture{
      .exposure_mid = {}, .region = {.width_px = 1, .height_px = 1}, .pixels = {9}, .peaks = {}};
  MadePicture made{.wish = wish, .scan_id = k_scan_id - 1, .packet = {}};
  wire::encode({.scan_id = made.scan_id, .body = picture}, made.packet);
  sut->add_picture(made);
  LONGS_EQUAL(0, outbox.of<wire::Picture>("o").size());
  made.scan_id = k_scan_id;
  sut->add_picture(made);
  LONGS_EQUAL(1, outbox.of<wire::Picture>("o").size());
}

}  // namespace biteline::stream
