// SPDX-License-Identifier: MIT
/// \file Black and glossy in one profile, drawn by the cell's own renderer: what a bracket finds against what
/// the best exposure of each half would, and light that the glossy half throws elsewhere.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "hal/sim/render/stripe_renderer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::sim {

namespace {

using Corner = std::array<float, 3>;

void add_plate(SurfaceMesh& mesh, const std::array<Corner, 4>& corners, SurfaceLook look) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Corner& corner : corners) {
    mesh.vertices.push_back(corner);
    mesh.looks.push_back(look);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// Black leather on the left and patent leather on the right half of a plate, and along it, `wall_y_mm` from
/// the middle, a white wall: what the patent leather mirrors when the plate is tilted lands there, in the
/// patent leather's own columns, and is brighter than its stripe.
SurfaceMesh black_and_glossy(float wall_y_mm) {
  constexpr float k_long = 300, k_high = 60;
  SurfaceMesh mesh;
  add_plate(mesh, {Corner{-k_long, -k_long, 0}, {0, -k_long, 0}, {0, k_long, 0}, {-k_long, k_long, 0}},
            {.diffuse_ratio = 0.05, .glossy = false});
  add_plate(mesh, {Corner{0, -k_long, 0}, {k_long, -k_long, 0}, {k_long, k_long, 0}, {0, k_long, 0}},
            {.diffuse_ratio = 0.05, .glossy = true});
  add_plate(
      mesh,
      {Corner{0, wall_y_mm, 0}, {k_long, wall_y_mm, 0}, {k_long, wall_y_mm, k_high}, {0, wall_y_mm, k_high}},
      {.diffuse_ratio = 0.8, .glossy = false});
  return mesh;
}

/// The beam meets the plates head on at the origin, turned by `tilt_rad` about their x; camera x along
/// theirs.
SE3 T_scene_cam(const MadeHead& head, double tilt_rad) {
  Mat3 R_cam_scene;
  R_cam_scene.col(0) = head.laser.beam_cam.cross(head.model.laser_plane.normal_cam);
  if (R_cam_scene.col(0).x() < 0) R_cam_scene.col(0) = -R_cam_scene.col(0);
  R_cam_scene.col(2) = -head.laser.beam_cam;
  R_cam_scene.col(1) = R_cam_scene.col(2).cross(R_cam_scene.col(0));
  SE3 T_cam_scene = SE3::Identity();
  T_cam_scene.linear() = R_cam_scene * Eigen::AngleAxisd(tilt_rad, Vec3::UnitX()).toRotationMatrix();
  T_cam_scene.translation() = Vec3(0, 0, head.working_distance_mm);
  return T_cam_scene.inverse(Eigen::Isometry);
}

/// Where the sheet first meets a surface, and where its mirrored light lies, in one column.
struct ColumnTruth {
  std::optional<double> row_px;
  std::vector<double> mirrored_px;
  bool glossy{false};
};

}  // namespace

TEST_GROUP(DifficultSurfaces) {
  MadeHead head = draw_head(3);
  Scene scene = *Scene::build(black_and_glossy(4.0F));
  std::unique_ptr<StripeRenderer> renderer;
  std::vector<std::uint8_t> pixels;
  std::vector<TrueStripePoint> drawn;
  std::unique_ptr<profile::ProfileBuffer> profile = std::make_unique<profile::ProfileBuffer>();
  std::uint64_t frames{0};
  double right_px{0};
  static constexpr double k_mirror_px =
      3.0;  ///< as near to a mirror image, and farther from the stripe: is one

  /// A lamp's weakest stripe is right within 0.5 px, five standard deviations; a laser's within four of a
  /// glossy place's speckle at f/5.6, which keeps the polarisation: 0.4 px.
  void light_by(bool coherent) {
    head.laser.coherent = coherent;
    right_px = coherent ? 1.6 : 0.5;
    renderer = std::make_unique<StripeRenderer>(scene, head);
  }

  hal::FrameView frame(double tilt_rad, double exposure_ratio, std::uint32_t flags) {
    const geometry::Region& region = head.model.region;
    pixels.resize(static_cast<std::size_t>(region.width_px) * static_cast<std::size_t>(region.height_px));
    renderer->render({.T_scene_cam = T_scene_cam(head, tilt_rad),
                      .region = region,
                      .exposure_ratio = exposure_ratio,
                      .noise_seed = ++frames},
                     pixels, &drawn);
    return {
        .pixels = pixels,
        .width_px = region.width_px,
        .height_px = region.height_px,
        .stride_bytes = static_cast<std::size_t>(region.width_px),
        .sequence = frames,
        .exposure_mid = SensorClock::time_point{Nanoseconds{static_cast<std::int64_t>(frames) * 10'000'000}},
        .flags = flags};
  }

  std::vector<ColumnTruth> truth() const {
    std::vector<ColumnTruth> columns(static_cast<std::size_t>(head.model.region.width_px));
    for (const TrueStripePoint& point : drawn) {
      ColumnTruth& column = columns[static_cast<std::size_t>(point.column_px)];
      if (point.mirrored)
        column.mirrored_px.push_back(point.row_px);
      else
        column.row_px = point.row_px;
    }
    return columns;
  }

  struct Found {
    std::vector<bool> right;  ///< by column
    std::size_t mirror_images{0}, mirror_images_unflagged{0}, mirrored_columns{0};
  };
  Found judge(const std::vector<ColumnTruth>& columns) const {
    Found found{.right = std::vector<bool>(columns.size(), false)};
    for (const ColumnTruth& column : columns) found.mirrored_columns += column.mirrored_px.empty() ? 0U : 1U;
    for (const profile::ProfilePoint& point : profile->view()) {
      const ColumnTruth& column = columns[point.column];
      const double row_px = static_cast<double>(point.row_px) - head.model.region.offset_v_px;
      const bool surface = (point.flags & profile::k_point_not_surface) == 0;
      const double from_stripe_px = column.row_px ? std::fabs(row_px - *column.row_px) : 1e9;
      if (surface && from_stripe_px < right_px) found.right[point.column] = true;
      const bool mirror =
          std::any_of(column.mirrored_px.begin(), column.mirrored_px.end(), [&](double mirrored_px) {
            return std::fabs(row_px - mirrored_px) < k_mirror_px &&
                   std::fabs(row_px - mirrored_px) < from_stripe_px;
          });
      found.mirror_images += mirror ? 1U : 0U;
      found.mirror_images_unflagged += mirror && surface && from_stripe_px > right_px ? 1U : 0U;
    }
    return found;
  }

  pipeline::ProfilePipeline pipeline(bool bracketing) const {
    auto made = pipeline::ProfilePipeline::create({.bracketing = bracketing}, head.model);
    SUCCEEDS(made);
    return std::move(*made);
  }

  struct Bracketed {
    std::size_t ideal{0}, merged{0}, mirror_images{0}, unflagged{0}, mirrored_columns{0};
  };
  Bracketed bracketed() {
    constexpr double k_short = 1, k_long = 16;
    auto bracket = pipeline(true);
    Bracketed sum;
    for (const double tilt_rad : {-0.4, -0.35, -0.3, -0.25, -0.2, -0.15, -0.1}) {
      CHECK(!bracket.rt_process(frame(tilt_rad, k_short, 0), *profile));
      CHECK(bracket.rt_process(frame(tilt_rad, k_long, hal::k_frame_second_exposure), *profile));
      const std::vector<ColumnTruth> columns = truth();
      const Found found = judge(columns);
      sum.merged += static_cast<std::size_t>(std::count(found.right.begin(), found.right.end(), true));
      sum.mirror_images += found.mirror_images;
      sum.unflagged += found.mirror_images_unflagged;
      sum.mirrored_columns += found.mirrored_columns;

      // The best of many exposures for each part by itself.
      const std::size_t third = columns.size() / 3;
      std::array<std::size_t, 3> best{};
      for (const double exposure_ratio : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
        auto alone = pipeline(false);
        CHECK(alone.rt_process(frame(tilt_rad, exposure_ratio, 0), *profile));
        const Found one = judge(truth());
        for (std::size_t part = 0; part < 3; ++part) {
          const auto first = one.right.begin() + static_cast<std::ptrdiff_t>(part * third);
          const auto end = part == 2 ? one.right.end() : first + static_cast<std::ptrdiff_t>(third);
          best[part] = std::max(best[part], static_cast<std::size_t>(std::count(first, end, true)));
        }
      }
      sum.ideal += best[0] + best[1] + best[2];
    }
    return sum;
  }
  void check_finds_all_and_no_mirror_image() {
    const Bracketed found = bracketed();
    CHECK(found.ideal > 7 * 1000);
    CHECK_TEXT(static_cast<double>(found.merged) >= 0.95 * static_cast<double>(found.ideal),
               StringFromFormat("%zu of %zu", found.merged, found.ideal).asCharString());
    CHECK(found.mirrored_columns > 2000);
    CHECK(found.mirror_images > 1000);
    LONGS_EQUAL(0, found.unflagged);
  }
};

TIMED_TEST(DifficultSurfaces, BracketFindsWhatTheBestExposureOfEachHalfWouldAndNoMirrorImage) {
  light_by(false);
  check_finds_all_and_no_mirror_image();
}

TIMED_TEST(DifficultSurfaces, ALasersSpeckleLeavesTheBracketWhatItFinds) {
  light_by(true);
  check_finds_all_and_no_mirror_image();
}

}  // namespace biteline::sim
