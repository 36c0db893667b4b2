// SPDX-License-Identifier: MIT
// Against the controller's side of our own codec, on loopback, both ends stepped by the test's one thread.
#include "hal/linux/rtde/rtde_pose_source.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cfenv>
#include <functional>
#include <iterator>
#include <limits>
#include <random>

#include "common/rtde/controller_session.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

const SE3 k_T_flange_tcp = [] {
  SE3 T = SE3::Identity();
  T.translation() = Vec3{0, 0, 150};
  T.linear() = geometry::exp_so3({0, 0.3, 0});
  return T;
}();

rtde::Vector6 to_wire(const SE3& T) {
  const Vec3 rotation_rad = geometry::log_so3(T.linear());
  const Vec3 p_m = T.translation() / 1000;
  return {p_m.x(), p_m.y(), p_m.z(), rotation_rad.x(), rotation_rad.y(), rotation_rad.z()};
}

struct Arm final : rtde::ValueSource {
  double time_s{100};
  SE3 T_base_flange{SE3::Identity()};
  rtde::Value value_of(std::string_view name) const override {
    if (name == "timestamp") return time_s;
    if (name == "actual_TCP_pose") return to_wire(T_base_flange * k_T_flange_tcp);
    if (name == "tcp_offset") return to_wire(k_T_flange_tcp);
    if (name == "runtime_state") return std::uint32_t{2};
    if (name == "safety_status_bits") return std::uint32_t{1U << 2U};
    return rtde::zero_of(*rtde::output_type(name));
  }
};

/// A controller with one connection at a time.
struct Controller final : rtde::ControllerListener {
  rtde::ControllerSession session;
  Arm arm;
  Descriptor listener{::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)};
  Descriptor peer;
  std::uint16_t port{0};
  std::uint64_t cycle{0};
  bool speaks{true};
  std::function<void(rtde::Bytes&)> spoil{};  ///< changes what is about to be sent

  explicit Controller(rtde::ProtocolVersion newest = rtde::ProtocolVersion::V2)
      : session{rtde::ControllerSession::Config{.newest = newest}} {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    CHECK_EQUAL(0, ::bind(listener.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address));
    CHECK_EQUAL(0, ::listen(listener.number(), 1));
    socklen_t size = sizeof address;
    ::getsockname(listener.number(), reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
  }

  void on_inputs(const rtde::Recipe&, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}

  /// One controller cycle of 2 ms.
  void step() {
    if (!peer.is_open()) {
      peer = Descriptor{::accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK)};
      if (!peer.is_open()) return;
      const int on = 1;  // else the second segment of each cycle waits for the first one's acknowledgement
      ::setsockopt(peer.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      session.start();
    }
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t size = ::recv(peer.number(), bytes.data(), bytes.size(), 0);
    if (size == 0) return peer.close();
    if (size > 0 && !session.consume(std::span{bytes}.first(static_cast<std::size_t>(size)), *this))
      peer.close();
    arm.time_s += 0.002;
    session.append_outputs(cycle++, arm);
    if (!speaks || session.outgoing().empty()) return;
    if (spoil) spoil(session.outgoing());
    // In two segments, cut where no package ends.
    const std::size_t cut = session.outgoing().size() / 3;
    ::send(peer.number(), session.outgoing().data(), cut, MSG_NOSIGNAL);
    ::send(peer.number(), session.outgoing().data() + cut, session.outgoing().size() - cut, MSG_NOSIGNAL);
    session.outgoing().clear();
  }
};

struct Link {
  Controller& controller;
  std::unique_ptr<RtdePoseSource> sut;

  explicit Link(Controller& served) : controller{served} {
    sut = RtdePoseSource::open({.controller = {.address = "127.0.0.1", .port = served.port},
                                .connect_timeout = 2s,
                                .retry_after = 1ms,
                                .stale_after = 30ms,
                                .reconnect_after = 300ms})
              .value();
    CHECK(sut->start().has_value());
  }
  /// Steps both until a pose comes; 2000 steps are far beyond the hand-shake's dozen.
  std::optional<RobotPose> pose() {
    for (int i = 0; i < 2000; ++i) {
      controller.step();
      if (Result<RobotPose> sample = sut->next_pose(1ms)) return *sample;
    }
    if (sut->last_fault()) FAIL(to_line(*sut->last_fault()).c_str());
    return std::nullopt;
  }
};

// Metres as doubles on the wire, radians through log and exp.
constexpr double k_tol_mm = 1e-9;
constexpr double k_tol_rad = 1e-7;

TEST_GROUP(RtdePoseSource){};

TEST(RtdePoseSource, GivesTheFlangeInOurUnits) {
  for (const rtde::ProtocolVersion newest : {rtde::ProtocolVersion::V2, rtde::ProtocolVersion::V1}) {
    Controller controller{newest};
    controller.arm.T_base_flange.translation() = Vec3{400, -120, 333};
    controller.arm.T_base_flange.linear() = geometry::exp_so3({0.4, -1.2, 0.1});
    Link link{controller};
    const std::optional<RobotPose> pose = link.pose();
    CHECK(pose.has_value());
    TRANSFORMS_EQUAL(controller.arm.T_base_flange, pose->T_base_flange, k_tol_mm, k_tol_rad);
    CHECK_EQUAL(k_pose_program_running | k_pose_protective_stop, pose->status);
    CHECK(link.sut->health().state == PoseState::Streaming);
  }
}

TEST(RtdePoseSource, FollowsItsStateTable) {
  const auto sut = RtdePoseSource::open({.controller = {.address = "127.0.0.1", .port = 1}}).value();
  CHECK(sut->next_pose(0ns).error().code == Errc::WrongState);
  CHECK(sut->start().has_value());
  CHECK(sut->start().error().code == Errc::WrongState);
  CHECK(sut->next_pose(1ms).error().code == Errc::Timeout);
  CHECK(sut->health().state == PoseState::Connecting);
  CHECK(sut->last_fault()->code == Errc::ConnectFailed);
  // Whoever only knows a PoseSource is told that nobody was there, too.
  const PoseSource& source = *sut;
  CHECK(source.fault()->code == Errc::ConnectFailed);
  STRCMP_CONTAINS("cannot connect (Connection refused)", to_line(*source.fault()).c_str());
  CHECK(sut->stop().has_value());
  CHECK(sut->health().state == PoseState::Idle);
}

TEST(RtdePoseSource, ConnectionCutIsMadeAnewWithItsRecipe) {
  Controller controller;
  Link link{controller};
  CHECK(link.pose().has_value());
  controller.peer.close();
  while (link.sut->health().state == PoseState::Streaming) static_cast<void>(link.sut->next_pose(1ms));
  CHECK(link.sut->health().state == PoseState::Lost);
  CHECK(link.pose().has_value());
  CHECK_EQUAL(1, link.sut->health().reconnects);
}

TEST(RtdePoseSource, SilentControllerIsStaleThenGivenUp) {
  Controller controller;
  Link link{controller};
  CHECK(link.pose().has_value());
  controller.speaks = false;
  for (int i = 0; i < 1000 && link.sut->health().state == PoseState::Streaming; ++i) {
    static_cast<void>(link.sut->next_pose(1ms));
  }
  CHECK(link.sut->health().state == PoseState::Lost);
  for (int i = 0; i < 2000 && !link.sut->last_fault(); ++i) static_cast<void>(link.sut->next_pose(1ms));
  STRCMP_EQUAL("RTDE controller is silent", link.sut->last_fault()->where.c_str());
  STRCMP_CONTAINS("RTDE controller is silent", link.sut->next_pose(0ms).error().where.c_str());
}

/// A controller that sends its packages in bursts, or stalls for a moment: stale meanwhile, but neither the
/// connection nor a pose is lost.
TEST(RtdePoseSource, BurstsAndShortStallsCostNoConnectionAndNoPose) {
  Controller controller;
  Link link{controller};
  for (int i = 0; i < 3; ++i) CHECK(link.pose().has_value());
  std::uint64_t lost_states = 0;
  for (int burst = 0; burst < 3; ++burst) {
    controller.speaks = false;  // 150 cycles pile up: 0.3 s at 500 Hz, more than the waiting samples
    for (int i = 0; i < 150; ++i) controller.step();
    while (link.sut->next_pose(1ms)) {
    }
    const SensorClock::time_point until = monotonic_now() + 60ms;  // of 300 that end the connection
    while (monotonic_now() < until) static_cast<void>(link.sut->next_pose(1ms));
    lost_states += link.sut->health().state == PoseState::Lost ? 1 : 0;
    controller.speaks = true;
    for (int i = 0; i < 150; ++i) CHECK(link.pose().has_value());
  }
  CHECK_EQUAL(3, lost_states);
  CHECK(link.sut->health().state == PoseState::Streaming);
  CHECK_EQUAL(0, link.sut->health().poses_lost);
  CHECK_EQUAL(0, link.sut->health().reconnects);
}

TEST(RtdePoseSource, ControllerThatTypesAFieldOtherwiseIsNamed) {
  Controller controller;
  controller.spoil = [](rtde::Bytes& bytes) {
    const std::string_view known = "VECTOR6D,UINT32";
    const auto at = std::search(bytes.begin(), bytes.end(), known.begin(), known.end());
    if (at != bytes.end()) std::copy_n("VECTOR6D,UINT64", known.size(), at);
  };
  Link link{controller};
  for (int i = 0; i < 2000; ++i) {
    controller.step();
    const Result<RobotPose> pose = link.sut->next_pose(1ms);
    CHECK_FALSE(pose.has_value());
    if (pose.error().code == Errc::Timeout) continue;
    STRCMP_EQUAL("RTDE variable runtime_state: UINT64, UINT32 expected", pose.error().where.c_str());
    return;
  }
  FAIL("never told");
}

TEST(RtdePoseSource, AControllerTooOldForAVariableIsToldWithTheVersionThatHasIt) {
  Controller controller;
  controller.spoil = [](rtde::Bytes& bytes) {
    const std::string_view known = "VECTOR6D,UINT32";
    const auto at = std::search(bytes.begin(), bytes.end(), known.begin(), known.end());
    if (at == bytes.end()) return;
    const std::string_view lacking = "NOT_FOUND";
    bytes.erase(at, at + 8);
    bytes.insert(at, lacking.begin(), lacking.end());
    ++bytes[1];
  };
  Link link{controller};
  for (int i = 0; i < 2000; ++i) {
    controller.step();
    const Result<RobotPose> pose = link.sut->next_pose(1ms);
    CHECK_FALSE(pose.has_value());
    if (pose.error().code == Errc::Timeout) continue;
    CHECK(pose.error().code == Errc::PeerRefused);
    STRCMP_CONTAINS("tcp_offset: NOT_FOUND", pose.error().where.c_str());
    STRCMP_CONTAINS("PolyScope 3.12.3 or 5.5.1", pose.error().where.c_str());
    return;
  }
  FAIL("never told");
}

TEST(RtdePoseSource, TextsAndUnknownPackagesAloneAreNoSignOfLife) {
  Controller controller;
  Link link{controller};
  CHECK(link.pose().has_value());
  controller.spoil = [](rtde::Bytes& bytes) { bytes = {0, 6, 'M', 1, 2, 3, 0, 4, 'Z', 1}; };
  for (int i = 0; i < 4000 && !link.sut->last_fault(); ++i) {
    controller.step();
    static_cast<void>(link.sut->next_pose(1ms));
  }
  STRCMP_EQUAL("RTDE controller is silent", link.sut->last_fault()->where.c_str());
}

TEST(RtdePoseSource, CyclesThatNeverCameAreCounted) {
  Controller controller;
  Link link{controller};
  for (int i = 0; i < 3; ++i) CHECK(link.pose().has_value());  // the period is known from here on
  controller.arm.time_s += 0.010;                              // five cycles
  std::uint64_t lost = 0;
  for (int i = 0; i < 100 && lost == 0; ++i) {
    CHECK(link.pose().has_value());
    lost = link.sut->health().poses_lost;
  }
  CHECK_EQUAL(5, lost);
}

TEST_GROUP(RtdeSamples) {
  RtdeSamples sut{{.rate_hz = 500}};
  SensorClock::time_point now{50s};

  void feed(double time_s, const rtde::Vector6& pose = {}) {
    const std::array<rtde::Value, 5> values{time_s, pose, rtde::Vector6{}, std::uint32_t{0},
                                            std::uint32_t{0}};
    now += 2ms;
    sut.set_received(now);
    sut.on_data(0, values);
  }
};

TEST(RtdeSamples, ControllersClockIsMappedOnceItIsKnown) {
  for (int i = 0; i < 300; ++i) feed(7 + 0.002 * i);
  std::optional<RobotPose> last;
  while (std::optional<RobotPose> sample = sut.take()) last = sample;
  CHECK(last->stamp_sensor.has_value());
  CHECK(std::chrono::abs(*last->stamp_sensor - now) < 1us);
  CHECK(sut.clock_health().ready);
}

/// A CB3 takes a wish for 500 Hz and gives its 125; version 1 cannot wish at all.
TEST(RtdeSamples, LossesAreCountedByTheControllersOwnPeriod) {
  for (const double period_s : {0.002, 0.004, 0.008, 0.1}) {
    RtdeSamples samples{{.rate_hz = 500}};
    const auto take = [&](double time_s) {
      samples.on_data(0, std::array<rtde::Value, 5>{time_s, rtde::Vector6{}, rtde::Vector6{},
                                                    std::uint32_t{0}, std::uint32_t{0}});
      return samples.take().has_value();
    };
    for (int cycle = 0; cycle < 100; ++cycle) CHECK(take(7 + period_s * cycle));
    CHECK_EQUAL(0, samples.counts().poses_lost);
    CHECK(take(7 + period_s * 103));  // three did not come
    CHECK_EQUAL(3, samples.counts().poses_lost);
    samples.begin_connection();
    CHECK(take(7 + period_s * 114));  // ten while nobody was connected
    CHECK_EQUAL(13, samples.counts().poses_lost);
    for (int cycle = 115; cycle < 200; ++cycle) CHECK(take(7 + period_s * cycle));
    CHECK_EQUAL(13, samples.counts().poses_lost);
  }
}

TEST(RtdeSamples, WhatNobodyFetchesIsLostAndCounted) {
  for (int i = 0; i < 100; ++i) feed(7 + 0.002 * i);
  CHECK_EQUAL(100 - 64, sut.counts().poses_lost);
  CHECK_EQUAL(37, sut.take()->sequence);
}

TEST(RtdeSamples, NonsenseIsRejected) {
  feed(std::nan(""));
  feed(1e300);
  feed(1, {1e9, 0, 0, 0, 0, 0});
  feed(1.1, {0, 0, 0, std::nan(""), 0, 0});
  CHECK_EQUAL(4, sut.counts().poses_rejected);
  CHECK_FALSE(sut.take().has_value());
}

TEST(RtdeSamples, StampsThatDoNotRiseAreRejected) {
  feed(5);
  feed(5);
  feed(4.998);
  CHECK_EQUAL(2, sut.counts().poses_rejected);
}

TEST(RtdeSamples, ControllerThatStartedAnewIsBelievedOnItsNewConnection) {
  feed(5000);
  sut.begin_connection();
  feed(1);
  CHECK(sut.take().has_value());
  CHECK(sut.take().has_value());
}

/// A controller may say any number: what is given out is a pose on a rising stamp, and no arithmetic
/// overflows.
TEST(RtdePoseSource, NumbersOfAnySizeAreRejectedOrPoses) {
  std::mt19937_64 random{9};
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double k_infinite = std::numeric_limits<double>::infinity();
  const double wild[] = {k_nan, k_infinite, -k_infinite, 0,  -0.0, 1e-320, 1e308, -1e308,
                         9e9,   -9e9,       8.9e9,       -1, 1e5,  3,      -3};
  RtdeSamples sut{{}};
  SensorClock::time_point received{10s};
  double time_s = 50;
  std::uint64_t given = 0;
  for (int round = 0; round < 20000 * test::fuzz_factor(); ++round) {
    const auto number = [&](double usual) {
      return random() % 40 == 0 ? wild[random() % std::size(wild)] : usual;
    };
    time_s += 0.002;
    received += 2ms;
    const std::array<rtde::Value, 5> values{
        number(time_s), rtde::Vector6{number(0.1), number(0.2), 0.3, number(3.1), 0, number(0)},
        rtde::Vector6{0, 0, number(0.15), 0, 0, number(0.3)}, std::uint32_t{2},
        static_cast<std::uint32_t>(random())};
    if (random() % 500 == 0) sut.begin_connection();
    sut.set_received(received);
    sut.on_data(0, values);
    while (const std::optional<RobotPose> sample = sut.take()) {
      ++given;
      CHECK(sample->T_base_flange.matrix().allFinite());
    }
  }
  CHECK(given > 1000);
  CHECK(sut.counts().poses_rejected > 100);
  std::feclearexcept(FE_UNDERFLOW);  // of numbers next to nothing
}

}  // namespace
}  // namespace biteline::hal
