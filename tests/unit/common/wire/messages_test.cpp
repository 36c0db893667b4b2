// SPDX-License-Identifier: MIT
#include "common/wire/messages.hpp"

#include <CppUTest/TestHarness.h>

#include <bit>
#include <cfenv>
#include <cstdint>
#include <limits>
#include <random>

#include "common/wire/checksum.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/made_profile.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::wire {
namespace {

Bytes bytes_of(const Message& message) {
  Bytes bytes;
  encode(message, bytes);
  return bytes;
}

template <class Kind>
Kind round_trip(const Kind& body) {
  const Result<Message> message = decode(bytes_of({.scan_id = 77, .sequence = 5, .body = body}));
  SUCCEEDS(message);
  LONGS_EQUAL(77, message->scan_id);
  LONGS_EQUAL(5, message->sequence);
  CHECK(std::holds_alternative<Kind>(message->body));
  return std::get<Kind>(message->body);
}

Bytes sealed(Bytes content) {
  const std::uint32_t checksum = crc32c(content);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&checksum);
  content.insert(content.end(), bytes, bytes + sizeof checksum);
  return content;
}

SensorHello made_hello() {
  SensorHello hello;
  hello.name = "left head";
  hello.version = "1.2.3";
  hello.scan_name = "sport3";
  hello.frames_expected = 640;
  hello.lossless = true;
  hello.simulated = true;
  hello.scanning = true;
  hello.held_from = 3;
  hello.held_to = 9;
  hello.model.camera = {
      .fu_px = 1, .fv_px = 2, .cu_px = 3, .cv_px = 4, .k1 = 5, .k2 = 6, .p1 = 7, .p2 = 8, .k3 = 9};
  hello.model.laser_plane = {.normal_cam = {0, 0.6, -0.8}, .distance_mm = -142};
  hello.model.T_flange_cam = geometry::make_se3(Eigen::Quaterniond{0.5, 0.5, 0.5, 0.5}, {10, 20, 30});
  hello.model.region = {.offset_u_px = 1, .offset_v_px = 460, .width_px = 1626, .height_px = 320};
  hello.model.pose_clock_offset = Nanoseconds{-5};
  hello.model.exposure = Nanoseconds{400000};
  hello.model.camera_state = geometry::plain_state();
  hello.model.camera_state.pixel_format = "Mono8";
  hello.camera_state = hello.model.camera_state;
  hello.camera_state[geometry::StateKey::MirrorX] = 1;
  hello.camera_state[geometry::StateKey::SensorWidth] = 1626;
  return hello;
}

Picture made_picture(PictureFormat format) {
  Picture picture;
  picture.frame_sequence = 19;
  picture.profile_sequence = 12;
  picture.exposure_mid = SensorClock::time_point{Nanoseconds{123456789}};
  picture.region = {.offset_u_px = 4, .offset_v_px = 460, .width_px = 13, .height_px = 9};
  picture.step = 2;
  picture.format = format;
  for (int i = 0; i < 6 * 4; ++i) picture.pixels.push_back(static_cast<std::uint8_t>(10 * i));
  for (int i = 0; i < 5; ++i)
    picture.peaks.push_back({.u_px = static_cast<std::uint16_t>(4 + i),
                             .v_px = 461.25F + static_cast<float>(i),
                             .flags = static_cast<std::uint16_t>(i == 2 ? profile::k_point_reflection : 0)});
  return picture;
}

}  // namespace

TEST_GROUP(Messages){};

TEST(Messages, ProfileComesBackBitForBit) {
  for (const std::size_t points :
       {std::size_t{0}, std::size_t{1}, std::size_t{1626}, profile::k_max_profile_points}) {
    const profile::Profile sent = test::made_profile(12, points);
    const profile::Profile got = round_trip(sent);
    LONGS_EQUAL(sent.points.size(), got.points.size());
    CHECK(sent.header.exposure_mid == got.header.exposure_mid);
    CHECK(sent.header.T_base_flange.matrix() == got.header.T_base_flange.matrix());
    LONGS_EQUAL(12, got.header.sequence);
    LONGS_EQUAL(19, got.header.frame_sequence);
    LONGS_EQUAL(12345, got.header.pose_age.count());
    CHECK(got.header.encoder_ticks == -0x1'2345'6789'abcd - 12);
    CHECK(sent.header.speckle_contrast && got.header.speckle_contrast == sent.header.speckle_contrast);
    LONGS_EQUAL(sent.header.flags, got.header.flags);
    for (std::size_t i = 0; i < sent.points.size(); ++i) {
      CHECK(test::same_bits(sent.points[i], got.points[i]));
      CHECK(std::bit_cast<std::uint32_t>(sent.points[i].sigma_mm) ==
            std::bit_cast<std::uint32_t>(got.points[i].sigma_mm));
    }
  }
}

TEST(Messages, AnEncodersCountIsAbsentOrAnyNumber) {
  profile::Profile profile = test::made_profile(5, 3);
  CHECK(!round_trip(profile).header.encoder_ticks);
  for (const std::int64_t ticks : {std::int64_t{0}, std::numeric_limits<std::int64_t>::min()}) {
    profile.header.encoder_ticks = ticks;
    CHECK(round_trip(profile).header.encoder_ticks == ticks);
  }
}

TEST(Messages, SpecklesContrastIsAbsentOrPossible) {
  profile::Profile profile = test::made_profile(5, 3);
  CHECK(!round_trip(profile).header.speckle_contrast);
  profile.header.speckle_contrast = 0.0F;
  CHECK(round_trip(profile).header.speckle_contrast == 0.0F);
  for (const float impossible : {-0.01F, 11.0F, std::numeric_limits<float>::quiet_NaN()}) {
    profile.header.speckle_contrast = impossible;
    FAILS_NAMING(Errc::ProtocolError, "speckle", decode(bytes_of({.body = profile})));
  }
}

TEST(Messages, BothWaysToEncodeAProfileAgree) {
  const profile::Profile profile = test::made_profile(4, 100);
  Bytes direct;
  encode_profile({.scan_id = 8, .sequence = 9}, profile.header, profile.points, direct);
  CHECK(bytes_of({.scan_id = 8, .sequence = 9, .body = profile}) == direct);
}

TEST(Messages, LargestProfileFitsTheLimit) {
  CHECK(bytes_of({.body = test::made_profile(1, profile::k_max_profile_points)}).size() <
        k_max_message_bytes / 2);
}

TEST(Messages, HelloCarriesTheWholeHead) {
  const SensorHello sent = made_hello();
  const SensorHello got = round_trip(sent);
  STRCMP_EQUAL("left head", got.name.c_str());
  STRCMP_EQUAL("1.2.3", got.version.c_str());
  STRCMP_EQUAL("sport3", got.scan_name.c_str());
  LONGS_EQUAL(640, got.frames_expected);
  CHECK(got.lossless && got.simulated && got.scanning);
  LONGS_EQUAL(3, got.held_from);
  LONGS_EQUAL(9, got.held_to);
  DOUBLES_EQUAL(9, got.model.camera.k3, 0);
  DOUBLES_EQUAL(-0.8, got.model.laser_plane.normal_cam.z(), 0);
  TRANSFORMS_EQUAL(sent.model.T_flange_cam, got.model.T_flange_cam, 0, 0);
  LONGS_EQUAL(460, got.model.region.offset_v_px);
  LONGS_EQUAL(-5, got.model.pose_clock_offset.count());
  CHECK(!got.model.rate_hz.has_value());
  LONGS_EQUAL(400000, got.model.exposure->count());
  CHECK(sent.model.camera_state == got.model.camera_state);
  CHECK(sent.camera_state == got.camera_state);
}

TEST(Messages, ACameraStateIsCheckedAndOneThatIsNotToldStaysUntold) {
  SensorHello sent = made_hello();
  sent.camera_state = {};
  CHECK_FALSE(round_trip(sent).camera_state.told());
  for (const double impossible : {0.0, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    sent.camera_state[geometry::StateKey::BinningX] = impossible;
    Bytes bytes;
    encode({.scan_id = 1, .body = sent}, bytes);
    FAILS_NAMING(Errc::ProtocolError, "binning_x", decode(bytes));
  }
}

TEST(Messages, SmallMessagesComeBack) {
  const HostHello hello = round_trip(
      HostHello{.name = "h", .resume = true, .resume_scan_id = 1, .next_sequence = 2, .safe_sequence = 3});
  CHECK(hello.resume && hello.resume_scan_id == 1 && hello.next_sequence == 2 && hello.safe_sequence == 3);
  LONGS_EQUAL(11, round_trip(Ack{.safe_sequence = 11}).safe_sequence);
  const Gap gap = round_trip(Gap{.first = 4, .count = 6});
  CHECK(gap.first == 4 && gap.count == 6);
  const Control control = round_trip(Control{.id = 3, .command = Command::LaserOff});
  CHECK(control.id == 3 && control.command == Command::LaserOff);
  for (const Command command : {Command::KeepLast, Command::KeepNext})
    CHECK(round_trip(Control{.id = 4, .command = command}).command == command);
  const ControlReply reply = round_trip(ControlReply{.id = 3, .errc = 503, .where = "door"});
  CHECK(reply.id == 3 && reply.errc == 503 && reply.where == "door");
  const Bye bye = round_trip(Bye{.reason = ByeReason::Refused, .text = "full", .protocol = 1});
  CHECK(bye.reason == ByeReason::Refused && bye.text == "full");
}

TEST(Messages, SettingsGoAlongWholeAndWithTheirLines) {
  const std::string text = "camera:\n  exposure_us: 400\n...\n";
  const Control control =
      round_trip(Control{.id = 3, .command = Command::UseSettings, .settings = text + "\x1b[2J"});
  CHECK(control.command == Command::UseSettings);
  STRCMP_EQUAL((text + "?[2J").c_str(), control.settings.c_str());
  CHECK(!round_trip(Health{}).settings);
  Health health;
  health.settings = SettingsState{.text = text, .rate_max_hz = 120.5, .changes = 2};
  const Health got = round_trip(health);
  STRCMP_EQUAL(text.c_str(), got.settings->text.c_str());
  CHECK(got.settings->rate_max_hz == 120.5 && got.settings->changes == 2);
  health.settings->rate_max_hz = -1;
  Bytes packet;
  encode({.body = health}, packet);
  CHECK(decode(packet).error().code == Errc::ProtocolError);
}

TEST(Messages, WhatTheUnitHasBeenThroughComesBack) {
  CHECK(!round_trip(Health{}).upkeep);
  Health health;
  health.upkeep = UpkeepState{.starts = 12,
                              .boots = 3,
                              .run_s = 469800,
                              .laser_s = 51120.5,
                              .lightings = 512,
                              .frames = 3000000000,
                              .coldest_degc = {},
                              .hottest_degc = {}};
  const UpkeepState dark = round_trip(health).upkeep.value();
  CHECK(dark.starts == 12 && dark.boots == 3 && dark.lightings == 512 && dark.frames == 3000000000);
  CHECK(dark.run_s == 469800 && dark.laser_s == 51120.5 && !dark.coldest_degc && !dark.hottest_degc);
  health.upkeep->coldest_degc = -3.5F;
  health.upkeep->hottest_degc = 46.25F;
  const UpkeepState warm = round_trip(health).upkeep.value();
  CHECK(warm.coldest_degc == -3.5F && warm.hottest_degc == 46.25F);
  health.upkeep->hottest_degc = std::numeric_limits<float>::infinity();
  FAILS_NAMING(Errc::ProtocolError, "temperature", decode(bytes_of({.body = health})));
  health.upkeep = UpkeepState{.laser_s = -1, .coldest_degc = {}, .hottest_degc = {}};
  FAILS_NAMING(Errc::ProtocolError, "upkeep", decode(bytes_of({.body = health})));
}

TEST(Messages, HealthAndEndCarryCountersAndStages) {
  Health health;
  health.counters.frames = 1;
  health.counters.overruns = 12;
  health.stages = {
      {.name = "encode", .count = 3, .min = Nanoseconds{1}, .mean = Nanoseconds{2}, .max = Nanoseconds{4}}};
  health.laser = LaserState::Fault;
  health.laser_reason = "door";
  health.scanning = true;
  const Health got = round_trip(health);
  CHECK(got.counters.frames == 1 && got.counters.overruns == 12 && got.laser == LaserState::Fault &&
        got.scanning);
  STRCMP_EQUAL("encode", got.stages.at(0).name.c_str());
  LONGS_EQUAL(4, got.stages.at(0).max.count());
  EndOfScan end;
  end.errc = 202;
  end.where = "frame 5";
  end.counters.messages_lost = 9;
  const EndOfScan ended = round_trip(end);
  CHECK(ended.errc == 202 && ended.where == "frame 5" && ended.counters.messages_lost == 9);
}

TEST(Messages, DevicesComeBackWithClocksAndTrigger) {
  Devices devices;
  devices.clocks = {{.name = "camera",
                     .known = true,
                     .offset = Nanoseconds{-7},
                     .uncertainty = Nanoseconds{9},
                     .drift_ppm = -3.5,
                     .steps = 2},
                    {.name = "poses", .drift_ppm = 0}};
  devices.trigger = TriggerState{.edges = 1,
                                 .edges_missed = 2,
                                 .edges_doubled = 3,
                                 .edges_late = 4,
                                 .edges_lost = 5,
                                 .frames_paired = 6,
                                 .frames_without_edge = 7,
                                 .frames_with_two_edges = 8,
                                 .edges_without_frame = 9};
  devices.trigger_by_software = devices.camera_connected = devices.poses_flow = devices.realtime = true;
  devices.camera_underruns = 10;
  devices.packets_resent = 11;
  devices.temperature_degc = 41.5F;
  devices.pose_reconnects = 12;
  devices.poses_unlatched = 13;
  devices.bus_errors = 14;
  devices.bus_restarts = 15;
  devices.watchdog_feeds_failed = 16;
  Health health;
  health.devices = devices;
  EndOfScan end;
  end.devices = devices;
  for (const Devices& got : {round_trip(health).devices, round_trip(end).devices}) {
    const ClockState& clock = got.clocks.at(0);
    CHECK(clock.name == "camera" && clock.known && clock.offset.count() == -7 &&
          clock.uncertainty.count() == 9);
    CHECK(clock.drift_ppm == -3.5 && clock.steps == 2 && !got.clocks.at(1).known);
    const TriggerState& t = got.trigger.value();
    CHECK(t.edges == 1 && t.edges_missed == 2 && t.edges_doubled == 3 && t.edges_late == 4 &&
          t.edges_lost == 5);
    CHECK(t.frames_paired == 6 && t.frames_without_edge == 7 && t.frames_with_two_edges == 8 &&
          t.edges_without_frame == 9);
    CHECK(got.trigger_by_software && got.camera_connected && got.poses_flow && got.realtime &&
          got.temperature_degc == 41.5F);
    CHECK(got.camera_underruns == 10 && got.packets_resent == 11 && got.pose_reconnects == 12 &&
          got.poses_unlatched == 13);
    CHECK(got.bus_errors == 14 && got.bus_restarts == 15 && got.watchdog_feeds_failed == 16);
  }
  CHECK(!round_trip(Health{}).devices.trigger && !round_trip(Health{}).devices.temperature_degc);
}

TEST(Messages, ObserverHelloComesBack) {
  const ObserverHello sent{
      .name = "web",
      .profile_rate_hz = 20,
      .picture = {.rate_hz = 12.5,
                  .width_max_px = 800,
                  .format = PictureFormat::Raw,
                  .quality = 60,
                  .region = {.offset_u_px = 1, .offset_v_px = 2, .width_px = 3, .height_px = 4}},
      .received = 77};
  const ObserverHello got = round_trip(sent);
  STRCMP_EQUAL("web", got.name.c_str());
  DOUBLES_EQUAL(20, got.profile_rate_hz, 0);
  CHECK(got.picture == sent.picture);
  LONGS_EQUAL(77, got.received);
}

TEST(Messages, ImpossibleWishesAreRefused) {
  ObserverHello hello;
  const auto refused = [&](const char* what) {
    FAILS_NAMING(Errc::ProtocolError, what, decode(bytes_of({.body = hello})));
    hello = {};
  };
  hello.profile_rate_hz = -1;
  refused("rate of profiles");
  hello.picture.rate_hz = std::numeric_limits<double>::quiet_NaN();
  refused("rate of pictures");
  hello.picture.width_max_px = 0;
  refused("1 px wide");
  hello.picture.quality = 101;
  refused("quality");
  hello.picture.format = static_cast<PictureFormat>(9);
  refused("format");
  hello.picture.region = {.offset_u_px = -1, .offset_v_px = 0, .width_px = 5, .height_px = 5};
  refused("impossible region");
}

TEST(Messages, PictureComesBackWithItsPeaks) {
  for (const PictureFormat format : {PictureFormat::Raw, PictureFormat::Jpeg}) {
    const Picture sent = made_picture(format);
    const Picture got = round_trip(sent);
    LONGS_EQUAL(19, got.frame_sequence);
    LONGS_EQUAL(12, got.profile_sequence);
    CHECK(sent.exposure_mid == got.exposure_mid);
    LONGS_EQUAL(6, got.width_px());
    LONGS_EQUAL(4, got.height_px());
    CHECK(sent.pixels == got.pixels && sent.format == got.format);
    LONGS_EQUAL(5, got.peaks.size());
    LONGS_EQUAL(6, got.peaks[2].u_px);
    DOUBLES_EQUAL(463.25, got.peaks[2].v_px, 0);
    LONGS_EQUAL(profile::k_point_reflection, got.peaks[2].flags);
    // The mean of sensor columns 4 and 5 is the picture's first pixel: its centre is column 4.5.
    DOUBLES_EQUAL(0, got.x_of(4.5), 1e-12);
    DOUBLES_EQUAL(1, got.y_of(462.5), 1e-12);
  }
}

TEST(Messages, PictureThatContradictsItselfIsRefused) {
  Picture picture = made_picture(PictureFormat::Raw);
  picture.pixels.pop_back();
  FAILS_NAMING(Errc::ProtocolError, "23 bytes instead of 24", decode(bytes_of({.body = picture})));
  picture = made_picture(PictureFormat::Raw);
  picture.step = 20;
  FAILS_NAMING(Errc::ProtocolError, "scale", decode(bytes_of({.body = picture})));
  picture = made_picture(PictureFormat::Raw);
  picture.peaks[1].v_px = std::numeric_limits<float>::infinity();
  FAILS_NAMING(Errc::ProtocolError, "picture.v_px", decode(bytes_of({.body = picture})));
  picture.peaks.resize(profile::k_max_profile_points + 1);
  FAILS_NAMING(Errc::ProtocolError, "peaks", decode(bytes_of({.body = picture})));
}

TEST(Messages, HelloSaysTheMinorVersion) {
  LONGS_EQUAL(k_protocol_minor, round_trip(made_hello()).protocol_minor);
  CHECK(!round_trip(made_hello()).test_pattern);
  SensorHello pattern = made_hello();
  pattern.test_pattern = true;
  CHECK(round_trip(pattern).test_pattern);
  Health health;
  health.observers = 3;
  health.pictures = 1234;
  LONGS_EQUAL(3, round_trip(health).observers);
  LONGS_EQUAL(1234, round_trip(health).pictures);
}

TEST(Messages, OtherProtocolIsToldApartFromRubbish) {
  FAILS_NAMING(Errc::NotSupported, "protocol 9", decode(bytes_of({.protocol = 9, .body = Ack{}})));
  SUCCEEDS(decode(bytes_of({.protocol = 9, .body = Bye{}})));
  FAILS_NAMING(Errc::ProtocolError, "not a Biteline message", decode({}));
  FAILS_NAMING(Errc::ProtocolError, "not a Biteline message", decode(Bytes(100, 0x42)));
}

TEST(Messages, TextsAreCutAndMadeFitForATerminal) {
  const HostHello got = round_trip(HostHello{.name = std::string(2000, 'x') + "\n"});
  LONGS_EQUAL(500, got.name.size());
  STRCMP_EQUAL("a?[31m?", round_trip(HostHello{.name = "a\x1b[31m\n"}).name.c_str());
}

TEST(Messages, PoseThatIsNoRotationIsRefused) {
  profile::Profile profile = test::made_profile(1, 2);
  profile.header.T_base_flange.linear() *= 1.001;
  FAILS_NAMING(Errc::ProtocolError, "rotation", decode(bytes_of({.body = profile})));
  profile.header.T_base_flange = SE3::Identity();
  profile.header.T_base_flange.linear()(0, 0) = -1;  // a mirror
  FAILS_NAMING(Errc::ProtocolError, "rotation", decode(bytes_of({.body = profile})));
  profile.header.T_base_flange = SE3::Identity();
  profile.header.T_base_flange.translation().y() = std::numeric_limits<double>::infinity();
  FAILS_NAMING(Errc::ProtocolError, "finite", decode(bytes_of({.body = profile})));
}

TEST(Messages, PoseFartherThanAnyArmIsRefused) {
  profile::Profile profile = test::made_profile(1, 2);
  for (const double far_mm : {1e308, -1e308, 1e39, 1.0001e5, std::numeric_limits<double>::quiet_NaN()}) {
    profile.header.T_base_flange.translation() = Vec3{0, 0, far_mm};
    FAILS_NAMING(Errc::ProtocolError, "farther than 100 m", decode(bytes_of({.body = profile})));
  }
  profile.header.T_base_flange.translation() = Vec3{0, 0, 1e5};
  SUCCEEDS(decode(bytes_of({.body = profile})));
}

TEST(Messages, TextsAreUtf8WhateverTheOtherSideSays) {
  STRCMP_EQUAL("M?ller", round_trip(HostHello{.name = "M\xFCller"}).name.c_str());
  std::string umlauts;
  for (int i = 0; i < 600; ++i) umlauts += "\xC3\xBC";
  const HostHello got = round_trip(HostHello{.name = "x" + umlauts});
  LONGS_EQUAL(499, got.name.size());
  STRCMP_EQUAL(("x" + umlauts.substr(0, 498)).c_str(), got.name.c_str());
}

TEST(Messages, PointThatIsNotFiniteIsRefused) {
  profile::Profile profile = test::made_profile(1, 3);
  profile.points[2].sigma_mm = std::numeric_limits<float>::quiet_NaN();
  FAILS_NAMING(Errc::ProtocolError, "sigma_mm", decode(bytes_of({.body = profile})));
}

TEST(Messages, EveryChangedBitIsNoticed) {
  const Bytes packet = bytes_of({.body = test::made_profile(3, 10)});
  for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
    Bytes damaged = packet;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    CHECK(!decode(damaged));
  }
}

/// Every byte of every message set to every kind of wrong value, and every message cut, with a checksum that
/// fits, as from someone who means it: decode() may refuse or accept, but it must return.  Under the address
/// sanitizer this proves that it never reads beyond.
TEST(Messages, GarbledBytesNeverHarm) {
  Health health;
  health.stages = {{.name = "a"}, {.name = "b"}};
  health.devices.clocks = {{.name = "c"}};
  health.devices.trigger.emplace();
  const Bytes packets[] = {bytes_of({.body = test::made_profile(3, 20)}),
                           bytes_of({.body = made_hello()}),
                           bytes_of({.body = health}),
                           bytes_of({.body = HostHello{.name = "x"}}),
                           bytes_of({.body = Control{}}),
                           bytes_of({.body = ObserverHello{.name = "x", .picture = {}}}),
                           bytes_of({.body = made_picture(PictureFormat::Raw)})};
  std::mt19937 random{5};
  int refused = 0;
  for (Bytes packet : packets) {
    packet.resize(packet.size() - 4);  // sealed() gives the checksum anew
    for (std::size_t size = 0; size < packet.size(); ++size) {
      if (!decode(sealed({packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(size)}))) ++refused;
    }
    for (std::size_t at = 0; at < packet.size(); ++at) {
      for (const std::uint8_t value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
        Bytes garbled = packet;
        garbled[at] = value;
        if (!decode(sealed(garbled))) ++refused;
      }
    }
    for (int round = 0; round < 2000 * test::fuzz_factor(); ++round) {
      Bytes garbled = packet;
      for (int i = 0; i < 4; ++i) garbled[random() % garbled.size()] = static_cast<std::uint8_t>(random());
      if (!decode(sealed(garbled))) ++refused;
    }
  }
  CHECK(refused > 1000);
  // Checking garbled numbers underflows on tiny ones and looks at signalling NaNs; both only lead to a
  // refusal.
  std::feclearexcept(FE_UNDERFLOW | FE_INVALID);
}

}  // namespace biteline::wire
