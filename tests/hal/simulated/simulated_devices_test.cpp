// SPDX-License-Identifier: MIT
// What every backend must do, asked of those without a device: wires and controller of the simulated cell, a
// recording.
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include "hal/linux/arm_link_poses/arm_link_pose_source.hpp"
#include "hal/linux/rtde/rtde_pose_source.hpp"
#include "hal/linux/socketcan/can_encoder.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/linux/socketcan/encoder_pose_source.hpp"
#include "hal/linux/udp_poses/udp_pose_source.hpp"
#include "hal/replay/recording.hpp"
#include "hal/replay/replay_camera.hpp"
#include "hal/replay/replay_poses.hpp"
#include "hal/sim/bus/bus_devices.hpp"
#include "hal/sim/bus/bus_server.hpp"
#include "hal/sim/robot/egm_stream.hpp"
#include "hal/sim/robot/path_taker.hpp"
#include "hal/sim/robot/rsi_exchange.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "tests/hal/conformance/camera.hpp"
#include "tests/hal/conformance/can_bus.hpp"
#include "tests/hal/conformance/encoder_in.hpp"
#include "tests/hal/conformance/lines.hpp"
#include "tests/hal/conformance/pose_source.hpp"
#include "tests/hal/conformance/pwm_out.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {
namespace {

using namespace std::chrono_literals;

TEST_GROUP(SimulatedWires) {
  std::string name = "biteline-conformance-" + std::to_string(::getpid());
  hal::MonotonicClock clock;
  std::unique_ptr<sim::BusServer> cell;

  void setup() override {
    test::note_ran();
    // A bus: what one node sends all others hear; the suite's peer does not listen to itself.
    cell = *sim::BusServer::open(
        name, {.on_line = {}, .on_trigger = {}, .on_can = [this](const hal::CanFrame& frame) {
                 hal::CanFrame heard = frame;
                 heard.received = clock.now();
                 cell->send(heard);
               }});
  }
  void teardown() override {
    cell.reset();
  }

  /// A question that is answered after all that was sent before, and after the end of a connection was
  /// noticed.
  [[nodiscard]] bool level_outside() const {
    CHECK((*sim::SimSafetyIn::open(name))->read().has_value());
    return cell->level(sim::Line::LaserEnable);
  }
};

TEST(SimulatedWires, OutputConforms) {
  conformance::check_gpio_out(sim::SimGpioOut::open(name, sim::Line::LaserEnable).value(),
                              [this] { return level_outside(); });
}

TEST(SimulatedWires, EdgesConform) {
  const auto sut = sim::SimEdgeIn::open(name, sim::Line::StrobeEcho).value();
  conformance::check_edge_in(*sut,
                             [this](bool level) { cell->drive(sim::Line::StrobeEcho, level, clock.now()); });
}

TEST(SimulatedWires, TriggerConforms) {
  conformance::check_pwm_out(*sim::SimPwmOut::open(name).value());
}

TEST(SimulatedWires, BusConforms) {
  const auto sut = sim::SimCanBus::open(name).value();
  const auto peer = sim::SimCanBus::open(name).value();
  conformance::check_can_bus(*sut, *peer, {.fd = true, .extended = true});
}

TEST(SimulatedWires, PosesOnTheBusConform) {
  hal::CanPoseSource sut{sim::SimCanBus::open(name).value(), clock, {}};
  canpose::PoseMessage pose{.sync_counter = 0};
  conformance::check_pose_source(sut, [&] {
    pose.sync_counter = static_cast<std::uint8_t>(pose.sync_counter % canpose::k_sync_counter_last + 1);
    pose.stamp_us += 8000;
    hal::CanFrame frame{
        .id = canpose::k_sync_id, .size_bytes = 1, .data = {pose.sync_counter}, .received = clock.now()};
    cell->send(frame);
    const canpose::FdFrame coded = canpose::encode_fd(pose).value();
    frame.id = canpose::k_default_base_id + canpose::k_fd_id_offset;
    frame.fd = true;
    frame.size_bytes = canpose::k_fd_size_bytes;
    std::copy(coded.begin(), coded.end(), frame.data.begin());
    cell->send(frame);
  });
}

hal::CanFrame encoder_frame(std::uint8_t node, std::uint32_t place_ticks, SensorClock::time_point stamp) {
  hal::CanFrame frame{.id = canpose::tpdo1_id(node), .size_bytes = 4, .received = stamp};
  for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(place_ticks >> (8 * i));
  return frame;
}

TEST(SimulatedWires, EncoderConforms) {
  const auto sut = hal::CanEncoder::open(sim::SimCanBus::open(name).value(), {.node = 3}).value();
  conformance::check_encoder_in(
      *sut, [&](std::uint32_t place_ticks) { cell->send(encoder_frame(3, place_ticks, clock.now())); });
}

TEST(SimulatedWires, PosesOfAnEncoderConform) {
  Twist per_tick = Twist::Zero();
  per_tick[0] = 0.01;
  hal::EncoderPoseSource sut{hal::CanEncoder::open(sim::SimCanBus::open(name).value(), {.node = 3}).value(),
                             clock,
                             {.per_tick = per_tick}};
  std::uint32_t place_ticks = 0;
  conformance::check_pose_source(sut, [&] { cell->send(encoder_frame(3, place_ticks += 10, clock.now())); });
}

/// Free a moment ago: the suite wants its source not started.
std::uint16_t free_udp_port() {
  const auto source = hal::UdpPoseSource::open({}).value();
  CHECK(source->start().has_value());
  return source->port();
}

TEST_GROUP(SimulatedController){};

TEST(SimulatedController, PosesOverRtdeConform) {
  test::note_ran();
  SE3 T_base_flange = SE3::Identity();
  T_base_flange.translation() = Vec3{400, 100, 300};
  sim::Arm arm{*sim::ArmKinematics::named("UR5e"), T_base_flange};
  const auto controller = sim::UrController::open({.rate_hz = 125}, arm, {}).value();
  hal::RtdePoseSource::Config config;
  config.controller = {.address = "127.0.0.1", .port = controller->ports().rtde};
  config.samples.rate_hz = 125;
  conformance::check_pose_source(*hal::RtdePoseSource::open(config).value(), [] {});
}

TEST(SimulatedController, PosesByEgmConform) {
  test::note_ran();
  const std::uint16_t port = free_udp_port();
  const auto sut = hal::UdpPoseSource::open({.port = port}).value();
  sim::EgmStream controller = sim::EgmStream::open({.port = port}).value();
  conformance::check_pose_source(*sut, [&] { controller.send(hal::monotonic_now(), SE3::Identity(), true); });
}

TEST(SimulatedController, PosesByRsiConform) {
  test::note_ran();
  const std::uint16_t port = free_udp_port();
  const auto sut =
      hal::UdpPoseSource::open({.language = hal::UdpPoseSource::Language::Rsi, .port = port}).value();
  sim::RsiExchange controller = sim::RsiExchange::open({.port = port}).value();
  SensorClock::time_point instant{};
  conformance::check_pose_source(*sut, [&] { controller.step(instant += 4ms, SE3::Identity()); });
}

TEST(SimulatedController, PosesByTheGenericProtocolConform) {
  test::note_ran();
  SE3 T_base_flange = SE3::Identity();
  T_base_flange.translation() = Vec3{400, 100, 300};
  sim::Arm arm{*sim::ArmKinematics::named("UR5e"), T_base_flange};
  const auto controller = sim::PathTaker::open({}, arm).value();
  const auto sut =
      hal::ArmLinkPoseSource::open({.controller = {"127.0.0.1", controller->pose_port()}}).value();
  conformance::check_pose_source(*sut, [] {});
}

TEST_GROUP(Recording){};

TEST(Recording, CameraAndPosesConform) {
  BITELINE_SHARED_DATA_OR_SKIP(folder, "sessions/bare4");
  test::note_ran();
  const auto session = hal::replay::open_recording(folder, std::nullopt).value();
  conformance::check_camera(*hal::replay::ReplayCamera::open(session, {}).value(),
                            {.settings = {.region = session->sensor.region}});
  hal::replay::ReplayPoses poses{session};
  conformance::check_pose_source(poses, [] {});
}

}  // namespace
}  // namespace biteline
