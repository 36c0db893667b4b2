// SPDX-License-Identifier: MIT
#include "common/stripe/peak_extractor.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>

#include "common/stripe/peak_extractor_state.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::stripe {

using test::MadeStripe;

TEST_GROUP(PeakExtractor) {
  std::mt19937_64 random{5};
  std::unique_ptr<Peaks> peaks = std::make_unique<Peaks>();

  const Peaks& extract(const std::vector<std::uint8_t>& pixels, int width_px, int height_px,
                       const PeakConfig& config = {}) {
    auto sut = PeakExtractor::create(config, width_px, height_px);
    CHECK(sut.has_value());
    sut->rt_extract({.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(width_px)}, *peaks);
    return *peaks;
  }

  /// RMS error and variance of the normalised errors over pictures with every sub-pixel phase.
  struct Accuracy {
    double rms_px{0}, normalised_variance{0};
    int columns{0};
  };
  Accuracy accuracy(MadeStripe made, const PeakConfig& config, int pictures) {
    Accuracy out;
    for (int i = 0; i < pictures; ++i) {
      made.row_px = [&](int u) { return 40.0 + 10 * i % 40 + 0.0371 * u; };
      extract(test::picture(made, random), made.width_px, made.height_px, config);
      for (int u = 0; u < made.width_px; ++u) {
        const ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
        LONGS_EQUAL(1, column.kept_count);
        const double error = column.kept[0].row_px - made.row_px(u);
        out.rms_px += error * error;
        out.normalised_variance += std::pow(error / column.kept[0].sigma_row_px, 2);
        ++out.columns;
      }
    }
    out.rms_px = std::sqrt(out.rms_px / out.columns);
    out.normalised_variance /= out.columns;
    return out;
  }
};

TEST(PeakExtractor, ReachesTheCramerRaoBoundAndSaysHowSureItIs) {
  for (const double amplitude : {20.0, 60.0, 120.0, 250.0}) {
    MadeStripe made;
    made.amplitude = amplitude;
    const PeakConfig config{.threshold_grey = 8, .noise = made.noise};
    const Accuracy result = accuracy(made, config, 20);
    CHECK_TEXT(result.rms_px < 1.15 * test::cramer_rao_px(made, 60.3),
               StringFromFormat("amplitude %g: rms %g px, bound %g px", amplitude, result.rms_px,
                                test::cramer_rao_px(made, 60.3))
                   .asCharString());
    CHECK_TEXT(result.normalised_variance > 0.8 && result.normalised_variance < 1.25,
               StringFromFormat("amplitude %g: normalised variance %g", amplitude, result.normalised_variance)
                   .asCharString());
  }
}

TEST(PeakExtractor, SaturatedTopCarriesNoWeight) {
  // 30 % of the full width at half maximum at full scale: |x| < 0.3 * 1.1774 sigma, amplitude 255 exp(0.353^2
  // / 2).
  MadeStripe made;
  made.amplitude = 255 * std::exp(0.5 * 0.353 * 0.353);
  made.sigma_px = 3.0;
  const Accuracy result = accuracy(made, {.noise = made.noise}, 20);
  CHECK(result.rms_px < 1.3 * test::cramer_rao_px(made, 60.3));
  CHECK(peaks->columns[100].kept[0].flags & k_peak_saturated);
}

TEST(PeakExtractor, WideSaturatedStripeIsWhereItSaysOrSaysThatItIsDoubtful) {
  // Close and bright: a flat top of some 6 to 30 rows, flanks of different steepness, at every phase of the
  // blocks.
  constexpr int k_width_px = 64, k_height_px = 128;
  int wide = 0;
  for (const double top_px : {6.0, 10.0, 14.0, 18.0, 24.0, 30.0}) {
    for (const double above_px : {0.6, 1.5, 3.0, 6.0}) {
      for (const double below_px : {0.6, 1.5, 3.0, 6.0}) {
        std::vector<std::uint8_t> pixels(k_width_px * k_height_px);
        const auto middle = [](int u) { return 50 + 0.171 * u; };
        for (int u = 0; u < k_width_px; ++u) {
          for (int v = 0; v < k_height_px; ++v) {
            const double d = v - middle(u);
            const double beyond = std::max(0.0, std::abs(d) - top_px / 2);
            const double sigma = d < 0 ? above_px : below_px;
            const double grey = 5 + 270 * std::exp(-std::min(20.0, 0.5 * beyond * beyond / (sigma * sigma)));
            pixels[static_cast<std::size_t>(v * k_width_px + u)] =
                static_cast<std::uint8_t>(std::min(255.0, grey));
          }
        }
        extract(pixels, k_width_px, k_height_px);
        for (int u = 0; u < k_width_px; ++u) {
          const ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
          for (std::size_t i = 0; i < column.kept_count; ++i) {
            const Peak& peak = column.kept[i];
            const double off = std::abs(peak.row_px - middle(u));
            const bool told = (peak.flags & k_peak_poor_fit) != 0 && 2 * peak.sigma_row_px >= off;
            wide += off > 4.5 ? 1 : 0;
            CHECK_TEXT(off <= 2.5 + 0.2 * top_px || told,
                       StringFromFormat("top %g px, flanks %g and %g px: %g px off, sigma %g", top_px,
                                        above_px, below_px, off, static_cast<double>(peak.sigma_row_px))
                           .asCharString());
          }
        }
      }
    }
  }
  CHECK(wide > 0);  // else this test met no case that matters
}

TEST(PeakExtractor, DarkColumnHasNoPeakAndNoiseIsNone) {
  MadeStripe made;
  made.amplitude = 0;
  extract(test::picture(made, random), made.width_px, made.height_px);
  for (int u = 0; u < made.width_px; ++u)
    LONGS_EQUAL(0, peaks->columns[static_cast<std::size_t>(u)].kept_count);
}

TEST(PeakExtractor, KeepsTheTwoStrongestOfThreeAndCountsAll) {
  MadeStripe made;
  std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
  const double rows[] = {20.3, 60.7, 101.2}, amplitudes[] = {80, 200, 120};
  for (int i = 0; i < 3; ++i) {
    made.row_px = [&](int) { return rows[i]; };
    made.amplitude = amplitudes[i];
    test::add_stripe(made, mean);
  }
  extract(test::expose(made, mean, random), made.width_px, made.height_px);
  for (int u = 0; u < made.width_px; ++u) {
    const ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
    LONGS_EQUAL(2, column.kept_count);
    LONGS_EQUAL(3, column.seen_count);
    DOUBLES_EQUAL(60.7, column.kept[0].row_px, 0.2);
    DOUBLES_EQUAL(101.2, column.kept[1].row_px, 0.2);
  }
}

TEST(PeakExtractor, TwoNearStripesAreFlaggedAndFartherOnesAreTwo) {
  for (const double apart_px : {8.0, 10.0, 24.0}) {
    MadeStripe made;
    made.noise.speckle_contrast = 0.1F;
    for (int offset = 0; offset < 8; ++offset) {  // against the blocks of rows
      std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
      for (const double row_px : {50.3 + offset, 50.3 + offset + apart_px}) {
        made.row_px = [row_px](int) { return row_px; };
        test::add_stripe(made, mean);
      }
      extract(test::expose(made, mean, random), made.width_px, made.height_px);
      for (int u = 0; u < made.width_px; ++u) {
        const ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
        if (apart_px > 20) {
          LONGS_EQUAL(2, column.kept_count);
        } else {
          CHECK(column.kept[0].flags & k_peak_poor_fit);
        }
      }
    }
  }
}

TEST(PeakExtractor, WidthAndAmplitudeAreTheStripes) {
  for (const double sigma_px : {1.0, 2.1, 5.0, 8.0}) {
    MadeStripe made;
    made.sigma_px = sigma_px;
    extract(test::picture(made, random), made.width_px, made.height_px);
    const Peak& peak = peaks->columns[128].kept[0];
    DOUBLES_EQUAL(2.3548 * sigma_px, peak.width_px, 0.05 * 2.3548 * sigma_px + 0.05);
    DOUBLES_EQUAL(180, peak.amplitude, 8);
    LONGS_EQUAL(0, peak.flags & ~k_peak_narrow);
  }
}

TEST(PeakExtractor, EvenAmbientLightMovesNothing) {
  MadeStripe made;
  made.background = 60;
  made.amplitude = 100;
  const Accuracy result = accuracy(made, {.noise = made.noise}, 5);
  CHECK(result.rms_px < 1.5 * test::cramer_rao_px(made, 60.3));
  DOUBLES_EQUAL(60, peaks->columns[50].kept[0].background, 1.5);
}

TEST(PeakExtractor, StripeOverTheRegionsEdgeIsClipped) {
  MadeStripe made;
  for (const double row_px : {1.0, 126.5}) {
    made.row_px = [&](int) { return row_px; };
    extract(test::picture(made, random), made.width_px, made.height_px);
    for (int u = 0; u < made.width_px; ++u) {
      const ColumnPeaks& column = peaks->columns[static_cast<std::size_t>(u)];
      LONGS_EQUAL(1, column.kept_count);
      CHECK(column.kept[0].flags & k_peak_clipped);
    }
  }
}

TEST(PeakExtractor, HotPixelIsNarrow) {
  std::vector<std::uint8_t> pixels(64 * 64, 0);
  pixels[30 * 64 + 20] = 250;
  extract(pixels, 64, 64);
  const ColumnPeaks& column = peaks->columns[20];
  LONGS_EQUAL(1, column.kept_count);
  CHECK(column.kept[0].flags & k_peak_narrow);
  LONGS_EQUAL(0, peaks->columns[19].kept_count);
}

TEST(PeakExtractor, EveryModeFindsTheStripe) {
  // Without noise: what is left is each mode's own bias over the sub-pixel phases.
  struct Row {
    PeakMode mode;
    double tolerance_px;
  };
  for (const Row& row :
       {Row{PeakMode::Matched, 0.02}, Row{PeakMode::Maximum, 0.1}, Row{PeakMode::Threshold, 0.05},
        Row{PeakMode::CentreOfGravity, 0.1}, Row{PeakMode::FirZeroCrossing, 0.02}}) {
    MadeStripe made;
    made.noise = {
        .read_noise_grey = 0, .gain_grey_per_electron = 0, .speckle_contrast = 0, .speckle_grain_px = 1};
    made.row_px = [](int u) { return 50 + 0.013 * u; };
    extract(test::picture(made, random), made.width_px, made.height_px, {.mode = row.mode});
    for (int u = 0; u < made.width_px; ++u) {
      DOUBLES_EQUAL(made.row_px(u), peaks->columns[static_cast<std::size_t>(u)].kept[0].row_px,
                    row.tolerance_px);
    }
  }
}

TEST(PeakExtractor, OddWidthsStridesAndStepsLoseNoColumn) {
  // Widths about the vectors' lengths; a step of 60 rows in mid-vector; rows farther apart than the width.
  for (const int width_px : {16, 17, 63, 65, 100, 127}) {
    MadeStripe made;
    made.width_px = width_px;
    made.height_px = 130;
    made.row_px = [&](int u) { return u < width_px / 2 ? 30.25 : 90.75; };
    const auto pixels = test::picture(made, random);
    const std::size_t stride = static_cast<std::size_t>(width_px) + 13;
    std::vector<std::uint8_t> padded(stride * 130, 255);
    for (std::size_t v = 0; v < 130; ++v) {
      std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(v) * width_px, width_px,
                  padded.begin() + static_cast<std::ptrdiff_t>(v * stride));
    }
    auto sut = PeakExtractor::create({}, width_px, 130);
    CHECK(sut.has_value());
    sut->rt_extract({.pixels = padded.data(), .stride_bytes = stride}, *peaks);
    for (int u = 0; u < width_px; ++u) {
      LONGS_EQUAL(1, peaks->columns[static_cast<std::size_t>(u)].kept_count);
      DOUBLES_EQUAL(made.row_px(u), peaks->columns[static_cast<std::size_t>(u)].kept[0].row_px, 0.3);
    }
  }
}

TEST(PeakExtractor, ReadingEverySecondOrFourthRowFindsWhatReadingAllFinds) {
  // Stripes as narrow as permitted and wider ones, faint and bright, rising over all rows of a block and
  // beyond the region's edges, with a second one beside them, under light and speckle.
  struct Row {
    float width_min_px;
    int stride;
  };
  const Row rows[] = {{1.5F, 2}, {4.0F, 4}};
  for (const Row& row : rows) {
    LONGS_EQUAL(row.stride, plan_search({.width_min_px = row.width_min_px}).row_stride);
    for (const double widths : {1.05, 1.6, 4.0}) {
      for (const double amplitude : {22.0, 180.0}) {
        for (const double background : {0.0, 40.0}) {
          MadeStripe made;
          made.background = background;
          made.sigma_px = widths * row.width_min_px / 2.3548;
          made.amplitude = amplitude;
          made.noise.speckle_contrast = 0.1F;
          made.width_px = 260;
          made.height_px = 141;
          std::vector<double> mean(static_cast<std::size_t>(made.width_px * made.height_px), 0.0);
          made.row_px = [](int u) { return -5 + 0.31 * u; };
          test::add_stripe(made, mean);
          made.row_px = [](int u) { return 145 - 0.17 * u; };
          test::add_stripe(made, mean);
          const std::vector<std::uint8_t> pixels = test::expose(made, mean, random);
          // Down to a width of nearly nothing every row is read.
          LONGS_EQUAL(1, plan_search({.width_min_px = 0.1F}).row_stride);
          const auto all = std::make_unique<Peaks>(extract(pixels, 260, 141, {.width_min_px = 0.1F}));
          extract(pixels, 260, 141, {.width_min_px = row.width_min_px});
          for (std::size_t u = 0; u < 260; ++u) {
            const ColumnPeaks &expected = all->columns[u], &got = peaks->columns[u];
            LONGS_EQUAL(expected.seen_count, got.seen_count);
            LONGS_EQUAL(expected.kept_count, got.kept_count);
            // Noise may put the brightest pixel into a block where no row that is read shows the stripe: the
            // start values are then the next block's, the fit is the same to a hundredth of its sigma, and
            // two peaks of equal height may change places.
            const bool swapped =
                got.kept_count == 2 && std::fabs(expected.kept[0].row_px - got.kept[1].row_px) <
                                           std::fabs(expected.kept[0].row_px - got.kept[0].row_px);
            for (std::size_t i = 0; i < got.kept_count; ++i) {
              const Peak &one = expected.kept[i], &other = got.kept[swapped ? 1 - i : i];
              DOUBLES_EQUAL(one.row_px, other.row_px, 0.01 * one.sigma_row_px);
              LONGS_EQUAL(one.flags & ~k_peak_narrow, other.flags & ~k_peak_narrow);
            }
          }
        }
      }
    }
  }
}

TEST(PeakExtractor, RefusesWhatItCannotHold) {
  CHECK(!PeakExtractor::create({}, 4000, 100));
  CHECK(!PeakExtractor::create({}, 100, 4));
  CHECK(!PeakExtractor::create({.threshold_grey = 0}, 100, 100));
  CHECK(!PeakExtractor::create({.width_min_px = 5, .width_max_px = 4}, 100, 100));
}

// Runs of one grey level, column by column, as the fuzz target draws them: some are fitted beyond the
// picture.
TEST(PeakExtractor, NoModeReadsBeyondThePicture) {
  constexpr int k_width_px = 28, k_height_px = 30, k_rows_px = 3 * k_height_px;
  // Full scale but for some dark and half-bright runs, each with its length.
  constexpr std::pair<int, int> k_runs[] = {{255, 81}, {0, 32},  {255, 128}, {12, 15},  {50, 11}, {255, 96},
                                            {9, 2},    {255, 8}, {167, 88},  {255, 64}, {48, 32}, {255, 128}};
  int beyond = 0;
  for (const PeakMode mode : {PeakMode::Matched, PeakMode::Maximum, PeakMode::Threshold,
                              PeakMode::CentreOfGravity, PeakMode::FirZeroCrossing}) {
    std::vector<Peaks> seen;
    for (const std::uint8_t below : {0, 255}) {
      std::vector<std::uint8_t> pixels(static_cast<std::size_t>(k_width_px * k_rows_px), 0);
      std::fill(pixels.begin() + k_width_px * k_height_px, pixels.end(), below);
      int at = 0;
      for (const auto& [grey, length] : k_runs) {
        for (int i = 0; i < length; ++i, ++at)
          pixels[static_cast<std::size_t>(at % k_height_px * k_width_px + at / k_height_px)] =
              static_cast<std::uint8_t>(grey);
      }
      seen.push_back(extract(pixels, k_width_px, k_height_px, {.mode = mode, .threshold_grey = 6}));
    }
    for (std::size_t column = 0; column < std::size_t{k_width_px}; ++column) {
      const ColumnPeaks &one = seen[0].columns[column], &other = seen[1].columns[column];
      LONGS_EQUAL(one.kept_count, other.kept_count);
      for (std::size_t i = 0; i < one.kept_count; ++i) {
        DOUBLES_EQUAL(one.kept[i].row_px, other.kept[i].row_px, 0);
        DOUBLES_EQUAL(one.kept[i].width_px, other.kept[i].width_px, 0);
        if (one.kept[i].row_px >= 0 && one.kept[i].row_px <= k_height_px - 1) continue;
        ++beyond;
        CHECK((one.kept[i].flags & k_peak_clipped) != 0);
      }
    }
  }
  CHECK(beyond > 0);
}

// Steps, plateaus and slopes in place of stripes: a place without a flag is one where the column is bright.
TEST(PeakExtractor, NoModeLeavesThePictureWithoutSayingSo) {
  constexpr int k_width_px = 64, k_height_px = 96;
  for (int picture = 0; picture < 60; ++picture) {
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(k_width_px * k_height_px));
    for (int at = 0; at < k_width_px * k_height_px;) {
      const int grey = static_cast<int>(random() % 256), length = 1 + static_cast<int>(random() % 40),
                slope = static_cast<int>(random() % 5) - 2;
      for (int i = 0; i < length && at < k_width_px * k_height_px; ++i, ++at)
        pixels[static_cast<std::size_t>(at % k_height_px * k_width_px + at / k_height_px)] =
            static_cast<std::uint8_t>(std::clamp(grey + slope * i, 0, 255));
    }
    for (const PeakMode mode : {PeakMode::Matched, PeakMode::Maximum, PeakMode::Threshold,
                                PeakMode::CentreOfGravity, PeakMode::FirZeroCrossing}) {
      extract(pixels, k_width_px, k_height_px,
              {.mode = mode, .threshold_grey = static_cast<float>(1 + random() % 100)});
      for (std::size_t column = 0; column < std::size_t{k_width_px}; ++column) {
        for (std::size_t i = 0; i < peaks->columns[column].kept_count; ++i) {
          const Peak& peak = peaks->columns[column].kept[i];
          CHECK((peak.row_px >= 0 && peak.row_px <= k_height_px - 1) || (peak.flags & k_peak_clipped) != 0);
        }
      }
    }
  }
}

}  // namespace biteline::stripe
