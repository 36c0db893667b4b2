// SPDX-License-Identifier: MIT
#pragma once
/// \file What every CanBus must do, shown on two of them at one wire.

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include "hal/api/can_bus.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

inline hal::CanFrame numbered_frame(std::uint32_t id, std::uint8_t size_bytes, bool fd) {
  hal::CanFrame frame{.id = id,
                      .extended = id > 0x7FF,
                      .fd = fd,
                      .bit_rate_switch = fd,
                      .size_bytes = size_bytes,
                      .received = {}};
  for (std::uint8_t i = 0; i < size_bytes; ++i) frame.data[i] = static_cast<std::uint8_t>(id + i);
  return frame;
}

struct CanAbilities {
  bool fd{true};
  bool extended{true};
};

inline void check_can_bus(hal::CanBus& sut, hal::CanBus& peer, const CanAbilities& abilities) {
  CHECK(sut.receive(0ns).error().code == Errc::Timeout);

  std::vector<hal::CanFrame> frames{numbered_frame(0x123, 8, false), numbered_frame(0x001, 0, false)};
  if (abilities.extended) frames.push_back(numbered_frame(0x1ABCDEF0, 3, false));
  if (abilities.fd) frames.push_back(numbered_frame(0x2AA, 48, true));
  SensorClock::time_point last_stamp;
  for (const hal::CanFrame& frame : frames) {
    CHECK(peer.send(frame).has_value());
    const Result<hal::CanFrame> got = sut.receive(2s);
    CHECK(got.has_value());
    CHECK_EQUAL(frame.id, got->id);
    CHECK_EQUAL(frame.extended, got->extended);
    CHECK_EQUAL(frame.fd, got->fd);
    CHECK_EQUAL(frame.size_bytes, got->size_bytes);
    CHECK(std::equal(frame.data.begin(), frame.data.begin() + frame.size_bytes, got->data.begin()));
    CHECK(got->received >= last_stamp);
    last_stamp = got->received;
  }
  CHECK_EQUAL(frames.size(), sut.health().frames_received);
  CHECK_EQUAL(frames.size(), peer.health().frames_sent);

  CHECK(peer.send(numbered_frame(0x100, 9, false)).error().code == Errc::BadValue);

  const std::array filters{hal::CanFilter{.id = 0x1A0, .mask = 0x7FC}};
  CHECK(sut.set_filters(filters).has_value());
  for (std::uint32_t id = 0x19F; id <= 0x1A4; ++id)
    CHECK(peer.send(numbered_frame(id, 1, false)).has_value());
  for (std::uint32_t id = 0x1A0; id <= 0x1A3; ++id) CHECK_EQUAL(id, sut.receive(2s).value().id);
  CHECK(sut.receive(1ms).error().code == Errc::Timeout);
  CHECK(sut.set_filters({}).has_value());
  CHECK(peer.send(numbered_frame(0x7FF, 1, false)).has_value());
  CHECK_EQUAL(0x7FF, sut.receive(2s).value().id);
  CHECK(sut.health().state == hal::CanState::ErrorActive);
}

}  // namespace biteline::conformance
