// SPDX-License-Identifier: MIT
#include "host/records/results/pictures/stages.hpp"

#include <array>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>

#include "host/cloud/ply.hpp"
#include "host/records/results/pictures/shoe_view.hpp"
#include "host/report/report.hpp"

namespace biteline::results {
namespace {

namespace fs = std::filesystem;

// A groove of 0.3 mm depth and 1 mm width reads about -0.4: full colour there keeps shallow ones visible.
constexpr float k_full_colour_per_mm = 0.4F;

const cv::Vec3b k_feature_colour{190, 60, 20};
const cv::Vec3b k_line_colour{40, 40, 220};

cloud::PointCloud subset(const cloud::PointCloud& cloud, const std::vector<std::uint32_t>& indices) {
  cloud::PointCloud out;
  for (const std::uint32_t i : indices) {
    out.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
    if (cloud.organised()) {
      out.profile.push_back(cloud.profile[i]);
      out.column.push_back(cloud.column[i]);
    }
  }
  return out;
}

cloud::PointCloud as_cloud(const std::vector<Vec3>& points) {
  cloud::PointCloud out;
  for (const Vec3& p : points) out.points.push_back(p.cast<float>());
  return out;
}

std::vector<cv::Vec3b> curvature_colours(const std::vector<float>& curvature_per_mm) {
  std::vector<cv::Vec3b> colours;
  colours.reserve(curvature_per_mm.size());
  for (const float h : curvature_per_mm) colours.push_back(curvature_colour(h, k_full_colour_per_mm));
  return colours;
}

struct LineStage {
  const char* file;
  const char* caption;
};
constexpr std::array k_stages{
    LineStage{"1_point_cloud", "point cloud, colour: curvature (blue concave, red convex)"},
    LineStage{"2_feature_points", "feature points: strongly concave"},
    LineStage{"2_feature_points_plain_svd", "the same by plain SVD instead of weighted PCA"},
    LineStage{"3_denoised", "feature points of which a closed line can be made"},
    LineStage{"4_coarse_line", "coarse line: points around the path"},
    LineStage{"5_thinned_line", "thinned line"},
    LineStage{"6_sequence",
              "the line, colour: confidence (green sure, red unsure); arrows: the upper's normals"},
    LineStage{"unrolled_curvature",
              "curvature of the side, unrolled; green: the path, grey: what was not taken"},
};

/// One stage's two files.
struct Sheet {
  const fs::path& folder;
  const cloud::PointCloud& surface;
  const SE3& T_base_shoe;

  Result<void> write(const LineStage& stage, const cloud::PointCloud& points,
                     const std::function<void(ShoeView&)>& draw) const {
    if (points.points.empty() || surface.points.empty()) return {};
    ShoeView view{surface, T_base_shoe};
    draw(view);
    view.caption(stage.caption);
    BITELINE_TRY(write_picture(folder / (std::string(stage.file) + ".png"), view.picture()));
    return cloud::write_cloud(folder / (std::string(stage.file) + ".ply"), points);
  }
};

/// The unrolled curvature with its marks; what was taken in green, what was not in grey.
Result<void> write_unrolled(const fs::path& file, const bite_line::UnrolledSide& unrolled) {
  if (unrolled.rows == 0 || unrolled.cols == 0) return {};
  cv::Mat picture(unrolled.rows, unrolled.cols, CV_8UC3, cv::Scalar(120, 120, 120));
  for (int row = 0; row < unrolled.rows; ++row) {
    for (int col = 0; col < unrolled.cols; ++col) {
      const std::size_t at = unrolled.at(row, col);
      if (unrolled.known[at] != 0)
        picture.at<cv::Vec3b>(row, col) =
            curvature_colour(unrolled.curvature_per_mm[at], k_full_colour_per_mm);
    }
  }
  const int scale = std::max(1, (1400 + unrolled.cols - 1) / unrolled.cols);
  cv::resize(picture, picture, {}, scale, scale, cv::INTER_NEAREST);
  for (const bite_line::UnrolledSide::Mark& mark : unrolled.marks) {
    const int col = mark.col * scale;
    cv::line(picture, {col, 0}, {col, picture.rows - 1}, {90, 140, 90}, 1);
    cv::putText(picture, mark.name, {col + 4, 16}, cv::FONT_HERSHEY_SIMPLEX, 0.45, {20, 60, 20}, 1,
                cv::LINE_AA);
  }
  const auto draw = [&](const std::vector<float>& path_row, const cv::Scalar& colour) {
    const auto at = [&](std::size_t c) {
      return cv::Point{static_cast<int>((static_cast<double>(c) + 0.5) * scale),
                       static_cast<int>((path_row[c] + 0.5F) * static_cast<float>(scale))};
    };
    for (std::size_t col = 1; col < path_row.size(); ++col) {
      if (path_row[col] >= 0 && path_row[col - 1] >= 0)
        cv::line(picture, at(col - 1), at(col), colour, 1, cv::LINE_AA);
    }
  };
  for (const std::vector<float>& rival : unrolled.rival_rows) draw(rival, {150, 150, 150});
  draw(unrolled.path_row, {30, 200, 30});
  return write_picture(file, picture);
}

}  // namespace

Result<void> write_stages(const fs::path& folder, const bite_line::LineStages& stages,
                          const bite_line::Extraction& extraction) {
  BITELINE_TRY(report::prepare_folder(folder));
  for (const LineStage& stage : k_stages) {
    std::error_code ignored;
    fs::remove(folder / (std::string(stage.file) + ".png"), ignored);
    fs::remove(folder / (std::string(stage.file) + ".ply"), ignored);
  }
  const Sheet sheet{folder, stages.surface, extraction.T_base_shoe};
  const std::vector<cv::Vec3b> curvature = curvature_colours(stages.curvature_per_mm);
  const auto with_points = [&](const std::vector<std::uint32_t>& indices) {
    return [&](ShoeView& view) {
      view.draw_cloud({});
      view.draw_points(indices, k_feature_colour);
    };
  };
  BITELINE_TRY(sheet.write(k_stages[0], stages.surface, [&](ShoeView& view) { view.draw_cloud(curvature); }));
  BITELINE_TRY(sheet.write(k_stages[1], subset(stages.surface, stages.feature_points),
                           with_points(stages.feature_points)));
  BITELINE_TRY(sheet.write(k_stages[2], subset(stages.surface, stages.plain_svd_features),
                           with_points(stages.plain_svd_features)));
  BITELINE_TRY(sheet.write(k_stages[3], subset(stages.surface, stages.denoised_points),
                           with_points(stages.denoised_points)));
  BITELINE_TRY(
      sheet.write(k_stages[4], subset(stages.surface, stages.coarse_line), with_points(stages.coarse_line)));
  BITELINE_TRY(sheet.write(k_stages[5], as_cloud(stages.thinned_line), [&](ShoeView& view) {
    view.draw_cloud({});
    view.draw_line(stages.thinned_line, std::vector<cv::Vec3b>(stages.thinned_line.size(), k_line_colour));
  }));

  std::vector<Vec3> positions, normals;
  std::vector<cv::Vec3b> colours;
  for (const cloud::LinePoint& point : extraction.line.points) {
    positions.push_back(point.position);
    normals.push_back(point.normal);
    colours.push_back(confidence_colour(point.confidence));
  }
  BITELINE_TRY(sheet.write(k_stages[6], as_cloud(positions), [&](ShoeView& view) {
    view.draw_cloud({});
    view.draw_line(positions, colours);
    view.draw_normals(positions, normals, std::max<std::size_t>(1, positions.size() / 60));
  }));
  return write_unrolled(folder / (std::string(k_stages[7].file) + ".png"), stages.unrolled);
}

std::vector<std::pair<std::string, std::string>> pictures(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const LineStage& stage : k_stages) {
    const std::string file = std::string(stage.file) + ".png";
    std::error_code ignored;
    if (fs::exists(folder / file, ignored)) found.emplace_back(file, stage.caption);
  }
  return found;
}

}  // namespace biteline::results
