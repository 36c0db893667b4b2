// SPDX-License-Identifier: MIT
// The peaks on real photographs: a stripe on a plane, and on steel joints.  On a chessboard, whose plane the
// chessboard itself tells: calib_real_test.
#include <CppUTest/TestHarness.h>

#include <Eigen/Dense>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tests/support/photographed_stripe.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::stripe {
namespace {

std::vector<Vec2> find_stripe(const cv::Mat& picture) {
  std::vector<Vec2> found;
  for (const test::SeenPoint& seen : test::seen_stripe(picture)) {
    if (seen.surface) found.push_back(seen.pixel_px);
  }
  return found;
}

}  // namespace

// clang-format off: it takes the macro for a namespace
TEST_GROUP(StripePhotographs){void setup() override{cv::setNumThreads(1);
}  // namespace biteline::stripe
// OpenCV's own solvers underflow on their way.
void teardown() override {
  std::feclearexcept(FE_UNDERFLOW);
}
}
;
// clang-format on

TEST(StripePhotographs, StripeOnAPlaneInTheDarkIsStraight) {
  // The board's plane meets the laser's in a straight line, whatever the camera's pose; its distortion is
  // below 0.2 px over the stripes' length here.
  BITELINE_SHARED_DATA_OR_SKIP(root, "stripes/blaser_ur5e_640");
  double sum_px2 = 0;
  std::size_t count = 0;
  int sharp = 0;
  for (int i = 13; i < 24; ++i) {
    const cv::Mat colour =
        cv::imread((root / ("im" + std::to_string(i) + ".png")).string(), cv::IMREAD_COLOR);
    CHECK(!colour.empty());
    cv::Mat red;
    cv::extractChannel(colour, red, 2);
    const std::vector<Vec2> stripe = find_stripe(red);
    CHECK(stripe.size() > 250);
    // Straight line by least absolute deviations (iteratively reweighted).
    Vec2 line = Vec2::Zero();
    for (int round = 0; round < 20; ++round) {
      Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
      Vec2 right = Vec2::Zero();
      for (const Vec2& p : stripe) {
        const Vec2 row{1, p.x() - 320};
        const double weight = round == 0 ? 1.0 : 1 / std::max(0.1, std::fabs(p.y() - row.dot(line)));
        normal += weight * row * row.transpose();
        right += weight * row * p.y();
      }
      line = normal.inverse() * right;
    }
    // Four were exposed until the stripe was a white blob with a red halo: those must be found, and are no
    // measure.
    cv::Mat full;
    cv::compare(red, 240, full, cv::CMP_GE);
    double view_px2 = 0;
    for (const Vec2& p : stripe) view_px2 += std::pow(p.y() - line[0] - line[1] * (p.x() - 320), 2);
    const double view_rms_px = std::sqrt(view_px2 / static_cast<double>(stripe.size()));
    if (cv::countNonZero(full) > static_cast<int>(stripe.size())) {
      CHECK_TEXT(view_rms_px < 2.5, StringFromFormat("im%d: rms %.3f px", i, view_rms_px).asCharString());
      continue;
    }
    ++sharp;
    sum_px2 += view_px2;
    count += stripe.size();
  }
  CHECK(sharp >= 6);
  const double rms_px = std::sqrt(sum_px2 / static_cast<double>(count));
  CHECK_TEXT(rms_px < 0.5, StringFromFormat("rms %.3f px", rms_px).asCharString());
}

namespace {

/// Where the laser's plane meets any surface these pictures show one straight, upright line: the plane passes
/// close by the camera's centre.  So an eye, and this test, can tell the stripe from glare, skin, rust and
/// labels.
struct WeldPicture {
  cv::Mat colour;
  std::vector<Vec2> found;         ///< (row, column) of the picture, unflagged
  double at_px{0}, per_row_px{0};  ///< the upright line through most of them
};

/// Red beyond what the lamp can make of it, judged by green and blue: skin, rust and wood are up to one and a
/// half times as red as they are green.  Turned so that the stripe runs along the columns.
cv::Mat turned_red(const cv::Mat& colour) {
  std::vector<cv::Mat> channels;
  cv::split(colour, channels);
  cv::Mat other, red, turned;
  cv::max(channels[0], channels[1], other);
  cv::addWeighted(channels[2], 1, other, -1.5, 0, red);
  cv::transpose(red, turned);
  return turned;
}

/// Least absolute deviations: a fifth of the points elsewhere does not move it.
void fit_upright_line(WeldPicture& picture) {
  double at = 0, slope = 0;
  for (int round = 0; round < 40; ++round) {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const Vec2& p : picture.found) {
      const double weight = round == 0 ? 1 : 1 / std::max(0.5, std::fabs(p.y() - at - slope * p.x()));
      w += weight, x += weight * p.x(), y += weight * p.y(), xx += weight * p.x() * p.x(),
          xy += weight * p.x() * p.y();
    }
    slope = (w * xy - x * y) / std::max(1e-9, w * xx - x * x);
    at = (y - slope * x) / std::max(1e-9, w);
  }
  picture.at_px = at;
  picture.per_row_px = slope;
}

WeldPicture read_weld_picture(const std::filesystem::path& file) {
  WeldPicture picture{.colour = cv::imread(file.string(), cv::IMREAD_COLOR), .found = {}};
  CHECK(!picture.colour.empty());
  picture.found = find_stripe(turned_red(picture.colour));
  CHECK(picture.found.size() > 20);
  fit_upright_line(picture);
  return picture;
}

void draw(const WeldPicture& picture, const std::filesystem::path& file) {
  constexpr int k_zoom = 2;
  cv::Mat large;
  cv::resize(picture.colour, large, {}, k_zoom, k_zoom, cv::INTER_NEAREST);
  for (const Vec2& p : picture.found) {
    const cv::Point at{static_cast<int>(std::lround(k_zoom * (p.y() + 0.5))),
                       static_cast<int>(k_zoom * p.x())};
    cv::line(large, at, at + cv::Point{0, k_zoom - 1}, {0, 255, 0}, 1);
  }
  CHECK(cv::imwrite(file.string(), large));
}

}  // namespace

TEST(StripePhotographs, OnSteelJointsTheStripeIsFoundAndGlareSkinAndRustAreNot) {
  BITELINE_SHARED_DATA_OR_SKIP(root, "stripes/weld_rohith");
  const std::filesystem::path drawn{BITELINE_PICTURES};
  std::filesystem::create_directories(drawn);
  std::size_t points = 0, beside = 0, visible = 0, seen = 0;
  for (int i = 0; i < 30; ++i) {
    const WeldPicture picture = read_weld_picture(root / ("calib_img_" + std::to_string(i) + ".jpg"));
    // Head and bag stand still but for the first picture, which is a cut of another one.
    if (i > 0) {
      DOUBLES_EQUAL(357.6, picture.at_px, 1.0);
      DOUBLES_EQUAL(0.043, picture.per_row_px, 0.002);
    }
    draw(picture, drawn / ("calib_img_" + std::to_string(i) + ".png"));
    // The stripe is two to six pixels wide, and bends by as much over the lens.
    constexpr double k_on_line_px = 8;
    const cv::Mat red = turned_red(picture.colour);
    std::vector<bool> has_point(static_cast<std::size_t>(picture.colour.rows), false);
    std::size_t astray = 0;
    for (const Vec2& p : picture.found) {
      const bool on_line = std::fabs(p.y() - picture.at_px - picture.per_row_px * p.x()) < k_on_line_px;
      astray += on_line ? 0U : 1U;
      has_point[static_cast<std::size_t>(p.x())] = has_point[static_cast<std::size_t>(p.x())] || on_line;
    }
    points += picture.found.size();
    beside += astray;
    std::size_t own_visible = 0, own_seen = 0;
    for (int row = 0; row < picture.colour.rows; ++row) {
      // Visible where the picture is clearly red on the line.
      int brightest = 0;
      for (int k = -4; k <= 4; ++k) {
        const int column = static_cast<int>(std::lround(picture.at_px + picture.per_row_px * row)) + k;
        if (column >= 0 && column < picture.colour.cols)
          brightest = std::max<int>(brightest, red.at<std::uint8_t>(column, row));
      }
      if (brightest < 60) continue;
      ++own_visible;
      own_seen += has_point[static_cast<std::size_t>(row)] ? 1U : 0U;
    }
    visible += own_visible;
    seen += own_seen;
  }
  const double share_beside = static_cast<double>(beside) / static_cast<double>(points);
  const double share_seen = static_cast<double>(seen) / static_cast<double>(visible);
  CHECK_TEXT(share_beside < 0.005, StringFromFormat("beside the stripe: %.4f", share_beside).asCharString());
  CHECK_TEXT(share_seen > 0.98, StringFromFormat("seen: %.4f", share_seen).asCharString());
}

}  // namespace biteline::stripe
