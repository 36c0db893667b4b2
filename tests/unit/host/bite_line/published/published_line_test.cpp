// SPDX-License-Identifier: MIT
#include "host/bite_line/published/published_line.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/made_cloud.hpp"

namespace biteline::published {

TEST_GROUP(PublishedLine){};

TEST(PublishedLine, APlainGrooveIsFoundAndItsStagesAreKept) {
  const test::MadeCloud made = test::made_cloud(sim::ShoeClass::Deep, 46, test::somewhere());
  std::optional<Workings> workings;
  const bite_line::Extraction sut = find_bite_line(made.cloud.points, {}, &workings);
  CHECK_TEXT(sut.found, sut.reason().c_str());
  CHECK(test::mean_error_mm(sut.line, made.truth) < 0.8);
  CHECK(workings.has_value());
  const bite_line::LineStages stages = line_stages(*workings);
  LONGS_EQUAL(stages.surface.size(), stages.curvature_per_mm.size());
  LONGS_EQUAL(stages.surface.size(), stages.surface.normals.size());
  CHECK(stages.denoised_points.size() <= stages.feature_points.size());
  CHECK(!stages.coarse_line.empty());
  CHECK(!stages.thinned_line.empty());
  LONGS_EQUAL(stages.unrolled.cols, stages.unrolled.path_row.size());
  LONGS_EQUAL(8, stages.unrolled.marks.size());
  for (std::size_t i = 1; i < 8; ++i) CHECK(stages.unrolled.marks[i].col > stages.unrolled.marks[i - 1].col);
}

TEST(PublishedLine, ABareUpperIsRefused) {
  const test::MadeCloud made = test::made_cloud(sim::ShoeClass::Bare, 43, test::somewhere());
  const bite_line::Extraction sut = find_bite_line(made.cloud.points, {});
  CHECK_FALSE(sut.found);
  CHECK(sut.refusal.has_value());
  CHECK(sut.line.points.empty());
}

}  // namespace biteline::published
