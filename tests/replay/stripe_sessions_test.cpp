// SPDX-License-Identifier: MIT
// The firmware's pipeline on recorded sessions, against their true surfaces.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"
#include "host/bite_line/evaluation/reference_surface.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::pipeline {
namespace {

/// What a cloud of the unflagged points is like.
struct CloudQuality {
  double rms_mm{0}, abs_p999_mm{0}, worst_mm{0};
  double normalised_variance{0};  ///< of error over sigma_mm
  std::size_t points{0};
};

/// Every `step`th frame: neighbours tell the same.
CloudQuality replay(const std::filesystem::path& root, std::size_t step) {
  const auto recorded = session::read_session(root);
  CHECK(recorded.has_value());
  const auto mesh = cloud::read_mesh(root / "truth/reference.ply");
  CHECK(mesh.has_value());
  const evaluation::ReferenceSurface truth{*mesh};
  auto sut = ProfilePipeline::create({}, recorded->sensor);
  CHECK(sut.has_value());
  const auto poses = std::make_unique<PoseHistory>();
  for (const session::StampedPose& pose : recorded->poses) {
    poses->rt_push({.stamp = to_sensor_clock(pose.stamp, recorded->sensor.pose_clock_offset),
                    .T_base_flange = pose.T_base_flange});
  }
  const geometry::Region& region = recorded->sensor.region;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(region.width_px) *
                                   static_cast<std::size_t>(region.height_px));
  const auto profile = std::make_unique<profile::ProfileBuffer>();
  std::vector<double> distances_mm;
  CloudQuality quality;
  for (std::size_t i = 0; i < recorded->frames.size(); i += step) {
    CHECK(image::read_png_into(recorded->frames[i].file, region.width_px, region.height_px, pixels)
              .has_value());
    sut->rt_process({.pixels = pixels,
                     .width_px = region.width_px,
                     .height_px = region.height_px,
                     .stride_bytes = static_cast<std::size_t>(region.width_px),
                     .sequence = i,
                     .exposure_mid = recorded->frames[i].exposure_mid,
                     .flags = 0},
                    *profile);
    sut->rt_stamp(*profile, *poses);
    LONGS_EQUAL(0, profile->header.flags & profile::k_profile_not_usable);
    const SE3 T_base_cam = profile->header.T_base_flange * recorded->sensor.T_flange_cam;
    for (const profile::ProfilePoint& point : profile->view()) {
      if (point.flags & profile::k_point_not_surface) continue;
      const auto nearest = truth.nearest(T_base_cam * point.point_cam.cast<double>(), 5.0);
      CHECK(nearest.has_value());
      const double distance_mm = nearest->signed_distance_mm;
      distances_mm.push_back(std::fabs(distance_mm));
      quality.rms_mm += distance_mm * distance_mm;
      quality.normalised_variance += std::pow(distance_mm / static_cast<double>(point.sigma_mm), 2);
    }
  }
  std::sort(distances_mm.begin(), distances_mm.end());
  const auto count = static_cast<double>(distances_mm.size());
  quality.points = distances_mm.size();
  quality.rms_mm = std::sqrt(quality.rms_mm / count);
  quality.normalised_variance /= count;
  quality.abs_p999_mm = distances_mm[distances_mm.size() - 1 - distances_mm.size() / 1000];
  quality.worst_mm = distances_mm.back();
  return quality;
}

void check_quality(const CloudQuality& quality) {
  const auto text =
      StringFromFormat("rms %.5f p99.9 %.4f worst %.3f mm, normalised %.2f, %zu points", quality.rms_mm,
                       quality.abs_p999_mm, quality.worst_mm, quality.normalised_variance, quality.points);
  // The bars of the product: a plain centre of gravity with unsmoothed poses reaches 0.0124 and 0.042.
  CHECK_TEXT(quality.rms_mm < 0.0080, text.asCharString());
  CHECK_TEXT(quality.abs_p999_mm < 0.030, text.asCharString());
  CHECK_TEXT(quality.worst_mm < 0.10, text.asCharString());
  CHECK_TEXT(quality.normalised_variance > 0.8 && quality.normalised_variance < 1.25, text.asCharString());
}

}  // namespace

TEST_GROUP(StripeSessions){};

TEST(StripeSessions, MadeShoeIsWithinAHundredthOfAMillimetre) {
  BITELINE_SHARED_DATA_OR_SKIP(root, "sessions/sport3");
  const CloudQuality quality = replay(root, 8);
  CHECK(quality.points > 80 * 800);
  check_quality(quality);
}

TEST(StripeSessions, ScannedShoeWithHolesAndSteepSidesToo) {
  BITELINE_SHARED_DATA_OR_SKIP(root, "sessions/airjordan1");
  const CloudQuality quality = replay(root, 8);
  CHECK(quality.points > 80 * 800);
  check_quality(quality);
}

TEST(StripeSessions, ReadingEverySecondRowMissesNothing) {
  for (const char* name : {"sessions/sport3", "sessions/airjordan1"}) {
    BITELINE_SHARED_DATA_OR_SKIP(root, name);
    const auto recorded = session::read_session(root);
    CHECK(recorded.has_value());
    const geometry::Region& region = recorded->sensor.region;
    const auto width = static_cast<std::size_t>(region.width_px);
    auto every_second = stripe::PeakExtractor::create({}, region.width_px, region.height_px);
    // No stripe is too narrow: nothing between the rows may be left out.
    auto every_one = stripe::PeakExtractor::create({.width_min_px = 0.1F}, region.width_px, region.height_px);
    CHECK(every_second.has_value() && every_one.has_value());
    std::vector<std::uint8_t> pixels(width * static_cast<std::size_t>(region.height_px));
    const auto expected = std::make_unique<stripe::Peaks>(), got = std::make_unique<stripe::Peaks>();
    std::size_t peaks = 0;
    for (std::size_t i = 0; i < recorded->frames.size(); i += 40) {
      CHECK(image::read_png_into(recorded->frames[i].file, region.width_px, region.height_px, pixels)
                .has_value());
      every_one->rt_extract({.pixels = pixels.data(), .stride_bytes = width}, *expected);
      every_second->rt_extract({.pixels = pixels.data(), .stride_bytes = width}, *got);
      for (std::size_t u = 0; u < width; ++u) {
        const stripe::ColumnPeaks &one = expected->columns[u], &other = got->columns[u];
        LONGS_EQUAL(one.kept_count, other.kept_count);
        LONGS_EQUAL(one.seen_count, other.seen_count);
        for (std::size_t k = 0; k < one.kept_count; ++k) {
          DOUBLES_EQUAL(one.kept[k].row_px, other.kept[k].row_px, 0.05 * one.kept[k].sigma_row_px);
          ++peaks;
        }
      }
    }
    CHECK(peaks > 10000);
  }
}

}  // namespace biteline::pipeline
