// SPDX-License-Identifier: MIT
#pragma once
/// \file A checked path for runs in real time: round an oval of half a shoe's length.

#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot::test {

/// Ground as a shoe is, in about half of its time.  Planned once per executable.
inline const path::CheckedPath& short_path() {
  static const path::PlanOutcome k_outcome = [] {
    path::PlanRequest request = plan_request("grind.yaml");
    request.line = path::test::made_line({.half_length_mm = 60, .half_width_mm = 40});
    return path::plan(request);
  }();
  return *k_outcome.path;
}

}  // namespace biteline::robot::test
