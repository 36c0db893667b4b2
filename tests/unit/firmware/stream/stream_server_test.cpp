// SPDX-License-Identifier: MIT
#include "firmware/stream/stream_server.hpp"

#include <CppUTest/TestHarness.h>

#include <map>
#include <memory>
#include <vector>

#include "tests/support/errors.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline::stream {
namespace {

/// Keeps what was sent; a peer may be full.
class FakeOutbox final : public Outbox {
 public:
  bool send(const PeerId& peer, std::span<const std::uint8_t> packet) override {
    if (full) return false;
    Result<wire::Message> message = wire::decode(packet);
    SUCCEEDS(message);
    sent[peer].push_back(std::move(*message));
    return true;
  }

  template <class Kind>
  std::vector<Kind> of(const PeerId& peer) {
    std::vector<Kind> found;
    for (const wire::Message& message : sent[peer]) {
      if (const Kind* kind = std::get_if<Kind>(&message.body)) found.push_back(*kind);
    }
    return found;
  }

  bool full{false};
  std::map<PeerId, std::vector<wire::Message>> sent;
};

constexpr std::uint64_t k_scan_id = 99;

}  // namespace

TEST_GROUP(StreamServer) {
  FakeOutbox outbox;
  SensorClock::time_point now{Nanoseconds{1'000'000'000}};
  std::vector<wire::Command> commands;
  bool door_open{true};
  ServerConfig config{.store_bytes = 1024 * 1024, .window_messages = 4, .max_hosts = 2, .observers = {}};
  std::unique_ptr<StreamServer> sut;

  void setup() override {
    make();
  }

  void make() {
    sut = std::make_unique<StreamServer>(
        config, wire::SensorHello{.name = "s", .version = {}, .scan_name = {}, .model = model()}, outbox,
        [this](wire::Command command) -> Result<void> {
          commands.push_back(command);
          if (command == wire::Command::StartScan && door_open) return fail(Errc::InterlockOpen, "door");
          return {};
        },
        [] { return wire::Health{}; });
    sut->begin_scan(k_scan_id, "scan", 0);
  }

  static geometry::SensorModel model() {
    geometry::SensorModel sensor;
    sensor.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 10, .height_px = 10};
    return sensor;
  }

  void receive(const PeerId& peer, wire::Body body) {
    wire::Bytes packet;
    wire::encode({.scan_id = k_scan_id, .body = std::move(body)}, packet);
    sut->on_packet(peer, packet, now);
  }
  void add(int profiles, std::size_t points = 3) {
    for (int i = 0; i < profiles; ++i) {
      const profile::Profile profile = test::made_profile(static_cast<std::uint64_t>(i), points);
      sut->add_profile(profile.header, profile.points);
    }
  }
  std::size_t profiles_sent(const PeerId& peer) {
    return outbox.of<profile::Profile>(peer).size();
  }
  wire::Counters counters() {
    wire::Counters result;
    sut->fill(result);
    return result;
  }
};

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

TEST(StreamServer, CommandsOfAKnownHostAreObeyedAndAnswered) {
  receive("x", wire::Control{.id = 1, .command = wire::Command::StopScan});
  LONGS_EQUAL(0, commands.size());
  receive("a", wire::HostHello{});
  receive("a", wire::Control{.id = 7, .command = wire::Command::StopScan});
  receive("a", wire::Control{.id = 8, .command = wire::Command::StartScan});
  LONGS_EQUAL(2, commands.size());
  const auto replies = outbox.of<wire::ControlReply>("a");
  LONGS_EQUAL(7, replies.at(0).id);
  LONGS_EQUAL(0, replies.at(0).errc);
  LONGS_EQUAL(static_cast<int>(Errc::InterlockOpen), replies.at(1).errc);
  STRCMP_EQUAL("door", replies.at(1).where.c_str());
}

TEST(StreamServer, ScanBelongsToTheHostThatBeganItWhileItIsThere) {
  door_open = false;
  receive("a", wire::HostHello{.name = "workshop"});
  receive("b", wire::HostHello{});
  receive("a", wire::Control{.id = 1, .command = wire::Command::StartScan});
  sut->begin_scan(101, "mine", 10);
  for (const wire::Command command :
       {wire::Command::StopScan, wire::Command::LaserOff, wire::Command::StartScan}) {
    receive("b", wire::Control{.id = 2, .command = command});
    const wire::ControlReply reply = outbox.of<wire::ControlReply>("b").back();
    LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), reply.errc);
    STRCMP_CONTAINS("belongs to host 'workshop'", reply.where.c_str());
  }
  LONGS_EQUAL(1, commands.size());
  receive("a", wire::Control{.id = 3, .command = wire::Command::StopScan});
  LONGS_EQUAL(2, commands.size());
  // Its owner gone, a scan that runs on is anybody's.
  receive("a", wire::Bye{});
  receive("b", wire::Control{.id = 4, .command = wire::Command::StopScan});
  LONGS_EQUAL(3, commands.size());
}

TEST(StreamServer, SettingsAreTheOwnersAndAnsweredOnceTheyAreTaken) {
  const wire::Control order{.id = 7, .command = wire::Command::UseSettings, .settings = "set"};
  const auto answered = [&](const PeerId& peer) { return outbox.of<wire::ControlReply>(peer).size(); };
  receive("a", wire::HostHello{.name = "workshop"});
  receive("b", wire::HostHello{});
  receive("a", order);
  LONGS_EQUAL(static_cast<int>(Errc::NotSupported), outbox.of<wire::ControlReply>("a").back().errc);
  std::vector<std::string> sets;
  sut->take_settings_by([&](const std::string& text) -> std::optional<Result<void>> {
    sets.push_back(text);
    return std::nullopt;
  });
  door_open = false;
  receive("a", wire::Control{.id = 1, .command = wire::Command::StartScan});
  receive("b", order);
  receive("o", wire::ObserverHello{});
  receive("o", order);
  CHECK(sets.empty());
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), outbox.of<wire::ControlReply>("b").back().errc);
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), outbox.of<wire::ControlReply>("o").back().errc);
  const std::size_t before = answered("a");
  receive("a", order);
  LONGS_EQUAL(1, sets.size());
  LONGS_EQUAL(before, answered("a"));
  // A second one while the first is on its way is not taken for it.
  receive("a", wire::Control{.id = 8, .command = wire::Command::UseSettings, .settings = "other"});
  LONGS_EQUAL(1, sets.size());
  LONGS_EQUAL(static_cast<int>(Errc::WrongState), outbox.of<wire::ControlReply>("a").back().errc);
  sut->answer_settings({});
  LONGS_EQUAL(7, outbox.of<wire::ControlReply>("a").back().id);
  LONGS_EQUAL(0, outbox.of<wire::ControlReply>("a").back().errc);
}

TEST(StreamServer, ARecordingIsKeptForTheScansOwnerAndToldOnceItIs) {
  const wire::Control order{.id = 7, .command = wire::Command::KeepLast};
  const auto newest = [&](const PeerId& peer) { return outbox.of<wire::ControlReply>(peer).back(); };
  receive("a", wire::HostHello{.name = "workshop"});
  receive("b", wire::HostHello{});
  receive("a", order);
  LONGS_EQUAL(static_cast<int>(Errc::NotSupported), newest("a").errc);
  std::vector<wire::Command> asked;
  Result<void> begins;
  sut->keep_recordings_by([&](wire::Command command) {
    asked.push_back(command);
    return begins;
  });
  door_open = false;
  receive("a", wire::Control{.id = 1, .command = wire::Command::StartScan});
  receive("b", order);
  receive("o", wire::ObserverHello{});
  receive("o", order);
  CHECK(asked.empty());
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), newest("b").errc);
  LONGS_EQUAL(static_cast<int>(Errc::PeerRefused), newest("o").errc);
  receive("a", order);
  CHECK(asked == std::vector{wire::Command::KeepLast});
  LONGS_EQUAL(1, newest("a").id);
  // A second one while the first is on its way is not taken for it.
  receive("a", wire::Control{.id = 8, .command = wire::Command::KeepNext});
  LONGS_EQUAL(1, asked.size());
  LONGS_EQUAL(static_cast<int>(Errc::WrongState), newest("a").errc);
  sut->answer_keep(Result<std::string>{"/data/scan-2"});
  LONGS_EQUAL(7, newest("a").id);
  LONGS_EQUAL(0, newest("a").errc);
  STRCMP_EQUAL("/data/scan-2", newest("a").where.c_str());
  begins = fail(Errc::WrongState, "still being written");
  receive("a", wire::Control{.id = 9, .command = wire::Command::KeepNext});
  LONGS_EQUAL(9, newest("a").id);
  STRCMP_EQUAL("still being written", newest("a").where.c_str());
  begins = {};
  receive("a", wire::Control{.id = 10, .command = wire::Command::KeepNext});
  sut->answer_keep(fail(Errc::DiskFull, "the disk is full"));
  LONGS_EQUAL(static_cast<int>(Errc::DiskFull), newest("a").errc);
}

TEST(StreamServer, WhoOnlyBringsSettingsTakesNoScan) {
  door_open = false;
  receive("a", wire::HostHello{.name = "workshop"});
  LONGS_EQUAL(0, sut->hosts_taking());
  receive("a", wire::Control{.id = 1, .command = wire::Command::StartScan});
  LONGS_EQUAL(1, sut->hosts_taking());
  add(2);
  receive("a", wire::Bye{});
  receive("s", wire::HostHello{.name = "biteline settings"});
  sut->tick(now);
  receive("s", wire::Ack{});
  LONGS_EQUAL(1, sut->hosts_present());
  LONGS_EQUAL(0, sut->hosts_taking());
  // The same host on a new connection goes on where it was; one that has just begun takes it once it has some
  // of it.
  receive("a2", wire::HostHello{.name = "workshop",
                                .resume = true,
                                .resume_scan_id = k_scan_id,
                                .next_sequence = 2,
                                .safe_sequence = 2});
  LONGS_EQUAL(1, sut->hosts_taking());
  receive("a2", wire::Bye{});
  receive("s", wire::Ack{.safe_sequence = 1});
  LONGS_EQUAL(1, sut->hosts_taking());
  sut->add_end({});
  sut->begin_scan(k_scan_id + 1, "next", 10);
  receive("a", wire::HostHello{});
  LONGS_EQUAL(0, sut->hosts_taking());
}

TEST(StreamServer, AGapIsNoScanThatSomebodyTook) {
  config.store_bytes = 1000;
  make();
  add(50);
  receive("s", wire::HostHello{.name = "biteline settings"});
  sut->tick(now);
  const auto gaps = outbox.of<wire::Gap>("s");
  LONGS_EQUAL(1, gaps.size());
  receive("s", wire::Ack{.safe_sequence = gaps[0].first + gaps[0].count});
  LONGS_EQUAL(0, sut->hosts_taking());
}

TEST(StreamServer, OverScanBelongsToNobody) {
  door_open = false;
  receive("a", wire::HostHello{});
  receive("b", wire::HostHello{});
  receive("a", wire::Control{.id = 1, .command = wire::Command::StartScan});
  sut->begin_scan(101, "mine", 10);
  sut->add_end({});
  sut->begin_scan(102, "the robot's", 10);
  receive("b", wire::Control{.id = 2, .command = wire::Command::StopScan});
  LONGS_EQUAL(2, commands.size());
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

TEST(StreamServer, ObserverSeesAndChangesNothing) {
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

TEST(StreamServer, ObserverCannotCommandAcknowledgeOrTurnHost) {
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

TEST(StreamServer, HostStaysHostAndTakesNoObserversPlace) {
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

TEST(StreamServer, PictureOfAnotherScanIsLeftOut) {
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
