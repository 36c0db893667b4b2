// SPDX-License-Identifier: MIT
// Meshes of real and drawn shoes, sampled as a scanner would see them.
#include <CppUTest/TestHarness.h>

#include "tests/support/known_shoe.hpp"

namespace biteline {

TEST_GROUP(Shoes){};

TEST(Shoes, EachHasItsLineOrARefusal) {
  for (const test::KnownShoe& shoe : test::k_known_shoes) {
    const auto scan = test::scan_of(shoe);
    if (!scan) continue;
    const test::ShoeVerdict sut = test::judge(shoe, bite_line::find_bite_line(*scan, {}));
    CHECK_TEXT(sut.right, (std::string{shoe.name} + ": " + sut.why).c_str());
  }
}

}  // namespace biteline
