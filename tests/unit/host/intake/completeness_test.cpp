// SPDX-License-Identifier: MIT
#include "host/intake/completeness.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::intake {

TEST_GROUP(Completeness) {
  // A whole live scan of 409 edges; each test spoils it.
  wire::EndOfScan end;
  wire::SensorHello hello;
  IngestCounts counts;
  std::uint64_t messages_lost{0};
  LightAccount light;

  void setup() override {
    end.counters.frames = end.counters.profiles = counts.profiles = 405;
    end.devices.trigger = wire::TriggerState{.edges = 409, .frames_paired = 405};
    say(wire::LaserState::Off, "nobody asks for it");
    say(wire::LaserState::On);
  }
  void say(wire::LaserState laser, const char* reason = "") {
    light.add({.counters = {}, .stages = {}, .laser = laser, .laser_reason = reason, .devices = {}});
  }
  std::string said() const {
    return contradiction(end, hello, counts, messages_lost, light).value_or("");
  }
};

TEST(Completeness, WholeScanHasNoContradiction) {
  say(wire::LaserState::Off, "nobody asks for it");
  STRCMP_EQUAL("", said().c_str());
}

TEST(Completeness, LightThatFailedIsNoCompleteScanThoughTheSensorSaysSo) {
  say(wire::LaserState::Fault, "the safety thread hung");
  say(wire::LaserState::Off);
  STRCMP_CONTAINS("the safety thread hung", said().c_str());
}

TEST(Completeness, FaultOfTheScanBeforeIsNotThisOnes) {
  light = {};
  say(wire::LaserState::Fault, "the interlock is open");
  say(wire::LaserState::On);
  STRCMP_EQUAL("", said().c_str());
}

TEST(Completeness, SensorThatStoodStillForSecondsIsFoundByItsEdges) {
  end.counters.frames = end.counters.profiles = counts.profiles = 154;
  end.devices.trigger = wire::TriggerState{.edges = 561, .frames_paired = 154, .edges_without_frame = 152};
  STRCMP_CONTAINS("255", said().c_str());
}

TEST(Completeness, CountedLossesAreNoContradiction) {
  end.devices.trigger = wire::TriggerState{.edges = 409, .frames_paired = 300, .edges_without_frame = 105};
  end.counters.frames_lost = 105;
  counts.profiles = 290;
  messages_lost = 7;
  end.counters.profiles_dropped = 108;
  STRCMP_EQUAL("", said().c_str());
}

TEST(Completeness, DoubledEdgesAreAccountedFor) {
  end.devices.trigger = wire::TriggerState{.edges = 429, .frames_paired = 385, .frames_with_two_edges = 20};
  STRCMP_EQUAL("", said().c_str());
}

TEST(Completeness, ProfileThatNobodyKnowsOfIsMissed) {
  counts.profiles = 404;
  STRCMP_CONTAINS("1 of 405 profiles", said().c_str());
}

TEST(Completeness, RecordingThatStopsEarlyIsNotComplete) {
  hello.frames_expected = 409;
  STRCMP_CONTAINS("405 of 409 frames", said().c_str());
  end.counters.frames_lost = 4;
  STRCMP_EQUAL("", said().c_str());
}

TEST(Completeness, FewEdgesMayBeUnderWayAndInAShortScanFewer) {
  end.devices.trigger->edges = 405 + 22;
  STRCMP_EQUAL("", said().c_str());
  end.devices.trigger->edges = 405 + 60;
  STRCMP_CONTAINS("neither a frame", said().c_str());
}

}  // namespace biteline::intake
