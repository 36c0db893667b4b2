// SPDX-License-Identifier: MIT
// The way of a scan's messages to its hosts: windows, losses, absences, ends.
#include "tests/unit/firmware/stream/server_bench.hpp"

namespace biteline::stream {

TEST_GROUP_BASE(StreamServer, ServerBench){};

TEST(StreamServer, HostThatSaysHelloGetsTheScanFromItsBeginning) {
  add(2);
  receive("a", wire::HostHello{});
  LONGS_EQUAL(1, outbox.of<wire::SensorHello>("a").size());
  LONGS_EQUAL(2, outbox.of<wire::SensorHello>("a")[0].held_to);
  sut->tick(now);
  LONGS_EQUAL(2, profiles_sent("a"));
}

TEST(StreamServer, NobodyGetsAnythingBeforeHello) {
  add(2);
  receive("a", wire::Ack{});
  sut->tick(now);
  LONGS_EQUAL(0, outbox.sent["a"].size());
  LONGS_EQUAL(1, counters().packets_rejected);
}

TEST(StreamServer, WindowBoundsWhatIsUnderWay) {
  add(10);
  receive("a", wire::HostHello{});
  sut->tick(now);
  LONGS_EQUAL(4, profiles_sent("a"));
  receive("a", wire::Ack{.safe_sequence = 3});
  sut->tick(now);
  LONGS_EQUAL(7, profiles_sent("a"));
}

TEST(StreamServer, FullPeerGetsTheRestLater) {
  add(3);
  receive("a", wire::HostHello{});
  outbox.full = true;
  sut->tick(now);
  LONGS_EQUAL(0, profiles_sent("a"));
  outbox.full = false;
  sut->tick(now);
  LONGS_EQUAL(3, profiles_sent("a"));
}

TEST(StreamServer, ResumingHostGetsWhatItLacksAndASecondOneEverything) {
  add(4);
  receive(
      "a",
      wire::HostHello{
          .name = {}, .resume = true, .resume_scan_id = k_scan_id, .next_sequence = 3, .safe_sequence = 3});
  receive("b", wire::HostHello{});
  sut->tick(now);
  LONGS_EQUAL(1, profiles_sent("a"));
  LONGS_EQUAL(3, outbox.of<profile::Profile>("a")[0].header.sequence);
  LONGS_EQUAL(4, profiles_sent("b"));
}

TEST(StreamServer, HostOfAnotherScanStartsAnew) {
  add(4);
  receive("a", wire::HostHello{
                   .name = {}, .resume = true, .resume_scan_id = 1, .next_sequence = 3, .safe_sequence = 3});
  sut->tick(now);
  LONGS_EQUAL(4, profiles_sent("a"));
}

TEST(StreamServer, LossBeyondTheStoreIsToldToTheHostAndCounted) {
  config.store_bytes = 30'000;
  make();
  add(40, 100);  // some 3 KB each
  const std::uint64_t lost = counters().messages_lost;
  CHECK(lost > 20);
  receive("a", wire::HostHello{});
  sut->tick(now);
  const auto gaps = outbox.of<wire::Gap>("a");
  LONGS_EQUAL(1, gaps.size());
  LONGS_EQUAL(0, gaps[0].first);
  LONGS_EQUAL(lost, gaps[0].count);
  LONGS_EQUAL(4, profiles_sent("a"));
  LONGS_EQUAL(lost, outbox.of<wire::SensorHello>("a")[0].held_from);
}

TEST(StreamServer, LosslessSourceWaitsForTheSlowestPresentHost) {
  config.store_bytes = 500'000;
  make();
  receive("a", wire::HostHello{});
  receive("b", wire::HostHello{});
  CHECK(sut->has_room());
  while (sut->has_room()) add(1, 4000);
  sut->tick(now);
  receive("a", wire::Ack{.safe_sequence = 2});
  CHECK(!sut->has_room());
  receive("b", wire::Ack{.safe_sequence = 1});
  CHECK(sut->has_room());
  LONGS_EQUAL(0, counters().messages_lost);
}

TEST(StreamServer, SilentHostHoldsNothingUpButComesBackWhereItWas) {
  add(3);
  receive("a", wire::HostHello{});
  sut->tick(now);
  LONGS_EQUAL(1, sut->hosts_present());
  now += std::chrono::seconds{3};
  sut->tick(now);
  LONGS_EQUAL(0, sut->hosts_present());
  add(1);
  sut->tick(now);
  LONGS_EQUAL(3, profiles_sent("a"));
  receive("a", wire::Ack{.safe_sequence = 3});
  sut->tick(now);
  LONGS_EQUAL(4, profiles_sent("a"));
}

TEST(StreamServer, WhatNobodyAcknowledgedIsKeptWhileNobodyIsThere) {
  config.store_bytes = 500'000;
  make();
  receive("a", wire::HostHello{});
  now += std::chrono::seconds{3};
  sut->tick(now);
  while (sut->has_room()) add(1, 4000);
  LONGS_EQUAL(0, counters().messages_lost);
}

TEST(StreamServer, AcknowledgingWhatWasNeverSentIsRejected) {
  add(10);
  receive("a", wire::HostHello{});
  sut->tick(now);
  receive("a", wire::Ack{.safe_sequence = 9});
  LONGS_EQUAL(1, counters().packets_rejected);
  sut->tick(now);
  LONGS_EQUAL(4, profiles_sent("a"));
}

TEST(StreamServer, EndCountsAsDeliveredWhenEveryPresentHostHasIt) {
  add(1);
  receive("a", wire::HostHello{});
  receive("b", wire::HostHello{});
  sut->add_end({});
  sut->tick(now);
  CHECK(!sut->end_acknowledged());
  receive("a", wire::Ack{.safe_sequence = 2});
  CHECK(!sut->end_acknowledged());
  receive("b", wire::Ack{.safe_sequence = 2});
  CHECK(sut->end_acknowledged());
}

TEST(StreamServer, EndStaysDeliveredWhenTheHostLeaves) {
  receive("a", wire::HostHello{});
  sut->add_end({});
  sut->tick(now);
  receive("a", wire::Ack{.safe_sequence = 1});
  receive("a", wire::Bye{});
  CHECK(sut->end_acknowledged());
  sut->begin_scan(100, "next", 0);
  CHECK(!sut->end_acknowledged());
}

TEST(StreamServer, WhatTheLightDidFollowsTheEndAtOnce) {
  const auto states_told = [&] { return outbox.of<wire::Health>("a").size(); };
  add(5);
  receive("a", wire::HostHello{});
  sut->tick(now);
  sut->add_end({});
  sut->tick(now);
  LONGS_EQUAL(1, states_told());  // the window is full: the host has no end yet
  receive("a", wire::Ack{.safe_sequence = 4});
  sut->tick(now);
  LONGS_EQUAL(1, outbox.of<wire::EndOfScan>("a").size());
  LONGS_EQUAL(2, states_told());
  CHECK(std::holds_alternative<wire::Health>(outbox.sent["a"].back().body));
  sut->tick(now);
  LONGS_EQUAL(2, states_told());
}

TEST(StreamServer, HostThatLeavesIsForgotten) {
  receive("a", wire::HostHello{});
  receive("a", wire::Bye{});
  LONGS_EQUAL(0, sut->hosts_present());
}

TEST(StreamServer, OtherVersionIsToldWhy) {
  wire::Bytes packet;
  wire::encode({.protocol = wire::k_protocol + 1, .body = wire::HostHello{}}, packet);
  sut->on_packet("a", packet, now);
  const auto byes = outbox.of<wire::Bye>("a");
  LONGS_EQUAL(1, byes.size());
  CHECK(byes[0].reason == wire::ByeReason::VersionMismatch);
  LONGS_EQUAL(wire::k_protocol, byes[0].protocol);
  LONGS_EQUAL(1, counters().peers_refused);
}

TEST(StreamServer, MoreHostsThanAllowedAreRefusedUnlessOneIsAbsent) {
  receive("a", wire::HostHello{});
  receive("b", wire::HostHello{});
  receive("c", wire::HostHello{});
  LONGS_EQUAL(1, outbox.of<wire::Bye>("c").size());
  now += std::chrono::seconds{3};
  receive("b", wire::Ack{});
  sut->tick(now);  // a is silent by now
  receive("c", wire::HostHello{});
  LONGS_EQUAL(1, outbox.of<wire::SensorHello>("c").size());
}

TEST(StreamServer, RubbishIsCountedAndAnswersNothing) {
  const wire::Bytes rubbish(50, 0x42);
  sut->on_packet("a", rubbish, now);
  sut->on_packet("a", {}, now);
  LONGS_EQUAL(2, counters().packets_rejected);
  LONGS_EQUAL(0, outbox.sent["a"].size());
}

TEST(StreamServer, NewScanIsAnnouncedAndUnfetchedOnesAreCountedLost) {
  add(5);
  receive("a", wire::HostHello{});
  sut->tick(now);
  receive("a", wire::Ack{.safe_sequence = 2});
  sut->begin_scan(100, "next", 10);
  LONGS_EQUAL(3, counters().messages_lost);
  const wire::Message& last = outbox.sent["a"].back();
  LONGS_EQUAL(100, last.scan_id);
  STRCMP_EQUAL("next", std::get<wire::SensorHello>(last.body).scan_name.c_str());
}

}  // namespace biteline::stream
