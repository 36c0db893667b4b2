// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/can_encoder.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/unit/hal/linux/fake_can_bus.hpp"

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

TEST_GROUP(CanEncoder) {
  VirtualClock clock{SensorClock::time_point{1s}};
  FakeCanBus* bus = new FakeCanBus{clock};
  std::unique_ptr<CanEncoder> sut{
      CanEncoder::open(std::unique_ptr<CanBus>{bus}, {.node = 5, .range_ticks = 0}).value()};

  void send(std::uint8_t node, std::uint8_t low_byte) {
    bus->put(canpose::tpdo1_id(node), std::array<std::uint8_t, 4>{low_byte, 0, 0, 0});
  }
};

TEST(CanEncoder, GivesTheNewestPositionSinceTheFirst) {
  CHECK(sut->read().error().code == Errc::Timeout);
  send(5, 10);
  send(5, 14);
  clock.advance(2ms);
  send(5, 30);
  const Result<EncoderReading> reading = sut->read();
  CHECK(reading.has_value());
  CHECK_EQUAL(20, reading->position_ticks);
  CHECK(reading->stamp == clock.now());
}

TEST(CanEncoder, SilenceKeepsTheLastStampSoThatItsAgeShows) {
  send(5, 10);
  const SensorClock::time_point sent = clock.now();
  CHECK(sut->read().has_value());
  clock.advance(50ms);
  CHECK(sut->read()->stamp == sent);
}

TEST(CanEncoder, OtherNodesAreNotListenedTo) {
  send(6, 10);
  CHECK_FALSE(sut->read().has_value());
}

TEST(CanEncoder, ShortObjectsAreCounted) {
  send(5, 10);
  bus->put(canpose::tpdo1_id(5), std::array<std::uint8_t, 2>{1, 2});
  CHECK_EQUAL(1, sut->read()->errors);
}

TEST(CanEncoder, NodeOutOfRangeIsRefused) {
  CHECK_FALSE(CanEncoder::open(std::make_unique<FakeCanBus>(clock), {.node = 128}).has_value());
}

}  // namespace
}  // namespace biteline::hal
