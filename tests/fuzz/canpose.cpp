// SPDX-License-Identifier: MIT
// Frames of a CAN bus in any order, some with a check sum that fits: each pose that comes out is one.
#include "common/canpose/assembler.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  canpose::Assembler sut;
  std::int64_t now_ns = 0;
  while (!bytes.empty()) {
    const auto head = bytes.take<std::uint8_t>();
    const std::uint32_t id = canpose::k_default_base_id + (head & 0x0FU);
    std::vector<std::uint8_t> frame = bytes.take_bytes(bytes.take<std::uint8_t>() % 65U);
    if ((head & 0x80U) != 0 && frame.size() >= 4) {
      const std::uint16_t sum = canpose::crc16({frame.data(), frame.size() - 2});
      std::memcpy(frame.data() + frame.size() - 2, &sum, sizeof sum);
    }
    now_ns += 1'000'000;
    const auto pose = sut.feed(id, frame, SensorClock::time_point{Nanoseconds{now_ns}});
    if (pose) fuzz::demand(pose->message.T_base_flange.matrix().allFinite(), "a pose is finite");
  }
  return 0;
}
