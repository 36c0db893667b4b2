// SPDX-License-Identifier: MIT
// The peaks on real photographs: a stripe on a chessboard, whose plane the chessboard itself tells.
#include <CppUTest/TestHarness.h>

#include <Eigen/Dense>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::stripe {
namespace {

const cv::Size k_board{9, 6};
constexpr float k_pitch_mm = 5;

/// What a red bandpass filter before a monochrome camera would leave: red less the lamp's light, which green
/// shows. The laser shows in green too where it saturates; an opening taller than the stripe takes that away.
cv::Mat filtered(const cv::Mat& colour) {
  std::vector<cv::Mat> channels;
  cv::split(colour, channels);
  cv::Mat lamp, picture;
  cv::morphologyEx(channels[1], lamp, cv::MORPH_OPEN, cv::Mat::ones(11, 1, CV_8U));
  cv::subtract(channels[2], lamp, picture);
  return picture;
}

struct View {
  cv::Mat picture;  ///< filtered
  std::vector<cv::Point2f> corners;
  cv::Mat R_cam_board, t_cam_board_mm;
  std::vector<Vec2> stripe_px;  ///< unflagged peaks
  [[nodiscard]] Vec3 normal() const {
    return {R_cam_board.at<double>(0, 2), R_cam_board.at<double>(1, 2), R_cam_board.at<double>(2, 2)};
  }
  [[nodiscard]] double distance_mm() const {
    return normal().dot(
        Vec3{t_cam_board_mm.at<double>(0), t_cam_board_mm.at<double>(1), t_cam_board_mm.at<double>(2)});
  }
};

std::vector<Vec2> find_stripe(const cv::Mat& picture) {
  const auto peaks = std::make_unique<Peaks>();
  const auto selection = std::make_unique<Selection>();
  auto extractor =
      PeakExtractor::create({.threshold_grey = 20, .width_max_px = 40, .noise = {.speckle_contrast = 0.3F}},
                            picture.cols, picture.rows);
  CHECK(extractor.has_value());
  const auto selector = std::make_unique<PeakSelector>(SelectorConfig{});
  extractor->rt_extract({.pixels = picture.data, .stride_bytes = picture.step}, *peaks);
  selector->rt_select(*peaks, *selection);
  std::vector<Vec2> found;
  for (std::size_t u = 0; u < static_cast<std::size_t>(picture.cols); ++u) {
    const Selected& selected = selection->columns[u];
    if (selected.kept_index < 0 || selected.flags != 0) continue;
    const Peak& peak = peaks->columns[u].kept[static_cast<std::size_t>(selected.kept_index)];
    if (peak.flags & (k_peak_clipped | k_peak_poor_fit | k_peak_wide | k_peak_narrow)) continue;
    found.push_back({static_cast<double>(u), static_cast<double>(peak.row_px)});
  }
  return found;
}

bool find_corners(const cv::Mat& colour, std::vector<cv::Point2f>& corners) {
  cv::Mat green, even;
  cv::extractChannel(colour, green, 1);
  if (cv::mean(green)[0] < 10) return false;  // taken in the dark, for the stripe alone
  cv::equalizeHist(green, even);
  if (!cv::findChessboardCorners(even, k_board, corners,
                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE) &&
      !cv::findChessboardCornersSB(green, k_board, corners, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return false;
  }
  cv::cornerSubPix(green, corners, {5, 5}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
  return true;
}

geometry::LaserPlane least_squares_plane(const std::vector<Vec3>& points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>{scatter}.eigenvectors().col(0);
  return {.normal_cam = normal, .distance_mm = normal.dot(mean)};
}

/// The plane that most points lie near (random sampling, Fischler and Bolles 1981), then least squares over
/// those.
geometry::LaserPlane fit_plane(const std::vector<Vec3>& points) {
  constexpr double k_near_mm = 0.4;
  std::mt19937_64 random{3};
  std::uniform_int_distribution<std::size_t> any{0, points.size() - 1};
  std::vector<Vec3> near_best;
  const auto near_points = [&](const geometry::LaserPlane& plane) {
    std::vector<Vec3> near_plane;
    for (const Vec3& p : points) {
      if (std::fabs(plane.signed_distance_mm(p)) < k_near_mm) near_plane.push_back(p);
    }
    return near_plane;
  };
  for (int i = 0; i < 600; ++i) {
    const Vec3 &a = points[any(random)], &b = points[any(random)], &c = points[any(random)];
    const Vec3 cross = (b - a).cross(c - a);
    if (cross.norm() < 10) continue;  // nearly in line
    const Vec3 normal = cross.normalized();
    auto near_plane = near_points({.normal_cam = normal, .distance_mm = normal.dot(a)});
    if (near_plane.size() > near_best.size()) near_best = std::move(near_plane);
  }
  for (int i = 0; i < 3; ++i) near_best = near_points(least_squares_plane(near_best));
  return least_squares_plane(near_best);
}

}  // namespace

// clang-format off: it takes the macro for a namespace
TEST_GROUP(StripePhotographs) {
  void setup() override { cv::setNumThreads(1); }
  // OpenCV's own solvers underflow on their way.
  void teardown() override { std::feclearexcept(FE_UNDERFLOW); }
};
// clang-format on

TEST(StripePhotographs, StripeOnAChessboardLiesInTheBoardsPlane) {
  BITELINE_SHARED_DATA_OR_SKIP(root, "stripes/blaser_ur5e_640");
  std::vector<View> views;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::Size size;
  for (int i = 0; i < 25; ++i) {
    const cv::Mat colour =
        cv::imread((root / ("im" + std::to_string(i) + ".png")).string(), cv::IMREAD_COLOR);
    CHECK(!colour.empty());
    size = colour.size();
    View view;
    if (!find_corners(colour, view.corners)) continue;  // too dark for the chessboard
    view.picture = filtered(colour);
    view.stripe_px = find_stripe(view.picture);
    corners.push_back(view.corners);
    views.push_back(view);
  }
  CHECK(views.size() >= 10);
  std::vector<cv::Point3f> board;
  for (int k = 0; k < k_board.area(); ++k)
    board.push_back({k_pitch_mm * static_cast<float>(k % k_board.width),
                     k_pitch_mm * static_cast<float>(k / k_board.width), 0});
  cv::Mat K, D;
  std::vector<cv::Mat> rotations, translations;
  cv::calibrateCamera(std::vector<std::vector<cv::Point3f>>(views.size(), board), corners, size, K, D,
                      rotations, translations, cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST);
  geometry::Camera camera{.fu_px = K.at<double>(0, 0),
                          .fv_px = K.at<double>(1, 1),
                          .cu_px = K.at<double>(0, 2),
                          .cv_px = K.at<double>(1, 2),
                          .k1 = D.at<double>(0),
                          .k2 = D.at<double>(1),
                          .p1 = D.at<double>(2),
                          .p2 = D.at<double>(3),
                          .k3 = D.at<double>(4)};
  for (std::size_t i = 0; i < views.size(); ++i) {
    cv::Rodrigues(rotations[i], views[i].R_cam_board);
    views[i].t_cam_board_mm = translations[i];
  }

  // Each view against the laser plane of all the others.
  double sum_mm2 = 0;
  std::size_t count = 0, visible = 0, found = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<Vec3> others;
    for (std::size_t k = 0; k < views.size(); ++k) {
      if (k == i) continue;
      for (const Vec2& pixel : views[k].stripe_px) {
        const Vec3 ray = camera.ray(pixel);
        others.push_back(ray * (views[k].distance_mm() / views[k].normal().dot(ray)));
      }
    }
    const geometry::LaserPlane plane = fit_plane(others);
    const View& view = views[i];
    std::vector<bool> has_point(static_cast<std::size_t>(size.width), false);
    double view_mm2 = 0;
    for (const Vec2& pixel : view.stripe_px) {
      const double distance_mm =
          view.normal().dot(geometry::triangulate(camera, plane, pixel)) - view.distance_mm();
      view_mm2 += distance_mm * distance_mm;
      has_point[static_cast<std::size_t>(pixel.x())] = true;
    }
    sum_mm2 += view_mm2;
    count += view.stripe_px.size();
    // Where both planes meet the stripe must be; it is visible where the picture is brighter there than the
    // threshold.
    std::size_t view_visible = 0, view_found = 0;
    for (int u = 0; u < size.width; ++u) {
      int row = -1;
      double least_mm = 1e9;
      for (int v = 3; v < size.height - 3; ++v) {
        const Vec3 point =
            geometry::triangulate(camera, plane, {static_cast<double>(u), static_cast<double>(v)});
        const double distance_mm = std::fabs(view.normal().dot(point) - view.distance_mm());
        if (point.z() > 0 && distance_mm < least_mm) least_mm = distance_mm, row = v;
      }
      if (row < 0) continue;
      int brightest = 0;
      for (int v = row - 3; v <= row + 3; ++v)
        brightest = std::max<int>(brightest, view.picture.at<std::uint8_t>(v, u));
      if (brightest < 60) continue;
      ++view_visible;
      view_found += has_point[static_cast<std::size_t>(u)] ? 1U : 0U;
    }
    visible += view_visible;
    found += view_found;
  }
  const double rms_mm = std::sqrt(sum_mm2 / static_cast<double>(count));
  const double share = static_cast<double>(found) / static_cast<double>(visible);
  // What is left is not the peaks': one pixel is 0.3 to 0.5 mm of distance here, twelve small chessboards fix
  // the camera to 0.34 px, and beside black squares the paper's own scatter shifts the light by a pixel or
  // two.
  CHECK_TEXT(rms_mm < 0.8, StringFromFormat("rms %.3f mm", rms_mm).asCharString());
  CHECK_TEXT(share > 0.95, StringFromFormat("share %.3f", share).asCharString());
}

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
