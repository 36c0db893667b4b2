// SPDX-License-Identifier: MIT
#include "hal/sim/render/stripe_renderer.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <memory>
#include <numeric>

#include "common/geometry/sensor_model.hpp"
#include "common/optics/stripe_noise.hpp"
#include "common/stripe/peak_extractor.hpp"

namespace biteline::sim {

namespace {

/// A flat board across the beam: z = 0, the head looks down on it.
SurfaceMesh board(SurfaceLook left, SurfaceLook right) {
  SurfaceMesh mesh;
  for (const double side : {-1.0, 1.0}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto edge = static_cast<float>(side * 300);
    for (const auto& corner : {std::array{0.0F, -300.0F, 0.0F}, std::array{edge, -300.0F, 0.0F},
                               std::array{edge, 300.0F, 0.0F}, std::array{0.0F, 300.0F, 0.0F}}) {
      mesh.vertices.push_back(corner);
      mesh.looks.push_back(side < 0 ? left : right);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

/// The beam meets the board head on at the origin; camera x along the board's x.
SE3 T_board_cam(const MadeHead& head) {
  Mat3 R_cam_board;
  R_cam_board.col(0) = head.laser.beam_cam.cross(head.model.laser_plane.normal_cam);
  if (R_cam_board.col(0).x() < 0) R_cam_board.col(0) = -R_cam_board.col(0);
  R_cam_board.col(2) = -head.laser.beam_cam;
  R_cam_board.col(1) = R_cam_board.col(2).cross(R_cam_board.col(0));
  SE3 T_cam_board = SE3::Identity();
  T_cam_board.linear() = R_cam_board;
  T_cam_board.translation() = Vec3(0, 0, head.working_distance_mm);
  return T_cam_board.inverse();
}

double column_light(const std::vector<std::uint8_t>& pixels, const geometry::Region& region, int column) {
  double sum = 0;
  for (int row = 0; row < region.height_px; ++row)
    sum += pixels[static_cast<std::size_t>(row * region.width_px + column)];
  return sum;
}

}  // namespace

TEST_GROUP(StripeRenderer) {
  MadeHead head = draw_head(3);
  std::vector<TrueStripePoint> truth;
  std::vector<std::uint8_t> pixels;

  void setup() override {
    pixels.resize(static_cast<std::size_t>(head.model.region.width_px * head.model.region.height_px));
  }
  [[nodiscard]] Shot shot() const {
    return {.T_scene_cam = T_board_cam(head), .region = head.model.region, .noise_seed = 9};
  }
};

TEST(StripeRenderer, TrueRowsTriangulateOntoTheBoard) {
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  CHECK(truth.size() > 1500);
  for (const auto& stripe : truth) {
    const Vec2 pixel_px(stripe.column_px + head.model.region.offset_u_px,
                        stripe.row_px + head.model.region.offset_v_px);
    const Vec3 point_cam = geometry::triangulate(head.model.camera, head.model.laser_plane, pixel_px);
    const Vec3 point_board = T_board_cam(head) * point_cam;
    // Single precision of the ray tracer and a straight line between pixels half apart: a few micrometres at
    // the most.
    DOUBLES_EQUAL(0, point_board.z(), 0.002);
  }
}

TEST(StripeRenderer, PixelsCarryTheStripeWhereTheTruthSays) {
  head.laser.coherent = false;
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  double square_sum = 0;
  for (const auto& stripe : truth) {
    double sum = 0, moment = 0;
    for (int row = static_cast<int>(stripe.row_px) - 9; row <= static_cast<int>(stripe.row_px) + 10; ++row) {
      const double value =
          pixels[static_cast<std::size_t>(row * head.model.region.width_px + stripe.column_px)];
      sum += value;
      moment += value * row;
    }
    square_sum += std::pow(moment / sum - stripe.row_px, 2);
  }
  // Shot noise alone: sigma / sqrt(electrons) = 2.5 / sqrt(40 * 1000) = 0.013 px; read noise and rounding add
  // as much.
  CHECK(std::sqrt(square_sum / static_cast<double>(truth.size())) < 0.04);
}

TEST(StripeRenderer, IsTheSameForTheSameSeedOnly) {
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, nullptr);
  const auto first = pixels;
  Shot other = shot();
  other.noise_seed = 10;
  sut.render(other, pixels, nullptr);
  CHECK(first != pixels);
  sut.render(shot(), pixels, nullptr);
  CHECK(first == pixels);
}

TEST(StripeRenderer, LaserOffLeavesTheBackgroundAlone) {
  head.faults.ambient_grey = 12;
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  Shot dark = shot();
  dark.laser_on = false;
  sut.render(dark, pixels, &truth);
  LONGS_EQUAL(0, truth.size());
  const double mean = std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
  DOUBLES_EQUAL(12, mean, 0.05);
}

TEST(StripeRenderer, LightGrowsWithReflectanceAndExposureUntilItSaturates) {
  const Scene scene =
      *Scene::build(board({.diffuse_ratio = 0.05, .glossy = false}, {.diffuse_ratio = 0.5, .glossy = false}));
  StripeRenderer sut(scene, head);
  const auto mean_light = [&](double exposure_ratio, int from) {
    Shot exposed = shot();
    exposed.exposure_ratio = exposure_ratio;
    sut.render(exposed, pixels, nullptr);
    double sum = 0;
    for (int column = from; column < from + 200; ++column)
      sum += column_light(pixels, head.model.region, column);
    exposed.laser_on = false;
    sut.render(exposed, pixels, nullptr);
    for (int column = from; column < from + 200; ++column)
      sum -= column_light(pixels, head.model.region, column);
    return sum / 200;
  };
  const double black = mean_light(1, 200), bright = mean_light(1, 1200);
  CHECK(bright > 7 * black && bright < 13 * black);
  CHECK(mean_light(4, 200) > 3.5 * black);
  Shot bright_shot = shot();
  bright_shot.exposure_ratio = 4;
  sut.render(bright_shot, pixels, nullptr);
  CHECK(*std::max_element(pixels.begin(), pixels.end()) == 255);
}

TEST(StripeRenderer, GlossyPlacesAreDark) {
  const Scene scene =
      *Scene::build(board({.diffuse_ratio = 0.6, .glossy = true}, {.diffuse_ratio = 0.6, .glossy = false}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, nullptr);
  CHECK(column_light(pixels, head.model.region, 300) < 0.1 * column_light(pixels, head.model.region, 1300));
}

TEST(StripeRenderer, AMirrorImageIsMarkedAndLiesOffTheFirstSurface) {
  // A glossy board, and a matt wall standing on its edge that the mirrored fan meets.
  SurfaceMesh mesh = board({.diffuse_ratio = 0.6, .glossy = true}, {.diffuse_ratio = 0.6, .glossy = true});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& corner : {std::array{45.0F, -300.0F, 0.0F}, std::array{45.0F, 300.0F, 0.0F},
                             std::array{45.0F, 300.0F, 60.0F}, std::array{45.0F, -300.0F, 60.0F}}) {
    mesh.vertices.push_back(corner);
    mesh.looks.push_back({.diffuse_ratio = 0.9, .glossy = false});
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  const Scene scene = *Scene::build(mesh);
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  const auto mirrored =
      std::count_if(truth.begin(), truth.end(), [](const auto& stripe) { return stripe.mirrored; });
  CHECK(mirrored > 10);
}

TEST(StripeRenderer, ASmallerRegionShowsTheSameStripeShifted) {
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  const TrueStripePoint whole = truth[700];
  Shot small = shot();
  small.region = {.offset_u_px = 104,
                  .offset_v_px = head.model.region.offset_v_px + 60,
                  .width_px = 800,
                  .height_px = 200};
  pixels.resize(800 * 200);
  sut.render(small, pixels, &truth);
  const auto same = std::find_if(truth.begin(), truth.end(),
                                 [&](const auto& s) { return s.column_px == whole.column_px - 104; });
  CHECK(same != truth.end());
  DOUBLES_EQUAL(whole.row_px - 60, same->row_px, 1e-9);
}

TEST(StripeRenderer, MotionTowardsASurfaceBlursByItsWayWithinTheExposure) {
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  const std::vector<TrueStripePoint> still = truth;
  const auto near_row_px = [&](double away_mm) {
    Shot there = shot();
    there.T_scene_cam = Eigen::Translation3d(0, 0, away_mm) * there.T_scene_cam;
    sut.render(there, pixels, &truth);
    return truth[truth.size() / 2].row_px;
  };
  const double px_per_mm = near_row_px(0.5) - near_row_px(-0.5);
  for (const double speed_mm_s : {250.0, 500.0}) {
    for (const double exposure_s : {0.0004, 0.002}) {
      Shot moving = shot();
      moving.moved_cam_mm = moving.T_scene_cam.linear().transpose() * Vec3(0, 0, speed_mm_s * exposure_s);
      sut.render(moving, pixels, &truth);
      const TrueStripePoint &blurred = truth[truth.size() / 2], &sharp = still[still.size() / 2];
      const double smear_px =
          std::sqrt(12 * (blurred.sigma_px * blurred.sigma_px - sharp.sigma_px * sharp.sigma_px));
      DOUBLES_EQUAL(std::abs(px_per_mm) * speed_mm_s * exposure_s, smear_px, 0.03 * smear_px);
      // The light is the same, over more rows.
      DOUBLES_EQUAL(sharp.amplitude_grey * sharp.sigma_px, blurred.amplitude_grey * blurred.sigma_px, 0.5);
    }
  }
}

TEST(StripeRenderer, MotionAlongASurfaceBlursNothing) {
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  sut.render(shot(), pixels, &truth);
  const double sharp_px = truth[truth.size() / 2].sigma_px;
  Shot moving = shot();
  moving.moved_cam_mm = moving.T_scene_cam.linear().transpose() * Vec3(0, 1, 0);
  sut.render(moving, pixels, &truth);
  DOUBLES_EQUAL(sharp_px, truth[truth.size() / 2].sigma_px, 1e-6);
}

TEST(StripeRenderer, SpeckleStaysOnTheSurfaceAndGoesWithTheHead) {
  head.faults.read_noise_grey = 0;
  head.faults.electrons_per_grey = 1e6;
  const Scene scene = *Scene::build(board({}, {}));
  StripeRenderer sut(scene, head);
  const auto lights = [&](double along_mm, std::uint64_t noise_seed, bool stays) {
    Shot here = shot();
    here.T_scene_cam = Eigen::Translation3d(0, along_mm, 0) * here.T_scene_cam;
    here.noise_seed = noise_seed;
    here.speckle_stays_put = stays;
    sut.render(here, pixels, &truth);
    std::vector<double> sums;
    for (int column = 200; column < 1400; ++column)
      sums.push_back(column_light(pixels, head.model.region, column));
    return sums;
  };
  const auto alike = [](const std::vector<double>& a, const std::vector<double>& b) {
    const auto mean = [](const std::vector<double>& v) {
      return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    };
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double da = a[i] - mean(a), db = b[i] - mean(b);
      ab += da * db;
      aa += da * da;
      bb += db * db;
    }
    return ab / std::sqrt(aa * bb);
  };
  CHECK(alike(lights(0, 1, true), lights(0, 2, true)) > 0.98);
  // Half a pixel of the picture is 0.05 mm here: the same grains, seen a little aside.
  CHECK(alike(lights(0, 1, true), lights(0.02, 2, true)) > 0.6);
  CHECK(alike(lights(0, 1, true), lights(1, 2, true)) < 0.3);
  CHECK(alike(lights(0, 1, false), lights(0, 2, false)) < 0.3);
}

/// Standard deviation over mean of the stripe's crest, in columns of even light.
TEST(StripeRenderer, ContrastFollowsSurfaceSpectrumAndMotion) {
  head.faults.read_noise_grey = 0;
  head.faults.electrons_per_grey = 1e6;
  const auto contrast = [&](const SurfaceLook& look, double line_width_nm, double moved_mm) {
    head.laser.line_width_nm = line_width_nm;
    const Scene scene = *Scene::build(board(look, look));
    StripeRenderer sut(scene, head);
    double sum = 0, squares = 0, count = 0;
    for (int i = 0; i < 12; ++i) {
      Shot here = shot();
      here.exposure_ratio = 0.25;
      here.T_scene_cam = Eigen::Translation3d(0, 2.0 * i, 0) * here.T_scene_cam;
      here.speckle_stays_put = true;
      // Along the board and across the stripe: 0.707 of it is seen.
      here.moved_cam_mm = here.T_scene_cam.linear().transpose() * Vec3(0, moved_mm, 0);
      sut.render(here, pixels, &truth);
      for (const TrueStripePoint& stripe : truth) {
        if (stripe.column_px < 400 || stripe.column_px >= 1200) continue;
        const auto row = static_cast<int>(std::lround(stripe.row_px));
        const double ratio =
            pixels[static_cast<std::size_t>(row * head.model.region.width_px + stripe.column_px)] /
            (stripe.amplitude_grey * std::exp(-0.5 * std::pow((row - stripe.row_px) / stripe.sigma_px, 2)));
        sum += ratio;
        squares += ratio * ratio;
        ++count;
      }
    }
    const double mean = sum / count;
    DOUBLES_EQUAL(1, mean, 0.03);
    return std::sqrt(squares / count - mean * mean) / mean;
  };
  const double pixel = optics::pixel_contrast(head.optics);
  const SurfaceLook matt{.roughness_mm = 0, .polarised_ratio = 0};
  const double depolarised = pixel * optics::polarised_contrast(0);
  DOUBLES_EQUAL(depolarised, contrast(matt, 0.5, 0), 0.1 * depolarised);
  const SurfaceLook shining{.roughness_mm = 0, .polarised_ratio = 0.7};
  const double kept = pixel * optics::polarised_contrast(0.7);
  DOUBLES_EQUAL(kept, contrast(shining, 0.5, 0), 0.1 * kept);
  const SurfaceLook deep{.roughness_mm = 0.05, .polarised_ratio = 0};
  const double wide =
      depolarised * optics::spectral_contrast(head.optics, {.spread_mm = 0.1, .line_width_nm = 2});
  DOUBLES_EQUAL(wide, contrast(deep, 2, 0), 0.1 * wide);
  const double px_per_mm = head.model.camera.fu_px / head.working_distance_mm;
  const double moved =
      optics::polarised_contrast(0) * optics::pixel_contrast(head.optics, 0.2 * px_per_mm * std::sqrt(0.5));
  DOUBLES_EQUAL(moved, contrast(matt, 0.5, 0.2), 0.1 * moved);
}

/// The adviser's forecast (common/optics) against this sensor's own peaks in rendered pictures.  The lens
/// here blurs by 1.1 pixels, which widens the stripe beyond the forecast's and adds some per cent.
TEST(StripeRenderer, PeaksAreAsNoisyAsIsForetold) {
  auto extractor = stripe::PeakExtractor::create({}, head.model.region.width_px, head.model.region.height_px);
  CHECK(extractor.has_value());
  const Scene scene = *Scene::build(board({}, {}));
  const auto peaks = std::make_unique<stripe::Peaks>();
  for (const double f_number : {2.8, 5.6}) {
    head.optics.f_number = f_number;
    StripeRenderer sut(scene, head);
    double squares = 0, count = 0;
    for (int i = 0; i < 6; ++i) {
      Shot here = shot();
      here.exposure_ratio = 0.5;
      here.noise_seed = static_cast<std::uint64_t>(i);
      sut.render(here, pixels, &truth);
      extractor->rt_extract(
          {.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(head.model.region.width_px)},
          *peaks);
      for (const TrueStripePoint& stripe : truth) {
        const auto& column = peaks->columns[static_cast<std::size_t>(stripe.column_px)];
        if (stripe.column_px < 400 || stripe.column_px >= 1200 || column.kept_count == 0) continue;
        squares += std::pow(static_cast<double>(column.kept[0].row_px) - stripe.row_px, 2);
        ++count;
      }
    }
    CHECK(count > 4700);
    const optics::ScanLight light{.f_number = f_number, .speed_mm_s = 0};
    const double foretold_px = optics::stripe_noise(light).middle_mm / optics::row_mm(light);
    DOUBLES_EQUAL(foretold_px, std::sqrt(squares / count), 0.15 * foretold_px);
  }
}

}  // namespace biteline::sim
