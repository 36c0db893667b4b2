// SPDX-License-Identifier: MIT
// Meshes of real and drawn shoes, sampled as a scanner would see them.
#include <CppUTest/TestHarness.h>

#include <string>

#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/known_shoe.hpp"
#include "tests/support/shape_truth.hpp"

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

TEST(Shoes, DesignedSolesHaveTheirLineAndWhatIsNoShoeHasNone) {
  // The labels' boundary is good to 0.5 mm, 1 mm where the edge is round; a line is wrong where more than 5
  // mm of it are off by more than 1 mm beyond that and do not say so.
  constexpr double k_mean_mm = 0.5;
  constexpr double k_wrong_mm = 5.0;
  for (const test::Shape& shape : test::k_shapes) {
    if (shape.truth == test::Shape::Truth::Unknown) continue;
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth) continue;
    const bite_line::Extraction sut = bite_line::find_bite_line(*cloud, {});
    if (truth->has_none) {
      CHECK_TEXT(!sut.found && sut.refusal, shape.name);
      CHECK_TEXT(sut.confidence < 0.5, shape.name);
      continue;
    }
    CHECK_TEXT(sut.found,
               (std::string{shape.name} + ": " + (sut.refusal ? sut.refusal->reason : "")).c_str());
    const test::LineOnShape on = test::line_on_shape(sut.line, truth->line);
    CHECK_COMPARE_TEXT(on.mean_mm, <=, k_mean_mm, shape.name);
    CHECK_COMPARE_TEXT(on.wrong_mm, <=, k_wrong_mm, shape.name);
    CHECK_COMPARE_TEXT(on.flagged, <=, 0.1, shape.name);
  }
}

}  // namespace biteline
