// SPDX-License-Identifier: MIT
#include "tests/hal/kernel/world.hpp"

#include <algorithm>
#include <array>

#include "common/canpose/pose_frames.hpp"
#include "hal/linux/socketcan/socketcan_bus.hpp"

namespace biteline::test {

using namespace std::chrono_literals;

namespace {

/// Until `stop`: SYNC and one FD frame every 8 ms with what `T_base_flange_at` tells.
template <class PoseAt>
void broadcast(const std::atomic<bool>& stop, SensorClock::time_point start, PoseAt T_base_flange_at) {
  const auto bus = hal::SocketcanBus::open({.interface = "vcan0"}).value();
  const auto ear = hal::SocketcanBus::open({.interface = "vcan0"}).value();
  if (!ear->set_filters(
          std::array{hal::CanFilter{.id = canpose::k_sync_id, .mask = 0x7FF, .extended = false}}))
    return;
  canpose::PoseMessage pose{.sync_counter = 0};
  while (!stop) {
    pose.sync_counter = static_cast<std::uint8_t>(pose.sync_counter % canpose::k_sync_counter_last + 1);
    hal::CanFrame frame{
        .id = canpose::k_sync_id, .size_bytes = 1, .data = {pose.sync_counter}, .received = {}};
    static_cast<void>(bus->send(frame));
    // Where it is when the SYNC stands on the bus, as every node there hears it: nothing of this thread's own
    // delays.
    Result<hal::CanFrame> heard = ear->receive(1s);
    while (heard && heard->data[0] != pose.sync_counter) heard = ear->receive(1s);
    if (!heard) continue;
    pose.stamp_us = static_cast<std::uint64_t>((heard->received - start).count() / 1000);
    pose.T_base_flange = T_base_flange_at(heard->received);
    const canpose::FdFrame coded = canpose::encode_fd(pose).value();
    frame = {.id = canpose::k_default_base_id + canpose::k_fd_id_offset,
             .fd = true,
             .size_bytes = canpose::k_fd_size_bytes,
             .received = {}};
    std::copy(coded.begin(), coded.end(), frame.data.begin());
    static_cast<void>(bus->send(frame));
    std::this_thread::sleep_for(8ms);
  }
}

}  // namespace

void MovingArm::run() {
  broadcast(stop_, start_, [this](SensorClock::time_point instant) {
    SE3 T = SE3::Identity();
    T.translation().x() = x_mm(instant);
    return T;
  });
}

void RestingArm::run() {
  broadcast(stop_, hal::monotonic_now(), [this](SensorClock::time_point) {
    const std::lock_guard lock{mutex_};
    return T_base_flange_;
  });
}

void TriggerWire::on_frame() {
  const Result<std::int64_t> enabled = hal::read_integer("/sys/class/pwm/pwmchip0/pwm0/enable");
  if (!enabled || *enabled != 1) return;
  ++pulses_;
  gpio_.pull(GpioSim::k_strobe_echo, true);
  std::this_thread::sleep_for(1ms);  // the exposure: edges nearer than the kernel's interrupt thread merge
  gpio_.pull(GpioSim::k_strobe_echo, false);
}

}  // namespace biteline::test
