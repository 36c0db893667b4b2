// SPDX-License-Identifier: MIT
// The peaks are compiled once per instruction set and chosen at run time: a test machine shows its best one
// only.
#include <CppUTest/TestHarness.h>
#include <hwy/targets.h>

#include <memory>

#include "common/stripe/peak_extractor.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::stripe {

namespace {

/// Only this set is chosen, for as long as it lives.
struct OneSet {
  explicit OneSet(std::int64_t target) { choose(target); }
  OneSet(const OneSet&) = delete;
  OneSet& operator=(const OneSet&) = delete;
  ~OneSet() { choose(0); }

 private:
  static void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().DeInit();
  }
};

}  // namespace

TEST_GROUP(InstructionSets){};

TEST(InstructionSets, EachOneFindsTheSamePeaks) {
  test::MadeStripe made;
  made.width_px = 301;  // no set's vectors divide it
  made.noise.speckle_contrast = 0.1F;
  made.row_px = [](int u) { return 40.0 + 0.11 * u + (u > 150 ? 9.0 : 0.0); };
  std::mt19937_64 random{8};
  const std::vector<std::uint8_t> pixels = test::picture(made, random);
  const auto expected = std::make_unique<Peaks>(), found = std::make_unique<Peaks>();
  const auto extract = [&](Peaks& peaks) {
    auto sut = PeakExtractor::create({.noise = made.noise}, made.width_px, made.height_px);
    CHECK(sut.has_value());
    sut->rt_extract({.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(made.width_px)},
                    peaks);
  };
  extract(*expected);
  int sets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const OneSet chosen(target);
    extract(*found);
    ++sets;
    for (std::size_t u = 0; u < static_cast<std::size_t>(made.width_px); ++u) {
      const ColumnPeaks &want = expected->columns[u], &got = found->columns[u];
      LONGS_EQUAL(1, want.kept_count);
      LONGS_EQUAL(1, got.kept_count);
      // A column that has settled (to 0.28 standard deviations, k_settled_ratio) gets a round more where a
      // neighbour in its vector needs one.
      CHECK_TEXT(
          std::fabs(want.kept[0].row_px - got.kept[0].row_px) < 0.3F * want.kept[0].sigma_row_px,
          StringFromFormat("%s, column %zu: %g against %g", hwy::TargetName(target), u,
                           static_cast<double>(got.kept[0].row_px), static_cast<double>(want.kept[0].row_px))
              .asCharString());
      LONGS_EQUAL(want.kept[0].flags, got.kept[0].flags);
      DOUBLES_EQUAL(static_cast<double>(want.kept[0].skew), static_cast<double>(got.kept[0].skew), 0.01);
    }
  }
  CHECK(sets >= 1);
}

}  // namespace biteline::stripe
