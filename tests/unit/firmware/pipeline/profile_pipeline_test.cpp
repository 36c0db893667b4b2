// SPDX-License-Identifier: MIT
#include "firmware/pipeline/profile_pipeline.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>

#include "tests/support/made_head.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::pipeline {
namespace {

using stripe::test::MadeStripe;

constexpr int k_width_px = 320, k_height_px = 160;
/// Rows of the sessions' heads err by this much on one column; unflagged points may not be off by more than
/// five times it.
constexpr double k_far_px = 0.3;

SensorClock::time_point at_ms(std::int64_t time_ms) {
  return SensorClock::time_point{std::chrono::milliseconds{time_ms}};
}

}  // namespace

TEST_GROUP(ProfilePipeline) {
  std::mt19937_64 random{23};
  geometry::SensorModel head = test::made_head(k_width_px, k_height_px);
  std::unique_ptr<profile::ProfileBuffer> out = std::make_unique<profile::ProfileBuffer>();
  std::uint64_t sequence = 0;

  MadeStripe made() {
    MadeStripe stripe;
    stripe.width_px = k_width_px;
    stripe.height_px = k_height_px;
    return stripe;
  }
  std::vector<double> dark() {
    return std::vector<double>(k_width_px * k_height_px, 0.0);
  }

  bool process(ProfilePipeline & sut, const std::vector<std::uint8_t>& pixels, std::int64_t time_ms = 0,
               std::uint32_t flags = 0) {
    return sut.rt_process({.pixels = pixels,
                           .width_px = k_width_px,
                           .height_px = k_height_px,
                           .stride_bytes = k_width_px,
                           .sequence = sequence++,
                           .exposure_mid = at_ms(time_ms),
                           .flags = flags},
                          *out);
  }

  ProfilePipeline create(const ProfilePipeline::Config& config = {}) {
    auto sut = ProfilePipeline::create(config, head);
    CHECK(sut.has_value());
    return std::move(*sut);
  }

  double row_in_region(const profile::ProfilePoint& point) {
    return static_cast<double>(point.row_px) - head.region.offset_v_px;
  }
};

TEST(ProfilePipeline, PointsLieWhereTheDirectFormulaPutsTheStripe) {
  MadeStripe stripe = made();
  stripe.row_px = [](int u) { return 60 + 0.1 * u; };
  ProfilePipeline sut = create({.peaks = {.noise = stripe.noise}});
  CHECK(process(sut, stripe::test::picture(stripe, random)));
  LONGS_EQUAL(k_width_px, out->count);
  CHECK(out->header.flags == profile::k_profile_pose_missing);
  double sum_normalised = 0;
  for (const profile::ProfilePoint& point : out->view()) {
    LONGS_EQUAL(0, point.flags);
    const Vec2 pixel_px{point.column + head.region.offset_u_px,
                        stripe.row_px(point.column) + head.region.offset_v_px};
    const Vec3 expected = geometry::triangulate(head.camera, head.laser_plane, pixel_px);
    sum_normalised += (point.point_cam.cast<double>() - expected).squaredNorm() /
                      std::pow(static_cast<double>(point.sigma_mm), 2);
  }
  // Neighbours share their average: some 30 independent ones.
  DOUBLES_EQUAL(1.0, sum_normalised / k_width_px, 0.8);
}

TEST(ProfilePipeline, StripeWhereTheLaserPlaneIsNotSeenGivesNoPoint) {
  // The plane runs along the rays of the right half: the stripe there is none of the laser's.
  head.laser_plane = {.normal_cam = Vec3{1, 0, 0}, .distance_mm = -40};
  head.camera.cu_px = head.region.offset_u_px + 0.5 * k_width_px;
  ProfilePipeline sut = create();
  MadeStripe stripe = made();
  CHECK(process(sut, stripe::test::picture(stripe, random)));
  CHECK(out->count > 0);
  for (std::size_t i = 0; i < out->count; ++i) {
    CHECK(out->points[i].point_cam.allFinite());
    CHECK(std::isfinite(out->points[i].sigma_mm));
    CHECK_COMPARE(out->points[i].column, <, k_width_px / 2);
  }
}

TEST(ProfilePipeline, MirrorImageOverHalfTheStripeIsFlagged) {
  // A weaker, wider second stripe, where the surface shines; in ten columns it is all there is.
  MadeStripe direct = made(), mirror = made();
  direct.row_px = [](int u) { return u >= 200 && u < 210 ? -100.0 : 100.0 - 0.05 * u; };
  mirror.row_px = [](int u) { return u >= 150 && u < 250 ? 40 + 0.3 * (u - 150) : -100.0; };
  mirror.amplitude = 90;
  mirror.sigma_px = 3.5;
  auto mean = dark();
  stripe::test::add_stripe(direct, mean);
  stripe::test::add_stripe(mirror, mean);
  ProfilePipeline sut = create();
  int surface = 0, mirrored = 0;
  CHECK(process(sut, stripe::test::expose(direct, mean, random)));
  for (const profile::ProfilePoint& point : out->view()) {
    const bool is_mirror = std::fabs(row_in_region(point) - mirror.row_px(point.column)) < 3;
    if (point.flags & profile::k_point_not_surface) {
      mirrored += is_mirror ? 1 : 0;
      continue;
    }
    if (!is_mirror) ++surface;
    // Where the direct stripe is there, no mirror image passes for it.
    if (point.column < 200 || point.column >= 210) CHECK(!is_mirror);
  }
  CHECK(surface >= k_width_px - 10 - 4);
  // Of 90; where the two come within two blocks of rows of each other, the weaker one is not told apart.
  CHECK(mirrored >= 80);
}

TEST(ProfilePipeline, WhatPrintCutsIsFlaggedAndMovesNoNeighbour) {
  // Black print whose edge rises one row in three columns across the stripe.
  MadeStripe stripe = made();
  auto mean = dark();
  stripe::test::add_stripe(stripe, mean);
  for (int u = 0; u < k_width_px; ++u) {
    for (int v = 0; v < k_height_px; ++v) {
      const double beyond_px = v - 70 + (u - 150) / 3.0;
      mean[static_cast<std::size_t>(v * k_width_px + u)] *= 1 - 0.95 * std::clamp(beyond_px + 0.5, 0.0, 1.0);
    }
  }
  ProfilePipeline sut = create({.peaks = {.noise = stripe.noise}});
  CHECK(process(sut, stripe::test::expose(stripe, mean, random)));
  int cut = 0;
  double worst_px = 0, worst_cut_px = 0;
  for (const profile::ProfilePoint& point : out->view()) {
    const double error_px = std::fabs(row_in_region(point) - 60);
    const bool is_cut = (point.flags & profile::k_point_brightness_step) != 0;
    cut += is_cut ? 1 : 0;
    if (is_cut) worst_cut_px = std::max(worst_cut_px, error_px);
    if ((point.flags & profile::k_point_not_surface) == 0) worst_px = std::max(worst_px, error_px);
  }
  CHECK(cut >= 15);
  CHECK(worst_cut_px > 1.5);
  CHECK_TEXT(worst_px < 0.15, StringFromFormat("%.3f px", worst_px).asCharString());
}

TEST(ProfilePipeline, LightScatteredToOneSideAddsDoubt) {
  MadeStripe stripe = made(), halo = made();
  halo.amplitude = 0.2 * stripe.amplitude;
  halo.sigma_px = 2 * stripe.sigma_px;
  halo.row_px = [&](int u) { return u < 200 ? -1000.0 : 60 + 2 * stripe.sigma_px; };
  auto mean = dark();
  stripe::test::add_stripe(stripe, mean);
  stripe::test::add_stripe(halo, mean);
  ProfilePipeline sut = create({.peaks = {.noise = stripe.noise}});
  CHECK(process(sut, stripe::test::expose(stripe, mean, random)));
  for (const profile::ProfilePoint& point : out->view()) {
    LONGS_EQUAL(0, point.flags & profile::k_point_not_surface);
    if (point.column > 210) {
      CHECK(std::fabs(row_in_region(point) - 60) < 3.5 * static_cast<double>(point.sigma_row_px));
      CHECK(point.sigma_row_px > 0.2F);
    } else if (point.column < 190) {
      CHECK(point.sigma_row_px < 0.05F);
    }
  }
}

TEST(ProfilePipeline, SpatterAndHotPixelsDoNotPassForSurface) {
  MadeStripe stripe = made();
  auto mean = dark();
  stripe::test::add_stripe(stripe, mean);
  std::uniform_int_distribution<int> anywhere{0, k_width_px * k_height_px - 1};
  for (int i = 0; i < 300; ++i)
    mean[static_cast<std::size_t>(anywhere(random))] += 240;  // brighter than the stripe
  ProfilePipeline sut = create();
  CHECK(process(sut, stripe::test::expose(stripe, mean, random)));
  int surface = 0;
  for (const profile::ProfilePoint& point : out->view()) {
    if (point.flags & profile::k_point_not_surface) continue;
    ++surface;
    CHECK(std::fabs(row_in_region(point) - 60) < 3 * k_far_px);
  }
  CHECK(surface > k_width_px * 7 / 10);
}

TEST(ProfilePipeline, StepsMixNoSurfaces) {
  for (const double step_px : {8.0, 10.0, 14.0, 25.0, 50.0}) {
    MadeStripe stripe = made();
    const auto upper = [](int u) { return 50 + 0.03 * u; };
    auto mean = dark();
    // Optics blur the step along the columns: both stripes show beside it.
    for (int u = 0; u < k_width_px; ++u) {
      const double share = 0.5 * std::erfc(std::clamp((u - 160.3) / (1.2 * std::sqrt(2.0)), -5.0, 5.0));
      for (int v = 0; v < k_height_px; ++v) {
        const double a = (v - upper(u)) / 2.1, b = (v - upper(u) - step_px) / 2.1;
        const auto gauss = [](double x) { return std::fabs(x) < 6 ? std::exp(-0.5 * x * x) : 0.0; };
        mean[static_cast<std::size_t>(v * k_width_px + u)] =
            170 * (share * gauss(a) + (1 - share) * gauss(b));
      }
    }
    ProfilePipeline sut = create();
    CHECK(process(sut, stripe::test::expose(stripe, mean, random)));
    for (const profile::ProfilePoint& point : out->view()) {
      if (point.flags & profile::k_point_not_surface) continue;
      const double error = row_in_region(point) - upper(point.column);
      CHECK_TEXT(std::min(std::fabs(error), std::fabs(error - step_px)) < k_far_px,
                 StringFromFormat("step %g column %d error %g", step_px, point.column, error).asCharString());
    }
  }
}

TEST(ProfilePipeline, LaserOffFrameTakesTheRoomsLightAway) {
  // A bright edge across the picture, steeper than any ambient level: without the dark frame it is a stripe
  // of its own.
  MadeStripe stripe = made(), lamp = made();
  lamp.row_px = [](int) { return 120.0; };
  lamp.amplitude = 200;
  stripe.amplitude = 120;
  auto ambient = dark(), lit = dark();
  stripe::test::add_stripe(lamp, ambient);
  lit = ambient;
  stripe::test::add_stripe(stripe, lit);
  ProfilePipeline sut = create({.peaks = {.noise = stripe.noise}});
  CHECK(!process(sut, stripe::test::expose(stripe, ambient, random), 0, hal::k_frame_laser_off));
  CHECK(process(sut, stripe::test::expose(stripe, lit, random), 10));
  LONGS_EQUAL(k_width_px, out->count);
  for (const profile::ProfilePoint& point : out->view()) {
    LONGS_EQUAL(0, point.flags);
    DOUBLES_EQUAL(60, row_in_region(point), k_far_px);
  }
  // Too old a dark frame is of another place.
  CHECK(process(sut, stripe::test::expose(stripe, lit, random), 500));
  CHECK(out->view()[0].flags & profile::k_point_other_peaks);
}

TEST(ProfilePipeline, BracketShowsBlackAndGlossyInOneProfile) {
  // Left half black (a hundredth of the light), right half glossy (saturates long before) with a mirror
  // image.
  const auto scene = [&](double exposure) {
    auto mean = dark();
    MadeStripe direct = made();
    direct.row_px = [](int u) { return u < 160 ? 60.0 : -100.0; };
    direct.amplitude = 6 * exposure;
    stripe::test::add_stripe(direct, mean);
    direct.row_px = [](int u) { return u >= 160 ? 62.0 : -100.0; };
    direct.amplitude = 200 * exposure;
    stripe::test::add_stripe(direct, mean);
    MadeStripe mirror = made();
    mirror.row_px = [](int u) { return u >= 200 && u < 300 ? 110 - 0.1 * u : -100.0; };
    mirror.amplitude = 15 * exposure;
    stripe::test::add_stripe(mirror, mean);
    return stripe::test::expose(direct, mean, random);
  };
  ProfilePipeline sut = create({.bracketing = true});
  CHECK(!process(sut, scene(1), 0));
  CHECK(process(sut, scene(15), 4, hal::k_frame_second_exposure));
  LONGS_EQUAL(4'000'000, out->header.second_exposure_after.count());
  int black = 0, glossy = 0;
  for (const profile::ProfilePoint& point : out->view()) {
    if (point.flags & profile::k_point_not_surface) continue;
    const bool is_black = point.column < 160;
    DOUBLES_EQUAL(is_black ? 60 : 62, row_in_region(point), k_far_px);
    LONGS_EQUAL(is_black, (point.flags & profile::k_point_second_exposure) != 0);
    CHECK((point.flags & profile::k_point_saturated) == 0);
    (is_black ? black : glossy) += 1;
  }
  CHECK(black >= 152);  // 95 %
  CHECK(glossy >= 152);
}

TEST(ProfilePipeline, WhatTheLongerExposureTookForAMirrorImageIsNoPointOfTheShorterOne) {
  // The shorter exposure sees nothing but a mirror image.  The longer one's own stripe is dim in its last two
  // columns, as at an edge, and saturated in one column, as by a grain.
  constexpr int k_end = 240, k_dim = k_end - 2, k_grain = 220;
  const auto scene = [&](double exposure) {
    auto mean = dark();
    const auto add = [&](int from, int to, double row_px, double amplitude) {
      MadeStripe stripe = made();
      stripe.row_px = [=](int u) { return u >= from && u < to ? row_px : -100.0; };
      stripe.amplitude = amplitude * exposure;
      stripe::test::add_stripe(stripe, mean);
    };
    add(0, k_dim, 60, 5);
    add(k_dim, k_end, 60, 2);
    add(k_grain, k_grain + 1, 60, 35);
    add(200, 300, 110, 40);
    return stripe::test::expose(made(), mean, random);
  };
  ProfilePipeline sut = create({.bracketing = true});
  CHECK(!process(sut, scene(1), 0));
  CHECK(process(sut, scene(15), 4, hal::k_frame_second_exposure));
  int cut = 0, saturated = 0;
  for (const profile::ProfilePoint& point : out->view()) {
    if (point.column >= k_end || (point.flags & profile::k_point_reflection) != 0) continue;
    DOUBLES_EQUAL(60, row_in_region(point), 5 * k_far_px);
    cut += (point.flags & profile::k_point_edge_mixed) != 0 && point.column >= k_dim ? 1 : 0;
    saturated += (point.flags & profile::k_point_saturated) != 0 && point.column == k_grain ? 1 : 0;
  }
  LONGS_EQUAL(2, cut);
  LONGS_EQUAL(1, saturated);
}

TEST(ProfilePipeline, BracketsSecondPointsAreCarriedToTheFirstInstant) {
  // The arm moves along the camera's x by 1 mm between the exposures: a second point seen at p stood at p - 1
  // mm.
  MadeStripe faint = made();
  faint.amplitude = 5;
  MadeStripe bright = made();
  ProfilePipeline sut = create({.bracketing = true});
  PoseHistory poses;
  for (int i = 0; i < 200; ++i) {
    geometry::PoseSample sample{.stamp = at_ms(i)};
    sample.T_base_flange.translation() = head.T_flange_cam.linear() * Vec3{0.25 * i, 0, 0};
    poses.rt_push(sample);
  }
  CHECK(!process(sut, stripe::test::picture(faint, random), 100));
  CHECK(process(sut, stripe::test::picture(bright, random), 104, hal::k_frame_second_exposure));
  CHECK(sut.rt_pose_ready(*out, poses));
  const Eigen::Vector3f before = out->view()[50].point_cam;
  sut.rt_stamp(*out, poses);
  CHECK(out->header.flags == 0);
  DOUBLES_EQUAL(0, (out->view()[50].point_cam - before - Eigen::Vector3f{1, 0, 0}).norm(), 1e-3);
}

TEST(ProfilePipeline, ProfileTellsTheSpeckleOfTheLongerExposureThatShowsIt) {
  MadeStripe grainy = made(), even = made(), none = made();
  grainy.noise.speckle_contrast = 0.3F;
  none.amplitude = 0;
  const auto seen = std::make_unique<stripe::Peaks>();
  auto extractor = stripe::PeakExtractor::create({}, k_width_px, k_height_px);
  CHECK(extractor.has_value());
  const auto contrast_in = [&](const std::vector<std::uint8_t>& pixels) {
    extractor->rt_extract({.pixels = pixels.data(), .stride_bytes = k_width_px}, *seen);
    CHECK(seen->speckle.measured);
    return seen->speckle.contrast;
  };
  const auto bright = stripe::test::picture(grainy, random), level = stripe::test::picture(even, random),
             dark = stripe::test::picture(none, random);
  CHECK_COMPARE(contrast_in(bright), >, contrast_in(level) + 0.1F);

  ProfilePipeline alone = create(), bracket = create({.bracketing = true});
  CHECK(process(alone, bright));
  CHECK(out->header.speckle_contrast == contrast_in(bright));
  CHECK(process(alone, dark));
  CHECK(!out->header.speckle_contrast.has_value());
  const auto bracketed = [&](const std::vector<std::uint8_t>& first,
                             const std::vector<std::uint8_t>& second) {
    CHECK(!process(bracket, first, 0));
    CHECK(process(bracket, second, 4, hal::k_frame_second_exposure));
    return out->header.speckle_contrast;
  };
  CHECK(bracketed(level, bright) == contrast_in(bright));
  CHECK(bracketed(bright, dark) == contrast_in(bright));
  CHECK(!bracketed(dark, dark).has_value());
}

TEST(ProfilePipeline, LostHalvesOfABracketGoOutAlone) {
  const auto pixels = stripe::test::picture(made(), random);
  ProfilePipeline sut = create({.bracketing = true});
  CHECK(!process(sut, pixels, 0));
  CHECK(process(sut, pixels, 10));  // the first one's second was lost
  CHECK(at_ms(0) == out->header.exposure_mid);
  CHECK(process(sut, pixels, 14, hal::k_frame_second_exposure));
  CHECK(at_ms(10) == out->header.exposure_mid);
  CHECK(process(sut, pixels, 24, hal::k_frame_second_exposure));  // without its first
  CHECK(at_ms(24) == out->header.exposure_mid);
  LONGS_EQUAL(0, out->header.second_exposure_after.count());
}

TEST(ProfilePipeline, DarkFrameSaysTheStripeIsLost) {
  ProfilePipeline sut = create();
  MadeStripe none = made();
  none.amplitude = 0;
  CHECK(process(sut, stripe::test::picture(none, random)));
  CHECK(out->header.flags & profile::k_profile_stripe_lost);
  LONGS_EQUAL(0, out->count);
}

TEST(ProfilePipeline, FrameFlagsTravel) {
  ProfilePipeline sut = create();
  CHECK(
      process(sut, stripe::test::picture(made(), random), 0, hal::k_frame_damaged | hal::k_frame_gap_before));
  CHECK(out->header.flags & profile::k_profile_frame_damaged);
  CHECK(out->header.flags & profile::k_profile_frame_gap);
}

/// 2448 x 2048, whole: a stripe from the lower left to the upper right and its mirror image below, two points
/// in every column.
TEST(ProfilePipeline, FiveMegapixelFrameGivesEveryColumnAndBothPeaks) {
  constexpr int k_wide_px = 2448, k_high_px = 2048;
  head.camera = {.fu_px = 4800, .fv_px = 4800, .cu_px = 1224, .cv_px = 1024};
  head.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_wide_px, .height_px = k_high_px};
  MadeStripe direct, mirror;
  direct.width_px = mirror.width_px = k_wide_px;
  direct.height_px = mirror.height_px = k_high_px;
  direct.row_px = [](int u) { return 1700 - 0.6 * u; };
  mirror.row_px = [](int u) { return 1900 - 0.6 * u; };
  mirror.amplitude = 100;
  std::vector<double> mean(std::size_t{k_wide_px} * k_high_px, 0.0);
  stripe::test::add_stripe(direct, mean);
  stripe::test::add_stripe(mirror, mean);
  std::vector<std::uint8_t> pixels;
  for (const double grey : mean) pixels.push_back(static_cast<std::uint8_t>(std::lround(grey)));

  ProfilePipeline sut = create({.peaks = {.noise = direct.noise}});
  CHECK(sut.rt_process({.pixels = pixels,
                        .width_px = k_wide_px,
                        .height_px = k_high_px,
                        .stride_bytes = k_wide_px,
                        .sequence = 0,
                        .exposure_mid = at_ms(0)},
                       *out));
  LONGS_EQUAL(2 * k_wide_px, out->count);
  for (const profile::ProfilePoint& point : out->view()) {
    const double row_px = row_in_region(point);
    const double expected_px = std::fabs(row_px - direct.row_px(point.column)) < 100
                                   ? direct.row_px(point.column)
                                   : mirror.row_px(point.column);
    // Noise-free pictures: what is left is the rounding to whole grey levels, far below a tenth of a pixel.
    DOUBLES_EQUAL(expected_px, row_px, 0.05);
  }
  LONGS_EQUAL(k_wide_px - 1, out->points[out->count - 1].column);
}

TEST(ProfilePipeline, CameraWiderThanTheTablesIsRefused) {
  head.region.width_px = static_cast<int>(stripe::k_max_columns) + 1;
  const auto refused = ProfilePipeline::create({}, head);
  CHECK(!refused.has_value());
  CHECK(refused.error().where.view().find("2592") != std::string_view::npos);
}

}  // namespace biteline::pipeline
