// SPDX-License-Identifier: MIT
#pragma once
/// \file What every GpioOut and every EdgeIn must do.

#include <CppUTest/TestHarness.h>

#include <functional>

#include "hal/api/edge_in.hpp"
#include "hal/api/gpio_out.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

/// `level_outside` reads the wire without the object; `sut` is given up on the way.
inline void check_gpio_out(std::unique_ptr<hal::GpioOut> sut, const std::function<bool()>& level_outside) {
  CHECK_FALSE(level_outside());  // starts inactive
  for (const bool active : {true, true, false, false, true}) {
    CHECK(sut->set(active).has_value());
    CHECK_EQUAL(active, sut->read_back().value());
    CHECK_EQUAL(active, level_outside());
  }
  sut.reset();
  CHECK_FALSE(level_outside());  // and ends so
}

/// `drive` sets the wire from outside; it is low at first.
inline void check_edge_in(hal::EdgeIn& sut, const std::function<void(bool)>& drive) {
  CHECK(sut.next_edge(0ns).error().code == Errc::Timeout);
  CHECK_FALSE(sut.level().value());
  constexpr int k_edges = 50;
  std::optional<hal::Edge> last;
  for (int i = 0; i < k_edges; ++i) {
    const bool rising = i % 2 == 0;
    drive(rising);
    const Result<hal::Edge> edge = sut.next_edge(2s);
    CHECK(edge.has_value());
    CHECK_EQUAL(rising, edge->rising);
    CHECK_EQUAL(rising, sut.level().value());
    if (last) {
      CHECK(edge->stamp > last->stamp);
      CHECK_EQUAL(last->sequence + 1, edge->sequence);
    }
    last = *edge;
  }
  CHECK_EQUAL(k_edges, sut.health().edges);
  CHECK_EQUAL(0, sut.health().edges_lost);
  CHECK(sut.next_edge(1ms).error().code == Errc::Timeout);
}

}  // namespace biteline::conformance
