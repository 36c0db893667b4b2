// SPDX-License-Identifier: MIT
#include "host/records/results/pictures/transfer_stages.hpp"

#include <array>
#include <functional>

#include "host/cloud/ply.hpp"
#include "host/records/results/pictures/shoe_view.hpp"
#include "host/report/report.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;

// Two lasts of a model differ by 0.15 mm: full colour at twice that shows where a shape is another.
constexpr float k_full_colour_mm = 0.3F;
constexpr double k_surfel_radius_mm = 1;  // the surfaces are compared every 2 mm
const cv::Vec3b k_placed_colour{200, 60, 20};

struct TransferStage {
  const char* file;
  const char* caption;
};
constexpr std::array k_stages{
    TransferStage{
        "1_alignment",
        "the sample on the upper, colour: the sample lies inside (blue) or outside (red), full at 0.3 mm"},
    TransferStage{"2_placed_line", "the sample's line where the alignment puts it"},
    TransferStage{
        "3_carried_line",
        "the line on the upper, colour: confidence (green sure, red unsure); arrows: the upper's normals"},
};

struct Sheet {
  const fs::path& folder;
  const cloud::PointCloud& upper;
  const SE3& T_base_shoe;

  /// The stage's picture, and its points as a cloud; nothing without points.
  Result<void> write(const TransferStage& stage, const std::vector<Vec3>& points,
                     const std::function<void(ShoeView&)>& draw) const {
    if (points.empty()) return {};
    ShoeView view{upper, T_base_shoe};
    view.draw_cloud({});
    draw(view);
    view.caption(stage.caption);
    BITELINE_TRY(write_picture(folder / (std::string{stage.file} + ".png"), view.picture()));
    cloud::PointCloud cloud;
    for (const Vec3& p : points) cloud.points.push_back(p.cast<float>());
    return cloud::write_cloud(folder / (std::string{stage.file} + ".ply"), cloud);
  }
};

Result<void> write_alignment(const Sheet& sheet, const transfer::Alignment& alignment) {
  std::vector<Vec3> points;
  std::vector<cv::Vec3b> colours;
  for (const transfer::Compared& compared : alignment.compared) {
    points.push_back(compared.point.cast<double>());
    colours.push_back(curvature_colour(compared.difference_mm, k_full_colour_mm));
  }
  return sheet.write(k_stages[0], points,
                     [&](ShoeView& view) { view.draw_discs(points, colours, k_surfel_radius_mm); });
}

Result<void> write_placed_line(const Sheet& sheet, const std::vector<transfer::PlacedPoint>& placed) {
  std::vector<Vec3> points;
  for (const transfer::PlacedPoint& point : placed) points.push_back(point.position);
  const std::vector<cv::Vec3b> colours(points.size(), k_placed_colour);
  return sheet.write(k_stages[1], points, [&](ShoeView& view) { view.draw_line(points, colours); });
}

Result<void> write_carried_line(const Sheet& sheet, const cloud::ClosedLine& line) {
  constexpr std::size_t k_arrows = 60;
  std::vector<Vec3> points, normals;
  std::vector<cv::Vec3b> colours;
  for (const cloud::LinePoint& point : line.points) {
    points.push_back(point.position);
    normals.push_back(point.normal);
    colours.push_back(confidence_colour(point.confidence));
  }
  return sheet.write(k_stages[2], points, [&](ShoeView& view) {
    view.draw_line(points, colours);
    view.draw_normals(points, normals, std::max<std::size_t>(1, points.size() / k_arrows));
  });
}

}  // namespace

Result<void> write_transfer_stages(const fs::path& folder, const cloud::PointCloud& upper,
                                   const transfer::Transfer& transfer) {
  BITELINE_TRY(report::prepare_folder(folder));
  for (const TransferStage& stage : k_stages) {
    std::error_code ignored;
    fs::remove(folder / (std::string{stage.file} + ".png"), ignored);
    fs::remove(folder / (std::string{stage.file} + ".ply"), ignored);
  }
  const Sheet sheet{folder, upper, transfer.alignment.placement.T_target_source};
  BITELINE_TRY(write_alignment(sheet, transfer.alignment));
  BITELINE_TRY(write_placed_line(sheet, transfer.placed));
  return write_carried_line(sheet, transfer.carried.line);
}

std::vector<std::pair<std::string, std::string>> transfer_pictures(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const TransferStage& stage : k_stages) {
    const std::string file = std::string{stage.file} + ".png";
    std::error_code ignored;
    if (fs::exists(folder / file, ignored)) found.emplace_back(file, stage.caption);
  }
  return found;
}

}  // namespace biteline::results
