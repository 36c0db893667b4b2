// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "tests/support/shared_data.hpp"

namespace biteline {

TEST_GROUP(MujocoPeer){};

TEST(MujocoPeer, IsMissing) {
  test::note_skipped("MuJoCo is not installed (libmujoco-dev)");
}

}  // namespace biteline
