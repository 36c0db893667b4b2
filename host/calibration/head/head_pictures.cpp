// SPDX-License-Identifier: MIT
#include "host/calibration/head/head_pictures.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace biteline::calibration {

namespace fs = std::filesystem;

namespace {

const cv::Scalar k_green(80, 220, 80), k_red(60, 60, 255), k_yellow(60, 220, 255), k_white(235, 235, 235),
    k_grey(90, 90, 90);
constexpr int k_tile_width_px = 480;
constexpr int k_tiles_per_row = 4;
/// Residuals are hundredths of a pixel; drawn this much larger.
constexpr double k_arrow_scale = 500;

cv::Point2d to_cv(const Vec2& p) {
  return {p.x(), p.y()};
}

void put_text(cv::Mat& picture, const std::string& text, cv::Point at, const cv::Scalar& colour) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
}

Result<void> write(const fs::path& file, const cv::Mat& picture) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) return fail(Errc::WriteFailed, "%s", file.c_str());
  return {};
}

/// What is drawn over one picture.
struct Tile {
  std::string name, caption;
  std::vector<const PlaneView*> grids;
  std::vector<Vec2> stripe_px;
  bool set_aside{false};
};

cv::Mat draw_tile(const Tile& tile, const fs::path& calib) {
  cv::Mat source;
  try {
    source = cv::imread((calib / tile.name).string(), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    source.release();
  }
  if (source.empty()) source = cv::Mat(360, k_tile_width_px, CV_8UC1, cv::Scalar(0));
  const double scale = static_cast<double>(k_tile_width_px) / source.cols;
  cv::Mat small, picture;
  cv::resize(source, small, cv::Size(), scale, scale, cv::INTER_AREA);
  cv::cvtColor(small, picture, cv::COLOR_GRAY2BGR);
  for (const PlaneView* grid : tile.grids) {
    for (const GridRing& ring : grid->grid.rings) {
      for (const std::vector<Vec2>* edge : {&ring.ring.outer_edge, &ring.ring.inner_edge}) {
        for (std::size_t i = 0; i < edge->size(); i += 4)
          cv::circle(picture, to_cv((*edge)[i] * scale), 0, k_green, -1);
      }
      if (ring.ring.outer_edge.empty())  // a chessboard's corner
        cv::circle(picture, to_cv(ring.ring.centre_px * scale), 2, k_green, 1, cv::LINE_AA);
    }
    for (std::size_t i = 1; i < grid->centres.size(); ++i) {
      cv::line(picture, to_cv(grid->centres[i - 1].pixel_px * scale),
               to_cv(grid->centres[i].pixel_px * scale), k_yellow, 1, cv::LINE_AA);
    }
    if (!grid->centres.empty())
      cv::circle(picture, to_cv(grid->centres[0].pixel_px * scale), 4, k_red, -1, cv::LINE_AA);
  }
  for (const Vec2& p : tile.stripe_px) cv::circle(picture, to_cv(p * scale), 1, k_red, -1);
  if (tile.set_aside) cv::rectangle(picture, cv::Rect(0, 0, picture.cols, picture.rows), k_red, 4);
  put_text(picture, tile.name, {6, 16}, k_white);
  put_text(picture, tile.caption, {6, picture.rows - 8}, tile.set_aside ? k_red : k_white);
  return picture;
}

Result<void> write_sheet(const std::vector<Tile>& tiles, const fs::path& calib, const fs::path& file) {
  if (tiles.empty()) return {};
  std::vector<cv::Mat> pictures(tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(),
                    [&](std::size_t i) { pictures[i] = draw_tile(tiles[i], calib); });
  int height = 0;
  for (const cv::Mat& picture : pictures) height = std::max(height, picture.rows);
  const int count = static_cast<int>(pictures.size());
  const int columns = std::min(count, k_tiles_per_row), rows = (count + columns - 1) / columns;
  cv::Mat sheet(rows * (height + 4), columns * (k_tile_width_px + 4), CV_8UC3, cv::Scalar(30, 30, 30));
  for (int i = 0; i < count; ++i) {
    const cv::Mat& picture = pictures[static_cast<std::size_t>(i)];
    picture.copyTo(sheet(cv::Rect((i % columns) * (k_tile_width_px + 4), (i / columns) * (height + 4),
                                  picture.cols, picture.rows)));
  }
  return write(file, sheet);
}

void add_set_aside(std::vector<Tile>& tiles, const HeadCalibration& calibration, const std::string& folder) {
  for (const SetAside& one : calibration.set_aside) {
    if (one.name.rfind(folder, 0) == 0)
      tiles.push_back({.name = one.name,
                       .caption = one.reason.substr(0, 60),
                       .grids = {},
                       .stripe_px = {},
                       .set_aside = true});
  }
  std::sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.name < b.name; });
}

template <class... Arguments>
std::string words(const char* pattern, Arguments... arguments) {
  char text[160];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
  std::snprintf(text, sizeof text, pattern, arguments...);
#pragma GCC diagnostic pop
  return text;
}

/// All ring centres of the camera's views over the sensor, residuals as arrows: uncovered corners and lens
/// errors show.
Result<void> draw_coverage(const HeadCalibration& calibration, const fs::path& file) {
  const CameraCalibration& camera = *calibration.camera;
  const double scale = 1000.0 / camera.size.width_px;
  cv::Mat picture(static_cast<int>(camera.size.height_px * scale), 1000, CV_8UC3, cv::Scalar(30, 30, 30));
  for (int i = 1; i < 8; ++i) cv::line(picture, {i * 125, 0}, {i * 125, picture.rows}, k_grey);
  for (int i = 1; i < 6; ++i)
    cv::line(picture, {0, i * picture.rows / 6}, {1000, i * picture.rows / 6}, k_grey);
  for (const CameraView& view : camera.views) {
    for (const CentreObservation& c : view.view.centres) {
      const Vec2 residual_px = c.pixel_px - camera.camera.project(view.T_cam_target * c.point_target);
      const Vec2 at = c.pixel_px * scale;
      cv::circle(picture, to_cv(at), 2, k_green, -1, cv::LINE_AA);
      cv::line(picture, to_cv(at), to_cv(at + k_arrow_scale * scale * residual_px), k_yellow, 1, cv::LINE_AA);
    }
  }
  put_text(picture,
           words("%s of %zu views, residuals x %.0f; RMS %.4f px, %.0f %% of the fields covered",
                 camera.views.front().view.target.marks(), camera.views.size(), k_arrow_scale, camera.rms_px,
                 100 * camera.coverage_ratio),
           {8, 18}, k_white);
  return write(file, picture);
}

/// Bars, one per name.
Result<void> draw_bars(const std::vector<std::pair<std::string, double>>& bars, const std::string& caption,
                       const fs::path& file) {
  const int row_px = 22;
  cv::Mat picture(static_cast<int>(bars.size() + 2) * row_px, 800, CV_8UC3, cv::Scalar(30, 30, 30));
  double largest = 1e-9;
  for (const auto& bar : bars) largest = std::max(largest, bar.second);
  put_text(picture, caption, {8, 16}, k_white);
  int y = row_px;
  for (const auto& [name, value] : bars) {
    y += row_px;
    cv::rectangle(picture, cv::Rect(200, y - 14, std::max(1, static_cast<int>(450 * value / largest)), 14),
                  k_green, -1);
    put_text(picture, name, {8, y - 2}, k_white);
    put_text(picture, words("%.4f", value), {660, y - 2}, k_white);
  }
  return write(file, picture);
}

Result<void> draw_laser(const HeadCalibration& calibration, const fs::path& calib, const fs::path& folder) {
  std::vector<Tile> tiles;
  std::vector<std::pair<std::string, double>> bars;
  for (const LaserView& view : calibration.laser->views) {
    Tile tile{.name = view.pictures.name,
              .caption = words("%zu stripe points, RMS %.4f mm", view.points.size(), view.rms_mm),
              .grids = {},
              .stripe_px = {}};
    for (const PlaneView& plane : view.pictures.planes) tile.grids.push_back(&plane);
    for (const PlaneStripePoint& p : view.points) tile.stripe_px.push_back(p.seen.pixel_px);
    bars.emplace_back(view.pictures.name, view.rms_mm);
    tiles.push_back(std::move(tile));
  }
  add_set_aside(tiles, calibration, "laser/");
  BITELINE_TRY(write_sheet(tiles, calib, folder / "rings_laser.png"));
  return draw_bars(bars, "stripe points off the laser plane, RMS per place [mm]", folder / "stripe.png");
}

Result<void> draw_hand_eye(const HeadCalibration& calibration, const fs::path& calib,
                           const fs::path& folder) {
  std::vector<Tile> tiles;
  std::vector<std::pair<std::string, double>> bars;
  for (std::size_t i = 0; i < calibration.arm_views.size(); ++i) {
    const PlaneView& view = calibration.arm_views[i].view;
    const HandEyeStop& stop = calibration.hand_eye->stops[i];
    tiles.push_back({.name = view.name,
                     .caption = words("left out: %.3f mm", stop.left_out_mm),
                     .grids = {&view},
                     .stripe_px = {}});
    bars.emplace_back(view.name, stop.left_out_mm);
  }
  add_set_aside(tiles, calibration, "handeye/");
  BITELINE_TRY(write_sheet(tiles, calib, folder / "rings_handeye.png"));
  return draw_bars(bars, "target's middle as the other views predict it, error [mm]",
                   folder / "left_out.png");
}

}  // namespace

Result<void> draw_calibration(const HeadCalibration& calibration, const fs::path& calib,
                              const fs::path& folder) {
  if (calibration.camera) {
    std::vector<Tile> tiles;
    for (const CameraView& view : calibration.camera->views) {
      tiles.push_back({.name = view.view.name,
                       .caption = words("%zu %s, RMS %.4f px", view.view.centres.size(),
                                        view.view.target.marks(), view.rms_px),
                       .grids = {&view.view},
                       .stripe_px = {}});
    }
    add_set_aside(tiles, calibration, "camera/");
    BITELINE_TRY(write_sheet(tiles, calib, folder / "rings_camera.png"));
    BITELINE_TRY(draw_coverage(calibration, folder / "coverage.png"));
  }
  if (calibration.laser) BITELINE_TRY(draw_laser(calibration, calib, folder));
  if (calibration.hand_eye) BITELINE_TRY(draw_hand_eye(calibration, calib, folder));
  return {};
}

}  // namespace biteline::calibration
