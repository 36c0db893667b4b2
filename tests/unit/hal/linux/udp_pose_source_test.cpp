// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/udp_pose_source.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <string>
#include <vector>

#include "hal/sim/robot/egm_stream.hpp"
#include "hal/sim/robot/rsi_exchange.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;
using Language = UdpPoseSource::Language;

SE3 at_x(double x_mm) {
  SE3 T = SE3::Identity();
  T.translation().x() = x_mm;
  return T;
}

std::unique_ptr<UdpPoseSource> started(Language language) {
  std::unique_ptr<UdpPoseSource> sut =
      UdpPoseSource::open({.language = language, .lost_after = 20ms}).value();
  SUCCEEDS(sut->start());
  return sut;
}

/// What arrived is there at once, on this machine: nothing is waited for.
std::vector<RobotPose> all_poses(UdpPoseSource& sut) {
  std::vector<RobotPose> poses;
  for (int message = 0; message < 100; ++message) {  // more than any test sends
    if (Result<RobotPose> pose = sut.next_pose(0ns)) poses.push_back(*pose);
  }
  return poses;
}

void wait_until_lost(UdpPoseSource& sut) {
  while (sut.health().state == PoseState::Streaming) static_cast<void>(sut.next_pose(1ms));
  CHECK(sut.health().state == PoseState::Lost);
}

TEST_GROUP(UdpPoseSource) {
  SensorClock::time_point instant{5000s};
};

TEST(UdpPoseSource, FollowsItsStateTable) {
  const auto sut = UdpPoseSource::open({}).value();
  CHECK(sut->next_pose(0ns).error().code == Errc::WrongState);
  SUCCEEDS(sut->start());
  CHECK(sut->start().error().code == Errc::WrongState);
  FAILS_NAMING(Errc::Timeout, "no word of the controller at UDP port", sut->next_pose(1ms));
  CHECK_FALSE(sut->fault().has_value());
  CHECK(sut->health().state == PoseState::Connecting);
  SUCCEEDS(sut->stop());
  CHECK(sut->health().state == PoseState::Idle);
  SUCCEEDS(sut->start());
}

TEST(UdpPoseSource, ANameIsNoAddressAndATakenPortIsTold) {
  FAILS_NAMING(Errc::BadValue, "robot.local is no IPv4 address",
               UdpPoseSource::open({.controller = "robot.local"}));
  const auto first = started(Language::Egm);
  const auto second = UdpPoseSource::open({.port = first->port()}).value();
  FAILS_NAMING(Errc::DeviceError, ("UDP port " + std::to_string(first->port())).c_str(), second->start());
}

TEST(UdpPoseSource, GivesEachPoseOfEgmOnce) {
  const auto sut = started(Language::Egm);
  sim::EgmStream robot = sim::EgmStream::open({.port = sut->port()}).value();
  for (int i = 0; i < 50; ++i) robot.send(instant + 4ms * i, at_x(i), true);
  const std::vector<RobotPose> poses = all_poses(*sut);
  CHECK_EQUAL(50U, poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    DOUBLES_EQUAL(static_cast<double>(i), poses[i].T_base_flange.translation().x(), 0);
    CHECK_EQUAL(i + 1, poses[i].sequence);
    CHECK(poses[i].stamp.time_since_epoch() == (instant + 4ms * i).time_since_epoch());
    CHECK_EQUAL(std::uint32_t{k_pose_program_running}, poses[i].status);
  }
  CHECK(sut->health().state == PoseState::Streaming);
  CHECK_EQUAL(0U, sut->health().poses_lost);
  CHECK_EQUAL(0U, sut->health().poses_rejected);
}

TEST(UdpPoseSource, CountsWhatEgmLost) {
  const auto sut = started(Language::Egm);
  sim::EgmStream robot = sim::EgmStream::open({.port = sut->port()}).value();
  robot.send(instant, at_x(0), true);
  for (int i = 0; i < 3; ++i) robot.lose();
  robot.send(instant + 16ms, at_x(1), true);
  CHECK_EQUAL(5U, all_poses(*sut).back().sequence);
  CHECK_EQUAL(3U, sut->health().poses_lost);
}

/// At 4 ms and at 12 ms: the controller's own cycle is the least step.
TEST(UdpPoseSource, CountsWhatRsiLost) {
  for (const Nanoseconds cycle : {4ms, 12ms}) {
    const auto sut = started(Language::Rsi);
    sim::RsiExchange robot = sim::RsiExchange::open({.port = sut->port()}).value();
    for (const int step : {0, 1, 2, 5, 6}) robot.step(instant + step * cycle, at_x(step));
    CHECK_EQUAL(7U, all_poses(*sut).back().sequence);
    CHECK_EQUAL(2U, sut->health().poses_lost);
  }
}

TEST(UdpPoseSource, ToldAgainOrTooLateIsNoPose) {
  const auto sut = started(Language::Rsi);
  sim::RsiExchange robot = sim::RsiExchange::open({.port = sut->port()}).value();
  for (const int step : {10, 11, 11, 9, 12, 12}) robot.step(instant + 4ms * step, at_x(step));
  const std::vector<RobotPose> poses = all_poses(*sut);
  CHECK_EQUAL(3U, poses.size());
  CHECK_EQUAL(3U, sut->health().poses_rejected);
  CHECK_EQUAL(0U, sut->health().poses_lost);
}

/// A controller that sends one and the same message for ever, over a second: it is never believed again.
TEST(UdpPoseSource, AControllerWhoseClockStandsIsLost) {
  const auto sut = started(Language::Rsi);
  sim::RsiExchange robot = sim::RsiExchange::open({.port = sut->port()}).value();
  robot.step(instant, at_x(0));
  CHECK_EQUAL(1U, all_poses(*sut).size());
  for (int i = 0; i < 250; ++i) {
    robot.step(instant, at_x(0));
    CHECK_FALSE(sut->next_pose(0ns).has_value());
    CHECK_FALSE(sut->next_pose(1ms).has_value());
  }
  CHECK(sut->health().state == PoseState::Lost);
  FAILS_NAMING(Errc::Timeout, "do not go on in time", sut->next_pose(0ns));
}

TEST(UdpPoseSource, AnswersEachMessageOfRsiWithItsCount) {
  const auto sut = started(Language::Rsi);
  sim::RsiExchange robot = sim::RsiExchange::open({.port = sut->port()}).value();
  for (int i = 0; i < 200; ++i) {
    robot.step(instant + 4ms * i, at_x(i));
    CHECK(sut->next_pose(1s).has_value());
  }
  CHECK_EQUAL(199U, robot.counts().answered);
  CHECK_EQUAL(0U, robot.counts().wrong);
  CHECK_EQUAL(0, robot.counts().unanswered);
}

TEST(UdpPoseSource, NothingIsAnsweredToEgmNorToARsiThatOnlySends) {
  const auto egm = started(Language::Egm);
  const sim::UdpSender abb = sim::UdpSender::open(egm->port()).value();
  abb.send(sim::EgmStream::open({})->message(10s, at_x(1), false));
  CHECK_EQUAL(1U, all_poses(*egm).size());
  CHECK_FALSE(abb.receive().has_value());
  const auto rsi = UdpPoseSource::open({.language = Language::Rsi, .answers = false}).value();
  SUCCEEDS(rsi->start());
  const sim::UdpSender kuka = sim::UdpSender::open(rsi->port()).value();
  const std::string text = sim::RsiExchange::message(10'000, at_x(1), 0);
  kuka.send({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  CHECK_EQUAL(1U, all_poses(*rsi).size());
  CHECK_FALSE(kuka.receive().has_value());
}

TEST(UdpPoseSource, AControllerThatIsNotAnsweredEndsItsExchange) {
  sim::RsiExchange robot = sim::RsiExchange::open({.port = 9, .unanswered_most = 100}).value();
  for (int i = 0; i < 200; ++i) robot.step(instant + 4ms * i, at_x(i));
  CHECK(robot.counts().ended);
  CHECK_EQUAL(100U, robot.counts().sent);
}

/// Another program of the same machine, between the controller's messages; then alone.
TEST(UdpPoseSource, AForeignSenderIsNotBelievedWhileTheControllerSpeaks) {
  const auto sut = started(Language::Egm);
  sim::EgmStream robot = sim::EgmStream::open({.port = sut->port()}).value();
  sim::EgmStream forger = sim::EgmStream::open({.port = sut->port()}).value();
  for (int i = 0; i < 20; ++i) {
    robot.send(instant + 4ms * i, at_x(i), true);
    forger.send(instant + 4ms * i + 2ms, at_x(-1000), true);
  }
  const std::vector<RobotPose> poses = all_poses(*sut);
  CHECK_EQUAL(20U, poses.size());
  CHECK(std::ranges::all_of(poses,
                            [](const RobotPose& pose) { return pose.T_base_flange.translation().x() >= 0; }));
  CHECK_EQUAL(20U, sut->health().poses_rejected);
}

TEST(UdpPoseSource, AnotherMachineIsNeverBelieved) {
  // Whatever sends here comes from 127.0.0.1.
  const auto sut = UdpPoseSource::open({.controller = "127.0.0.7"}).value();
  SUCCEEDS(sut->start());
  sim::EgmStream forger = sim::EgmStream::open({.port = sut->port()}).value();
  forger.send(instant, at_x(1), true);
  FAILS_NAMING(Errc::Timeout, "the controller at 127.0.0.7 is heard alone", sut->next_pose(1ms));
  CHECK_EQUAL(1U, sut->health().poses_rejected);
  CHECK(sut->health().state == PoseState::Connecting);
}

/// From another port, its clock from the beginning: an EGM session that was started anew.
TEST(UdpPoseSource, AControllerThatStartedAnewIsBelievedAfterSilence) {
  const auto sut = started(Language::Egm);
  sim::EgmStream before = sim::EgmStream::open({.port = sut->port()}).value();
  for (int i = 0; i < 3; ++i) before.send(instant + 4ms * i, at_x(i), true);
  CHECK_EQUAL(3U, all_poses(*sut).size());
  wait_until_lost(*sut);
  sim::EgmStream after = sim::EgmStream::open({.port = sut->port()}).value();
  after.send(SensorClock::time_point{3s}, at_x(7), true);
  const std::vector<RobotPose> poses = all_poses(*sut);
  CHECK_EQUAL(1U, poses.size());
  CHECK_EQUAL(4U, poses.back().sequence);
  CHECK_EQUAL(1U, sut->health().reconnects);
  CHECK_FALSE(poses.back().stamp_sensor.has_value());
}

TEST(UdpPoseSource, GarbageIsCountedAndToldAndWhatIsTooLongToo) {
  const auto sut = started(Language::Rsi);
  const sim::UdpSender garbage = sim::UdpSender::open(sut->port()).value();
  garbage.send(std::vector<std::uint8_t>{1, 2, 3});
  FAILS_NAMING(Errc::Timeout, "RSI: no text of a controller", sut->next_pose(0ns));
  CHECK(sut->fault()->code == Errc::ProtocolError);
  std::string long_text = sim::RsiExchange::message(1, at_x(0), 0);
  long_text.insert(long_text.find("<Delay"), 5000, ' ');
  garbage.send({reinterpret_cast<const std::uint8_t*>(long_text.data()), long_text.size()});
  CHECK_FALSE(sut->next_pose(0ns).has_value());
  CHECK_EQUAL(2U, sut->health().poses_rejected);
  sim::RsiExchange robot = sim::RsiExchange::open({.port = sut->port()}).value();
  robot.step(instant, at_x(0));
  CHECK_EQUAL(1U, all_poses(*sut).size());
  CHECK_FALSE(sut->fault().has_value());
}

/// Who sends faster than anybody reads does not keep the caller beyond its time.
TEST(UdpPoseSource, AFloodOfGarbageEndsWithTheTimeout) {
  const auto sut = started(Language::Egm);
  const sim::UdpSender garbage = sim::UdpSender::open(sut->port()).value();
  for (int i = 0; i < 100; ++i) garbage.send(std::vector<std::uint8_t>{0xFF});
  CHECK(sut->next_pose(0ns).error().code == Errc::Timeout);
  CHECK(sut->health().poses_rejected < 100);
}

TEST_GROUP(ToldPoses) {
  ToldPoses sut;
  SensorClock::time_point received{50s};
  Nanoseconds offset{-43s};

  /// \param late beyond the least delay
  std::optional<RobotPose> hear(Nanoseconds late = 0ns) {
    received += 4ms;
    return sut.accept({.stamp = RobotClock::time_point{received.time_since_epoch() + offset}},
                      received + late);
  }
};

TEST(ToldPoses, ControllersClockIsMappedOnceItIsKnown) {
  CHECK_FALSE(hear()->stamp_sensor.has_value());
  std::optional<RobotPose> last;
  for (int i = 0; i < 300; ++i) last = hear(i % 5 == 0 ? 0us : 900us);
  CHECK(sut.clock_health().ready);
  CHECK(std::chrono::abs(*last->stamp_sensor - received) < 1us);
}

TEST(ToldPoses, AClockThatWasSetBackIsSeenAndBelievedAnew) {
  for (int i = 0; i < 300; ++i) CHECK(hear().has_value());
  offset -= 10s;
  int rejected = 0;
  while (!hear() && rejected < 1000) ++rejected;
  CHECK(rejected > 10 && rejected < 50);  // ClockMapCore::Config::late_run is 25
  CHECK_EQUAL(1U, sut.clock_health().steps);
  CHECK(hear().has_value());
}

}  // namespace
}  // namespace biteline::hal
