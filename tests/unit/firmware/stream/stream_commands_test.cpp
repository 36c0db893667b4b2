// SPDX-License-Identifier: MIT
// What hosts command, and whose scan it is.
#include "tests/unit/firmware/stream/server_bench.hpp"

namespace biteline::stream {

TEST_GROUP_BASE(StreamCommands, ServerBench){};

TEST(StreamCommands, CommandsOfAKnownHostAreObeyedAndAnswered) {
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

TEST(StreamCommands, ScanBelongsToTheHostThatBeganItWhileItIsThere) {
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

TEST(StreamCommands, SettingsAreTheOwnersAndAnsweredOnceTheyAreTaken) {
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

TEST(StreamCommands, ARecordingIsKeptForTheScansOwnerAndToldOnceItIs) {
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

TEST(StreamCommands, WhoOnlyBringsSettingsTakesNoScan) {
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

TEST(StreamCommands, AGapIsNoScanThatSomebodyTook) {
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

TEST(StreamCommands, OverScanBelongsToNobody) {
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

}  // namespace biteline::stream
