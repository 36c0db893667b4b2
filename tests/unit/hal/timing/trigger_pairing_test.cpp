// SPDX-License-Identifier: MIT
#include "hal/timing/trigger_pairing.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

namespace biteline::hal {
namespace {

using namespace std::chrono_literals;

SensorClock::time_point at(Nanoseconds since_start) {
  return SensorClock::time_point{5s} + since_start;
}

TEST_GROUP(TriggerPairing) {
  TriggerPairing sut{{.latency_min = 3ms, .latency_max = 7ms}};
};

TEST(TriggerPairing, EveryFrameFindsItsOwnEdgeThroughRandomLosses) {
  std::mt19937 random{5};
  std::uint64_t edges_lost = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t both_lost = 0;
  for (int i = 0; i < 5000; ++i) {
    const Nanoseconds latency = 3ms + Nanoseconds{random() % 4'000'001};
    const bool edge_comes = random() % 10 != 0;
    const bool frame_comes = i == 4999 || random() % 10 != 0;
    edges_lost += !edge_comes && frame_comes;
    frames_lost += edge_comes && !frame_comes;
    both_lost += !edge_comes && !frame_comes;
    if (edge_comes) sut.on_edge(at(i * 10ms));
    if (!frame_comes) continue;
    const TriggerPairing::Match match = sut.on_frame(at(i * 10ms + latency));
    CHECK_EQUAL(edge_comes, match.edge.has_value());
    if (match.edge) CHECK(*match.edge == at(i * 10ms));
  }
  CHECK_EQUAL(edges_lost, sut.health().frames_without_edge);
  CHECK_EQUAL(frames_lost, sut.health().edges_without_frame);
  CHECK_EQUAL(5000 - edges_lost - frames_lost - both_lost, sut.health().paired);
}

TEST(TriggerPairing, TwoEdgesInTheWindowAreNoAnswer) {
  sut.on_edge(at(0ms));
  sut.on_edge(at(2ms));
  const TriggerPairing::Match match = sut.on_frame(at(6ms));
  CHECK(match.ambiguous);
  CHECK_FALSE(match.edge.has_value());
  CHECK_EQUAL(1, sut.health().frames_with_two_edges);
}

TEST(TriggerPairing, EdgeOfTheNextFrameIsKept) {
  sut.on_edge(at(0ms));
  sut.on_edge(at(10ms));
  CHECK(*sut.on_frame(at(5ms)).edge == at(0ms));
  CHECK(*sut.on_frame(at(15ms)).edge == at(10ms));
}

TEST(TriggerPairing, EdgesWithoutEndAreGivenUpAndCounted) {
  for (int i = 0; i < 1000; ++i) sut.on_edge(at(i * 10ms));
  CHECK_EQUAL(1000 - 256, sut.health().edges_overrun);
  CHECK(*sut.on_frame(at(999 * 10ms + 5ms)).edge == at(999 * 10ms));
}

}  // namespace
}  // namespace biteline::hal
