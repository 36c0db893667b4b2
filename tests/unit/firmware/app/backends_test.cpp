// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <set>

#include "tests/support/errors.hpp"

namespace biteline::sensor {
namespace {

bool is_built(std::string_view name) {
  return std::ranges::any_of(built_backends(), [&](const Backend* backend) { return backend->name == name; });
}

}  // namespace

TEST_GROUP(Backends){};

TEST(Backends, EveryOneHasANameOfItsOwnAndSomethingToOpen) {
  std::set<std::string_view> names;
  for (const Backend* backend : built_backends()) {
    CHECK(names.insert(backend->name).second);
    CHECK(backend->camera != nullptr || backend->output != nullptr || backend->timer != nullptr ||
          backend->can_bus != nullptr || backend->poses != nullptr);
  }
  CHECK(is_built("rtde") && is_built("pwm"));
}

/// On a unit the simulated wires are refused by name; where the cell was built, the cell itself is missed.
TEST(Backends, SimulatedWiresAreOpenedOnlyWhereTheCellWasBuilt) {
  const hal::GpioLineAddress line{.chip = "sim:nobody-has-this-name", .line = "laser-enable"};
  const auto opened = open_output(line);
  CHECK(!opened.has_value());
  CHECK(is_built("sim") == (opened.error().code != Errc::NotSupported));
  if (!is_built("sim")) FAILS_NAMING(Errc::NotSupported, "built without sim", open_output(line));
}

TEST(Backends, UnknownSimulatedLineIsToldWithThoseThatExist) {
  if (!is_built("sim")) return;
  FAILS_NAMING(Errc::DeviceNotFound, "laser-enable, strobe-echo",
               open_edges({.chip = "sim:cell", .line = "laser"}));
}

TEST(Backends, WhatWasNotBuiltIsRefusedByName) {
  hal::Board board;
  board.camera.kind = hal::BoardCamera::Kind::V4l2;
  board.camera.device = "/dev/there-is-no-such-camera";
  const auto camera = open_camera(board, false);
  CHECK(!camera.has_value());
  CHECK(is_built("v4l2") == (camera.error().code != Errc::NotSupported));
}

}  // namespace biteline::sensor
