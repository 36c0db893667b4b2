// SPDX-License-Identifier: MIT
/// \file The simulated wires: the sensor's devices on one end, the cell on the other.
#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <atomic>

#include "hal/sim/bus/bus_devices.hpp"
#include "hal/sim/bus/bus_server.hpp"

namespace biteline::sim {

namespace {

constexpr Nanoseconds k_second{1'000'000'000};
constexpr Nanoseconds k_none{0};

int code(const Error& error) {
  return static_cast<int>(error.code);
}

}  // namespace

TEST_GROUP(SimBus) {
  std::string name = "biteline-test-" + std::to_string(getpid());
  std::atomic<std::int64_t> period_ns{-1};
  std::unique_ptr<BusServer> cell;

  void setup() override {
    cell = *BusServer::open(
        name, {.on_line = {},
               .on_trigger = [this](Nanoseconds period, Nanoseconds) { period_ns = period.count(); },
               .on_can = {}});
  }
  void teardown() override {
    cell.reset();
  }

  /// A question that is answered after everything sent before it has been worked.
  void settle() {
    CHECK((*SimSafetyIn::open(name))->read().has_value());
  }
};

TEST(SimBus, AnOutputStartsInactiveFollowsAndFallsBackWhenItsOwnerGoes) {
  auto sut = *SimGpioOut::open(name, Line::LaserEnable);
  CHECK_FALSE(*sut->read_back());
  CHECK(sut->set(true).has_value());
  CHECK(*sut->read_back());
  CHECK(cell->level(Line::LaserEnable));
  const auto watcher = *SimEdgeIn::open(name, Line::LaserEnable);
  sut.reset();
  const auto edge = watcher->next_edge(k_second);
  CHECK(edge.has_value());
  CHECK_FALSE(edge->rising);
  CHECK_FALSE(cell->level(Line::LaserEnable));
}

TEST(SimBus, EdgesComeInOrderWithTheirStampsAndLevels) {
  const auto sut = *SimEdgeIn::open(name, Line::StrobeEcho);
  CHECK_EQUAL(static_cast<int>(Errc::Timeout), code(sut->next_edge(k_none).error()));
  for (int i = 0; i < 10; ++i)
    cell->drive(Line::StrobeEcho, i % 2 == 0, SensorClock::time_point{Nanoseconds{1000 + i}});
  for (std::int64_t i = 0; i < 10; ++i) {
    const auto edge = sut->next_edge(k_second);
    CHECK(edge.has_value());
    CHECK_EQUAL(i % 2 == 0, edge->rising);
    LONGS_EQUAL(1000 + i, edge->stamp.time_since_epoch().count());
    LONGS_EQUAL(i, edge->sequence);
  }
  CHECK_FALSE(*sut->level());
  LONGS_EQUAL(10, sut->health().edges);
  LONGS_EQUAL(0, sut->health().edges_lost);
}

TEST(SimBus, ALineDrivenToItsOwnLevelMakesNoEdge) {
  const auto sut = *SimEdgeIn::open(name, Line::Interlock);
  cell->drive(Line::Interlock, false, {});
  CHECK_EQUAL(static_cast<int>(Errc::Timeout), code(sut->next_edge(Nanoseconds{20'000'000}).error()));
}

TEST(SimBus, SafetyInputsAreWhatDoorAndKeySay) {
  const auto sut = *SimSafetyIn::open(name);
  CHECK_FALSE(sut->read()->interlock_closed);
  cell->drive(Line::Interlock, true, {});
  CHECK(sut->read()->interlock_closed);
  CHECK_FALSE(sut->read()->key_on);
  const auto door = *SimGpioOut::open(name, Line::Interlock);  // a test's hand on the door: open
  CHECK_FALSE(sut->read()->interlock_closed);
}

TEST(SimBus, TheTriggerRunsOnlyBetweenStartAndStopAndEndsWithItsOwner) {
  auto sut = *SimPwmOut::open(name);
  CHECK_EQUAL(static_cast<int>(Errc::WrongState), code(sut->start().error()));
  CHECK_EQUAL(static_cast<int>(Errc::BadValue), code(sut->configure({.period = k_none}).error()));
  CHECK(sut->configure({.period = Nanoseconds{10'000'000}, .pulse = Nanoseconds{100'000}}).has_value());
  settle();
  LONGS_EQUAL(-1, period_ns.load());
  CHECK(sut->start().has_value());
  settle();
  LONGS_EQUAL(10'000'000, period_ns.load());
  sut.reset();
  for (int i = 0; i < 1000 && period_ns != 0; ++i) settle();
  LONGS_EQUAL(0, period_ns.load());
}

TEST(SimBus, FramesPassTheFiltersWithTheirStamps) {
  const auto sut = *SimCanBus::open(name);
  const std::array filters{hal::CanFilter{.id = 0x1A8, .mask = 0x7FF, .extended = false}};
  CHECK(sut->set_filters(filters).has_value());
  settle();
  cell->send({.id = 0x080, .size_bytes = 1, .received = SensorClock::time_point{Nanoseconds{5}}});
  cell->send(
      {.id = 0x1A8, .size_bytes = 48, .data = {7}, .received = SensorClock::time_point{Nanoseconds{6}}});
  const auto frame = sut->receive(k_second);
  CHECK(frame.has_value());
  LONGS_EQUAL(0x1A8, frame->id);
  LONGS_EQUAL(7, frame->data[0]);
  LONGS_EQUAL(6, frame->received.time_since_epoch().count());
  LONGS_EQUAL(1, sut->health().frames_received);
}

TEST(SimBus, ADeadCellIsALostDeviceOnEveryLine) {
  auto output = *SimGpioOut::open(name, Line::LaserEnable);
  auto edges = *SimEdgeIn::open(name, Line::StrobeEcho);
  auto safety = *SimSafetyIn::open(name);
  auto can = *SimCanBus::open(name);
  cell.reset();
  CHECK_EQUAL(static_cast<int>(Errc::DeviceLost), code(output->set(true).error()));
  CHECK_EQUAL(static_cast<int>(Errc::DeviceLost), code(edges->next_edge(k_second).error()));
  CHECK_EQUAL(static_cast<int>(Errc::DeviceLost), code(safety->read().error()));
  CHECK_EQUAL(static_cast<int>(Errc::DeviceLost), code(can->receive(k_second).error()));
  CHECK_EQUAL(static_cast<int>(Errc::DeviceNotFound), code(SimCanBus::open(name).error()));
}

}  // namespace biteline::sim
