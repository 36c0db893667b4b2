// SPDX-License-Identifier: MIT
// SocketCAN on vcan0 (CAN FD), the pose source and the encoder on top of it.
#include <CppUTest/TestHarness.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <cstring>
#include <thread>

#include "hal/linux/socketcan/can_encoder.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/linux/socketcan/socketcan_bus.hpp"
#include "tests/hal/conformance/can_bus.hpp"
#include "tests/hal/conformance/encoder_in.hpp"
#include "tests/hal/conformance/pose_source.hpp"
#include "tests/hal/kernel/skip.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

constexpr const char* k_vcan = "/sys/class/net/vcan0";

std::unique_ptr<SocketcanBus> open_bus() {
  return SocketcanBus::open({.interface = "vcan0"}).value();
}

void set_link(bool up) {
  const Descriptor socket{::socket(AF_INET, SOCK_DGRAM, 0)};
  ifreq request{};
  std::strcpy(request.ifr_name, "vcan0");
  CHECK_EQUAL(0, ::ioctl(socket.number(), SIOCGIFFLAGS, &request));
  request.ifr_flags = static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
  CHECK_EQUAL(0, ::ioctl(socket.number(), SIOCSIFFLAGS, &request));
}

CanFrame frame_of(std::uint32_t id, std::span<const std::uint8_t> data, bool fd = false) {
  CanFrame frame{.id = id, .fd = fd, .size_bytes = static_cast<std::uint8_t>(data.size()), .received = {}};
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

/// What stands for the arm: SYNC, then the pose in classic frames or in one FD frame, turn by turn.
struct Arm {
  std::unique_ptr<SocketcanBus> bus{open_bus()};
  canpose::PoseMessage pose{.sync_counter = 0};

  void send() {
    pose.sync_counter = static_cast<std::uint8_t>(pose.sync_counter % canpose::k_sync_counter_last + 1);
    pose.stamp_us += 8000;
    pose.T_base_flange.translation().x() += 1;
    CHECK(bus->send(frame_of(canpose::k_sync_id, std::array{pose.sync_counter})).has_value());
    if (pose.sync_counter % 2 == 0) {
      CHECK(bus->send(frame_of(canpose::k_default_base_id + canpose::k_fd_id_offset,
                               canpose::encode_fd(pose).value(), true))
                .has_value());
      return;
    }
    const canpose::ClassicFrames frames = canpose::encode_classic(pose).value();
    for (std::uint32_t i = 0; i < frames.size(); ++i) {
      CHECK(bus->send(frame_of(canpose::k_default_base_id + i, frames[i])).has_value());
    }
  }
};

TEST_GROUP(CanKernel) {
  MonotonicClock clock;
};

TEST(CanKernel, BusConforms) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = open_bus();
  const auto peer = open_bus();
  conformance::check_can_bus(*sut, *peer, {.fd = true, .extended = true});
}

TEST(CanKernel, StampIsBetweenSendingAndReading) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = open_bus();
  const auto peer = open_bus();
  for (int i = 0; i < 20; ++i) {
    const SensorClock::time_point before = monotonic_now();
    CHECK(peer->send(conformance::numbered_frame(0x10, 1, false)).has_value());
    std::this_thread::sleep_for(2ms);  // so that the time of reading would be told from the time of arrival
    const Result<CanFrame> frame = sut->receive(1s);
    CHECK(frame.has_value());
    CHECK(frame->received >= before - 100us);  // two clocks read one after the other
    CHECK(frame->received <= monotonic_now() - 2ms + 1ms);
  }
  CHECK_EQUAL(0, sut->health().stamps_estimated);
}

TEST(CanKernel, SteppedWallClockIsNoticed) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = open_bus();
  const auto peer = open_bus();
  CHECK(peer->send(conformance::numbered_frame(0x10, 1, false)).has_value());
  CHECK_FALSE(sut->receive(1s)->stamp_estimated);
  // An hour is more than any frame waits; a fifth of a second looks like a frame that waited so long.
  for (const std::int64_t step_us : {3'600'000'000LL, -3'600'000'000LL, 200'000LL, -200'000LL}) {
    const std::uint64_t estimated = sut->health().stamps_estimated;
    CHECK(peer->send(conformance::numbered_frame(0x10, 1, false)).has_value());
    timeval wall{};
    ::gettimeofday(&wall, nullptr);
    const std::int64_t set_us = wall.tv_sec * 1'000'000LL + wall.tv_usec + step_us;
    wall = {.tv_sec = set_us / 1'000'000, .tv_usec = set_us % 1'000'000};
    CHECK_EQUAL(0, ::settimeofday(&wall, nullptr));
    const Result<CanFrame> frame = sut->receive(1s);
    CHECK(frame.has_value());
    CHECK(frame->stamp_estimated);
    CHECK_EQUAL(estimated + 1, sut->health().stamps_estimated);
    CHECK(std::chrono::abs(monotonic_now() - frame->received) < 1s);
    // From then on the clock is as good as before.
    CHECK(peer->send(conformance::numbered_frame(0x10, 2, false)).has_value());
    CHECK_FALSE(sut->receive(1s)->stamp_estimated);
  }
}

TEST(CanKernel, FramesBeyondTheQueueAreCountedAsDropped) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = SocketcanBus::open({.interface = "vcan0", .receive_buffer_bytes = 4096}).value();
  const auto peer = open_bus();
  constexpr int k_sent = 500;
  for (int i = 0; i < k_sent; ++i) CHECK(peer->send(conformance::numbered_frame(0x10, 8, false)).has_value());
  int received = 0;
  while (sut->receive(10ms)) ++received;
  CHECK(received < k_sent);
  // The kernel tells the count with the next frame that gets through.
  CHECK(peer->send(conformance::numbered_frame(0x10, 8, false)).has_value());
  CHECK(sut->receive(1s).has_value());
  CHECK_EQUAL(k_sent - received, sut->health().frames_dropped);
}

TEST(CanKernel, LinkThatGoesDownAndUpIsAStateAndNoEnd) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = open_bus();
  set_link(false);
  CHECK(sut->receive(10ms).error().code == Errc::Timeout);
  CHECK(sut->health().state == CanState::Down);
  set_link(true);
  const auto peer = open_bus();
  CHECK(peer->send(conformance::numbered_frame(0x10, 1, false)).has_value());
  CHECK(sut->receive(1s).has_value());
  CHECK(sut->health().state == CanState::ErrorActive);
}

TEST(CanKernel, BusOffAndBackIsAStateAndCounted) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto sut = open_bus();
  // vcan has no errors of its own: the frames with which a real driver reports them, put on it by hand.
  const Descriptor driver{::socket(PF_CAN, SOCK_RAW, CAN_RAW)};
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex("vcan0"));
  CHECK_EQUAL(0, ::bind(driver.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address));
  const auto report = [&](std::uint32_t error_class, std::uint8_t controller_state = 0) {
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | error_class;
    frame.can_dlc = CAN_ERR_DLC;
    frame.data[1] = controller_state;
    CHECK_EQUAL(static_cast<ssize_t>(sizeof frame), ::write(driver.number(), &frame, sizeof frame));
    CHECK(sut->receive(10ms).error().code == Errc::Timeout);
  };
  report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING);
  CHECK(sut->health().state == CanState::ErrorWarning);
  report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
  CHECK(sut->health().state == CanState::ErrorPassive);
  report(CAN_ERR_PROT | CAN_ERR_BUSERROR);
  CHECK_EQUAL(1, sut->health().bus_errors);
  report(CAN_ERR_BUSOFF);
  CHECK(sut->health().state == CanState::BusOff);
  report(CAN_ERR_RESTARTED);
  CHECK(sut->health().state == CanState::ErrorActive);
  CHECK_EQUAL(1, sut->health().restarts);
  const auto peer = open_bus();
  CHECK(peer->send(conformance::numbered_frame(0x10, 1, false)).has_value());
  CHECK(sut->receive(1s).has_value());
}

TEST(CanKernel, MissingInterfaceIsSaid) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  CHECK(SocketcanBus::open({.interface = "can77"}).error().code == Errc::DeviceNotFound);
}

TEST(CanKernel, PoseSourceConforms) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  Arm arm;
  CanPoseSource sut{open_bus(), clock, {}};
  conformance::check_pose_source(sut, [&] { arm.send(); });
  CHECK_EQUAL(0, sut.health().poses_lost + sut.health().poses_rejected);
}

TEST(CanKernel, PoseIsLatchedAtItsSync) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  Arm arm;
  CanPoseSource sut{open_bus(), clock, {}};
  CHECK(sut.start().has_value());
  const SensorClock::time_point before = monotonic_now();
  arm.send();
  const Result<RobotPose> pose = sut.next_pose(1s);
  CHECK(pose.has_value());
  CHECK(pose->stamp_sensor.has_value());
  CHECK(*pose->stamp_sensor >= before - 100us);
  CHECK(*pose->stamp_sensor <= pose->received);
}

TEST(CanKernel, EncoderConforms) {
  BITELINE_DEVICE_OR_SKIP(k_vcan);
  const auto peer = open_bus();
  const auto sut = CanEncoder::open(open_bus(), {.node = 3, .range_ticks = 0}).value();
  conformance::check_encoder_in(*sut, [&](std::uint32_t place_ticks) {
    const auto byte = [&](unsigned index) { return static_cast<std::uint8_t>(place_ticks >> (8 * index)); };
    const std::array<std::uint8_t, 4> position{byte(0), byte(1), byte(2), byte(3)};
    CHECK(peer->send(frame_of(canpose::tpdo1_id(3), position)).has_value());
  });
}

}  // namespace
}  // namespace biteline::hal
